"""Lists of record files."""

from __future__ import annotations

from pathlib import Path

import pytest

from eventpound.errors import InputError
from eventpound.motion.record_list import ListedRecord, read_list


def test_a_line_says_what_its_cells_say(tmp_path: Path) -> None:
    path = tmp_path / "list.csv"
    path.write_text(
        "\ufefffile,units,dt_s,time_step,component,more\n"
        " a.txt , 0.1 g ,,0.02,#2,x\n"
        "\n"
        'b.txt,,0.01\n"c, d.txt",,0.01,0.005,,\n',
        encoding="utf-8",
    )
    assert read_list(path) == [
        ListedRecord("a.txt", "0.1 g", "#2", 0.02, ""),
        ListedRecord("b.txt", None, None, 0.01, ""),
        ListedRecord("c, d.txt", None, None, 0.005, ""),
    ]


def test_a_line_that_says_nonsense_names_itself(tmp_path: Path) -> None:
    path = tmp_path / "list.csv"
    path.write_text("file,time_step\na,0.1\n\n,0.1\nb,fast\n")
    rows = read_list(path)
    assert rows is not None
    assert [row.problem for row in rows] == [
        "",
        f"{path}, line 4: no file is named",
        f"{path}, line 5: time_step is 'fast'; accepted: a time step in s",
    ]


@pytest.mark.parametrize("content", [b"", b"t,a\n0,1\n", b"\xff\xfe\x00\x01"])
def test_other_files_are_no_lists(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.csv").write_bytes(content)
    assert read_list(tmp_path / "x.csv") is None


def test_a_list_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.csv: cannot be read: No such file"):
        read_list(tmp_path / "none.csv")
