"""Lists of record files."""

from pathlib import Path

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion.readers import read_components, read_record
from eventpound.motion.record_list import (
    ListedRecord,
    RecordFile,
    files_in,
    listed_files,
    read_each,
    read_list,
)
from tests.motion.readers.writers import WRITERS, motion


def test_a_line_says_what_its_cells_say(tmp_path):
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


def test_a_line_that_says_nonsense_names_itself(tmp_path):
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
def test_other_files_are_no_lists(tmp_path, content):
    (tmp_path / "x.csv").write_bytes(content)
    assert read_list(tmp_path / "x.csv") is None


def test_a_list_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match=r"none\.csv: cannot be read: No such file"):
        read_list(tmp_path / "none.csv")


A = motion(300, 0.02)


def folder_of(directory: Path, *names: str) -> Path:
    for name in names:
        (directory / name).write_text(WRITERS[name](A, 0.02).text)
    return directory


def test_files_are_found_in_order_but_not_hidden_ones(tmp_path):
    for name in ("b/2", "a", "b/1", ".hidden", ".git/x"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("x")
    assert files_in(tmp_path) == [tmp_path / x for x in ("a", "b/1", "b/2")]


def test_what_is_given_is_used_only_where_a_file_does_not_say_it(tmp_path):
    folder_of(tmp_path, "at2", "one_column", "geonet")
    wrong = {"units": "m/s2", "time_step": 7.0, "as_needed": True}
    data = read_record(tmp_path / "at2", **wrong)
    assert data.time_step == 0.02
    assert data.notes == (
        "time step 0.02 s of the file, not the 7 s given",
        "units G of the file, not the m/s2 given",
    )
    assert read_record(tmp_path / "one_column", **wrong).time_step == 7.0
    assert read_record(tmp_path / "geonet", component="Up", **wrong).component == "Up"
    # A component is not needed either where there is but one.
    assert read_record(tmp_path / "at2", component="Up", **wrong).component == "090"
    with pytest.raises(InputError, match="say which"):
        read_record(tmp_path / "geonet", **wrong)
    with pytest.raises(InputError, match=r"7.0 s was given"):
        read_record(tmp_path / "at2", time_step=7.0)


def test_all_components_of_a_file(tmp_path):
    folder_of(tmp_path, "geonet", "csv")
    found = read_components(tmp_path / "geonet")
    assert [data.component for data in found] == ["N28W", "S62W", "Up"]
    east, north = read_components(tmp_path / "csv", units="m/s2")
    np.testing.assert_array_equal(east.acceleration, -north.acceleration)


def test_a_bad_file_does_not_stop_the_others(tmp_path):
    folder_of(tmp_path, "at2", "one_column", "knet")
    (tmp_path / "bad.txt").write_text("no numbers\nhere\n")
    files = [RecordFile(path, units="m/s2") for path in files_in(tmp_path)]
    done: list[tuple[int, int]] = []
    results = dict(read_each(files, lambda *told: done.append(told)))
    by_name = {file.path.name: found for file, found in results.items()}
    assert done == [(0, 4), (1, 4), (2, 4), (3, 4)]
    assert isinstance(by_name["bad.txt"], InputError)
    assert "does not state its time step" in str(by_name["one_column"])
    assert all(isinstance(by_name[name], list) for name in ("at2", "knet"))


def test_a_list_says_units_and_time_steps(tmp_path):
    folder_of(tmp_path, "at2", "one_column", "geonet")
    table = tmp_path / "list.csv"
    table.write_text(
        "file,component,dt_s,units,more\none_column,,0.02,m/s2,x\nat2,90,,,\n"
        "geonet,1,0.02,cm/s2,\ngeonet,2,0.02,cm/s2,\n"
    )
    files = listed_files(table)
    assert [(file.path.name, file.units, file.time_step) for file in files] == [
        ("one_column", "m/s2", 0.02),
        ("at2", None, None),
        ("geonet", "cm/s2", 0.02),
    ]
    assert [len(file.read()) for file in files] == [1, 1, 3]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name,units\na,g\n", "one of them 'file'"),
        ("", "one of them 'file'"),
        ("file,time_step\na,fast\n", "line 2: time_step is 'fast'"),
    ],
)
def test_lists_that_are_none(tmp_path, text, message):
    (tmp_path / "list.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        listed_files(tmp_path / "list.csv")
    with pytest.raises(InputError, match="cannot be read"):
        listed_files(tmp_path / "none.csv")
