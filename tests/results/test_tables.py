"""Tables that other programs wrote, and those that are none."""

import pytest

from eventpound.errors import InputError
from eventpound.results.run_files import read_events, read_history


def test_another_programs_history(tmp_path):
    path = tmp_path / "theirs.csv"
    path.write_text("t,u.deck\n0,1\n0.5,2.5e-1\n")
    table = read_history(path)
    assert table["u.deck"].tolist() == [1.0, 0.25]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("time,u\n0,1\n", "no column 't'"),
        ("t,u\n0,1\n1,left\n", "row 3, column u: 'left' is not a number"),
        ("t,u\n0,1\n1,2,3\n", "row 3 has 3 cells, the line of names 2"),
        ("t,u,u\n0,1,1\n", "column u stands more than once"),
    ],
)
def test_not_a_history(tmp_path, text, message):
    path = tmp_path / "history.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_history(path)


def test_not_events(tmp_path):
    path = tmp_path / "events.csv"
    path.write_text("t,kind\n0,impact\n")
    with pytest.raises(InputError, match="has no column group"):
        read_events(path)


def test_unreadable(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_history(tmp_path / "none.csv")
    with pytest.raises(InputError, match="cannot be read"):
        read_events(tmp_path / "none.csv")
