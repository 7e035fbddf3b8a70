"""Files that grow, lead in circles or are too large, and patterns of names."""

import os
from pathlib import Path

import pytest

import eventpound.basics.input_files
import eventpound.results.files
import eventpound.study.engine
import eventpound.study.suite
from eventpound.basics.input_files import matching_files, read_bytes
from eventpound.errors import InputError
from tests.cli.test_hostile_files import suite


@pytest.mark.parametrize("size", [9, 10, 11])
def test_the_largest_file(size, tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"x" * size)
    if size <= 10:
        assert read_bytes(path, 10) == b"x" * size
    else:
        with pytest.raises(InputError, match="larger than 10 bytes"):
            read_bytes(path, 10)


def test_a_file_that_grows_while_it_is_read(tmp_path, monkeypatch):
    """Files of /proc say that they have no bytes."""
    real = os.stat

    def none_yet(path: object) -> os.stat_result:
        found = real(path)
        return os.stat_result((*found[:6], 0, *found[7:10]))

    path = tmp_path / "file"
    path.write_bytes(b"0123456789")
    monkeypatch.setattr(eventpound.basics.input_files.os, "stat", none_yet)
    assert read_bytes(path) == b"0123456789"
    with pytest.raises(InputError, match="larger"):
        read_bytes(path, 9)


def test_links_in_circles(tmp_path):
    """Two links back make 2^40 paths that a careless walk would follow."""
    suite(tmp_path, "")
    for name in ("one", "other"):
        (tmp_path / "records" / name).symlink_to(tmp_path, target_is_directory=True)
    found = matching_files("**/*.AT2", tmp_path)
    assert [path.name for path in found] == ["0.AT2", "1.AT2", "2.AT2"]


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("records/*.AT2", ["0.AT2", "1.AT2", "2.AT2"]),
        ("records/0.AT2", ["0.AT2"]),
        ("./records/../records/[01].AT2", ["0.AT2", "1.AT2"]),
        ("*/.h*", [".hidden.AT2"]),
        ("**", []),
        ("records", []),
        ("nowhere/*", []),
        ("", []),
        ("[", []),
        ("records/[!", []),
        ("x" * 5000 + "*", []),
    ],
)
def test_patterns(pattern, names, tmp_path):
    suite(tmp_path, "")
    (tmp_path / "records" / ".hidden.AT2").write_text("")
    assert [path.name for path in matching_files(pattern, tmp_path)] == names
    absolute = str(tmp_path / pattern) if pattern else ""
    assert [path.name for path in matching_files(absolute, Path("/"))] == names


@pytest.mark.parametrize("pattern", ["a**", "x" * 5000])
def test_what_is_no_pattern(pattern, tmp_path):
    suite(tmp_path, "")
    with pytest.raises(InputError, match="no pattern of files"):
        matching_files(pattern, tmp_path)
