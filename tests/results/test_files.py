"""Sets of files are there whole or not at all."""

from pathlib import Path

import pytest

from eventpound.errors import InputError
from eventpound.results import check_writable, write_together

CONTENTS = {"a.csv": b"1,2\n", "b.json": b"{}", "last.json": b"[]"}


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_written_into_a_new_directory(tmp_path):
    folder = tmp_path / "deep" / "results"
    assert write_together(folder, CONTENTS) == [folder / name for name in CONTENTS]
    assert {name: (folder / name).read_bytes() for name in names(folder)} == CONTENTS


@pytest.mark.parametrize("failing", [0, 1, 2])
@pytest.mark.parametrize("error", [OSError("disk gone"), KeyboardInterrupt()])
def test_interrupted_renaming_leaves_nothing(tmp_path, monkeypatch, failing, error):
    calls = []
    replace = Path.replace

    def broken(self, target):
        calls.append(target)
        if len(calls) > failing:
            raise error
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", broken)
    with pytest.raises((InputError, KeyboardInterrupt)):
        write_together(tmp_path, CONTENTS)
    assert names(tmp_path) == []


def test_interrupted_writing_keeps_the_old_set(tmp_path, monkeypatch):
    write_together(tmp_path, CONTENTS)

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("eventpound.results.files.os.fsync", full)
    with pytest.raises(InputError, match="No space left on device"):
        write_together(tmp_path, dict.fromkeys(CONTENTS, b"new"))
    assert {name: (tmp_path / name).read_bytes() for name in names(tmp_path)} == CONTENTS


def test_last_file_is_placed_last(tmp_path, monkeypatch):
    order = []
    replace = Path.replace
    monkeypatch.setattr(
        Path, "replace", lambda self, target: (order.append(target.name), replace(self, target))[1]
    )
    write_together(tmp_path, CONTENTS)
    assert order == list(CONTENTS)


def test_a_file_in_the_way(tmp_path):
    (tmp_path / "results").write_text("not a directory")
    with pytest.raises(InputError, match="cannot be written to"):
        write_together(tmp_path / "results", CONTENTS)
    with pytest.raises(InputError, match="is not a directory"):
        check_writable(tmp_path / "results" / "deeper")
    assert (tmp_path / "results").read_text() == "not a directory"


def test_check_changes_nothing(tmp_path):
    check_writable(tmp_path / "new" / "deep")
    assert names(tmp_path) == []


def test_no_permission(tmp_path, monkeypatch):
    monkeypatch.setattr("eventpound.results.files.os.access", lambda *_: False)
    with pytest.raises(InputError, match="no permission to write"):
        check_writable(tmp_path)
