"""Which reader a file gets, and files that get none."""

import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.readers import format_names


def test_formats_by_name():
    assert len(set(format_names())) == len(format_names())
    assert format_names()[-2:] == ["opensees", "columns"]


def test_the_name_of_the_file_says_nothing(tmp_path):
    path = tmp_path / "a.AT2"
    path.write_text("0.0 0.1\n0.5 0.2\n")
    assert read_record(path, units="g").format == "columns"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the file is empty"),
        (b" \r\n\n", "the file is empty"),
        (b"Period [sec]\tAcc\r\nSpectrum \xbf\xc6\r\n0.1 0.2\r\n", "line 1: .*found 'Period"),
        (b"\x00\x01\x02SAC\xff", r"a.txt: found a binary file; write the accelerations as text"),
    ],
)
def test_other_files_are_refused(tmp_path, content, message):
    path = tmp_path / "a.txt"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_record(path)


def test_missing_file_and_unknown_format(tmp_path):
    with pytest.raises(InputError, match=r"nothing.at2: the record cannot be read \(No such"):
        read_record(tmp_path / "nothing.at2")
    with pytest.raises(InputError, match="cannot be read"):
        read_record(tmp_path)
    path = tmp_path / "a.txt"
    path.write_text("0.1\n0.2\n")
    with pytest.raises(InputError, match=r"format 'at3' is not known; accepted: .*at2, .*columns"):
        read_record(path, format="at3")
