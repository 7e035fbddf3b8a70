"""The table of solvers says what they take."""

from __future__ import annotations

from tests.docs.solvers import BLOCK, PAGE, table


def test_the_table_is_that_of_the_code() -> None:
    """`python -m tests.docs.solvers` writes it."""
    (found,) = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
    assert found == table()


def test_it_tells_yes_from_no() -> None:
    rows = [line.split(" | ")[1:] for line in table().splitlines()[2:]]
    assert all(row[0] == "yes" for row in rows[:3])
    assert all("no" in row[-1] or "no" in row[-2] for row in rows)
