"""Tables of measured pages are what their commands print."""

import re
import shlex
from importlib.util import find_spec

import pytest

from tests.docs import measure

BLOCKS = [
    pytest.param(block, id=f"{page.stem}-{number}")
    for page in measure.PAGES
    for number, block in enumerate(measure.blocks(page.read_text(encoding="utf-8")), start=1)
]


@pytest.mark.parametrize("block", BLOCKS)
def test_no_block_is_by_hand(block):
    """`python -m tests.docs.measure` measures it again."""
    assert find_spec(shlex.split(block.command)[0])
    assert re.match(r"Measured 20\d\d-\d\d-\d\d on \w+, \d+ cores\.\n\n\|", block.inside)
    assert block.is_written


def test_there_are_blocks():
    assert len(BLOCKS) >= 10


MEASURED = [page for page in measure.PAGES if page.parent.name == "measured"]


@pytest.mark.parametrize("page", MEASURED, ids=lambda page: page.stem)
def test_no_table_is_by_hand(page):
    """A new one gets a block."""
    text = measure.BLOCK.sub("", page.read_text(encoding="utf-8"))
    assert [table.group().splitlines()[0] for table in measure.TABLE.finditer(text)] == []
