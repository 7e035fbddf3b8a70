"""Tables of measured pages are what their commands print."""

from __future__ import annotations

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

After.
"""


def test_a_block_gets_the_tables_that_its_command_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    printed = "progress\n| a | b |\n| --- | --- |\n| 1 | 2 |\n\nwords\n| c |\n| --- |\n"

    def run(words: list[str], **kept: object) -> object:
        assert words[1:] == ["-m", "tests.docs.printed", "a b"]
        return type("Done", (), {"stdout": printed})()

    monkeypatch.setattr(measure.subprocess, "run", run)
    page = tmp_path / "page.md"
    page.write_text(PAGE, encoding="utf-8")
    measure.measure(page)
    text = page.read_text(encoding="utf-8")
    assert re.search(r"Measured 20\d\d-\d\d-\d\d on \w+, \d+ cores\.\n\n\| a \| b \|", text)
    assert "| 1 | 2 |\n\n| c |\n| --- |\n<!-- end of measured -->\n\nAfter." in text
    assert "old" not in text
    assert "words" not in text
    once = text
    measure.measure(page, 2)
    assert page.read_text(encoding="utf-8") == once


def test_blocks_of_the_pages_name_commands_that_are_there() -> None:
    blocks = [
        block["command"]
        for page in measure.PAGES.glob("*.md")
        for block in measure.BLOCK.finditer(page.read_text(encoding="utf-8"))
    ]
    assert len(blocks) >= 3
    assert all(find_spec(shlex.split(command)[0]) for command in blocks)
