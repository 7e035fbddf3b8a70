"""Every row of the tables about the paper names a command that is there."""

import re
from importlib.util import find_spec

import pytest

from tests.benchmarks.claims import CLAIMS
from tests.models import ROOT

COMMAND = re.compile(r"`(python -m|eventpound (?:run|study|check|plot --model)|pytest) ([^ `]+)")
STANDINGS = {"as there", "with a limit", "not modelled yet"}


def rows(page: str, heading: str) -> list[list[str]]:
    """Cells of the tables whose first column has a heading."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    found: list[list[str]] = []
    for block in re.findall(r"(?:^\|.*\n)+", text, re.M):
        lines = [re.split(r"(?<!\\)\|", line.strip().strip("|")) for line in block.splitlines()]
        if lines[0][0].strip() == heading:
            found += [[cell.strip() for cell in line] for line in lines[2:]]
    return found


def is_there(kind: str, what: str) -> bool:
    """Whether a module, a case or a folder of tests exists."""
    return find_spec(what) is not None if kind == "python -m" else (ROOT / what).exists()


@pytest.mark.parametrize("heading", ["item of the paper", "paper"])
def test_rows_of_the_paper_have_commands_and_reasons(heading):
    found = rows("paper.md", heading)
    assert len(found) >= 10
    for item, _, now, command, limit in found:
        assert now in STANDINGS, item
        assert bool(COMMAND.search(command)) == (now != "not modelled yet"), item
        assert all(is_there(*parts) for parts in COMMAND.findall(command)), item
        # What does not stand as the paper has it says why.
        assert bool(limit) == (now != "as there"), item


def test_claims_have_a_place_a_verdict_and_a_command():
    found = rows("paper.md", "claim")
    assert len(found) >= 15
    named = set()
    for claim, where, computed, verdict, command in found:
        assert where, claim
        assert re.search(r"\d|drawn", computed), claim
        assert verdict.startswith(("holds", "does not hold")), claim
        names = set(re.findall(r"`([^`]+)`", command))
        named |= names & CLAIMS.keys()
        others = " ".join(f"`{name}`" for name in names - CLAIMS.keys())
        assert names <= CLAIMS.keys() or COMMAND.search(others), claim
        assert all(is_there(*parts) for parts in COMMAND.findall(others)), claim
    assert named == CLAIMS.keys()
