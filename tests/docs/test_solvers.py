"""The table of solvers says what they take."""

from tests.docs.solvers import BLOCK, PAGE, table


def test_the_table_is_that_of_the_code():
    """`python -m tests.docs.solvers` writes it."""
    (found,) = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
    assert found == table()
