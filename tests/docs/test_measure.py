"""Tables of measured pages are what their commands print."""

from __future__ import annotations

import os
import re
import shlex
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.docs import measure

PAGE = """\
Before.

<!-- measured by: python -m tests.docs.printed 'a b' -->
Measured 2020-01-01 on a slate.

| old |
<!-- end of measured -->

Between.

<!-- measured by: python -m tests.docs.printed 'a b'; table 2 -->
<!-- end of measured -->

After.
"""
PRINTED = "progress\n| a | b |\n| --- | --- |\n| 1 | 2 |\n\nwords\n| c |\n| --- |\n"
BLOCKS = [
    pytest.param(block, id=f"{page.stem}-{number}")
    for page in measure.PAGES
    for number, block in enumerate(measure.blocks(page.read_text(encoding="utf-8")), start=1)
]


def test_blocks_get_the_tables_that_their_command_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = []

    def run(words: list[str], **kept: object) -> object:
        calls.append(words[1:])
        return type("Done", (), {"stdout": PRINTED})()

    monkeypatch.setattr(measure.subprocess, "run", run)
    page = tmp_path / "page.md"
    page.write_text(PAGE, encoding="utf-8")
    measure.measure(page)
    assert calls == [["-m", "tests.docs.printed", "a b"]]
    text = page.read_text(encoding="utf-8")
    first, second = measure.blocks(text)
    assert re.match(r"Measured 20\d\d-\d\d-\d\d on \w+, \d+ cores\.\n\n\| a \| b \|", first.inside)
    assert first.inside.endswith("| 1 | 2 |\n\n| c |\n| --- |\n")
    assert second.inside.endswith(".\n\n| c |\n| --- |\n")
    assert "old" not in text
    assert "words" not in text
    assert re.sub(r"<!-- m.*?<!-- e.*?-->", "", text, flags=re.DOTALL).split() == [
        *("Before.", "Between.", "After.")
    ]


def test_what_was_printed_earlier_has_the_day_of_its_file(tmp_path: Path) -> None:
    page, printed = tmp_path / "page.md", tmp_path / "printed"
    page.write_text(PAGE, encoding="utf-8")
    printed.write_text(PRINTED, encoding="utf-8")
    os.utime(printed, (1.6e9, 1.6e9))
    measure.measure(page, 2, printed)
    first, second = measure.blocks(page.read_text(encoding="utf-8"))
    assert "| old |" in first.inside
    assert second.inside.startswith("Measured 2020-09-13 on ")


def test_a_command_without_a_table_leaves_the_page(tmp_path: Path) -> None:
    page, printed = tmp_path / "page.md", tmp_path / "printed"
    page.write_text(PAGE, encoding="utf-8")
    printed.write_text("words\n", encoding="utf-8")
    with pytest.raises(SystemExit, match="0 tables printed"):
        measure.measure(page, 1, printed)
    assert page.read_text(encoding="utf-8") == PAGE


def test_a_block_changed_by_hand_is_seen(tmp_path: Path) -> None:
    page, printed = tmp_path / "page.md", tmp_path / "printed"
    page.write_text(PAGE, encoding="utf-8")
    printed.write_text(PRINTED, encoding="utf-8")
    measure.measure(page, 1, printed)
    text = page.read_text(encoding="utf-8")
    assert [block.is_written for block in measure.blocks(text)] == [True, False]
    for old, new in (
        ("| 1 | 2 |", "| 1 | 3 |"),
        ("Measured 2", "Measured 1"),
        ("'a b' ", "'a c' "),
    ):
        assert old in text
        assert not next(measure.blocks(text.replace(old, new, 1))).is_written


@pytest.mark.parametrize("block", BLOCKS)
def test_no_block_is_by_hand(block: measure.Block) -> None:
    """`python -m tests.docs.measure` measures it again."""
    assert find_spec(shlex.split(block.command)[0])
    assert re.match(r"Measured 20\d\d-\d\d-\d\d on \w+, \d+ cores\.\n\n\|", block.inside)
    assert block.is_written


def test_there_are_blocks() -> None:
    assert len(BLOCKS) >= 10


MEASURED = [page for page in measure.PAGES if page.parent.name == "measured"]


@pytest.mark.parametrize("page", MEASURED, ids=lambda page: page.stem)
def test_no_table_is_by_hand(page: Path) -> None:
    """A new one gets a block."""
    text = measure.BLOCK.sub("", page.read_text(encoding="utf-8"))
    assert [table.group().splitlines()[0] for table in measure.TABLE.finditer(text)] == []
