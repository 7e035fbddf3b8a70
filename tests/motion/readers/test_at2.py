"""PEER AT2 files: the five headers, touching numbers, and what is refused."""

import hashlib
from pathlib import Path

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.units import STANDARD_GRAVITY

G_LINE = "ACCELERATION TIME SERIES IN UNITS OF G"
HEADERS = {
    "NGA-West2": (
        "PEER NGA STRONG MOTION DATABASE RECORD",
        "Somewhere-02, 5/19/1940, Array #9 (upper, left), 180",
        G_LINE,
        "NPTS=      7, DT=   .0100 SEC,            ",
    ),
    "NGA-West2 with poles": (
        "PEER NGA STRONG MOTION DATABASE RECORD",
        "Somewhere-02, 5/19/1940, Array #9 (upper, left), 180",
        G_LINE,
        "NPTS=      7, DT=   .0100 SEC,   0 POLE @    30.00000 HZ,  -5 POLE @      .05000",
    ),
    "NGA-West1": (
        "PEER NGA STRONG MOTION DATABASE RECORD",
        "SOMEWHERE-02 5/19/1940 2146, Array #9 (upper, left), 180, (CWB)    ",
        "ACCELERATION TIME HISTORY IN UNITS OF G",
        "7    0.0100    NPTS, DT",
    ),
    "PEER 2000": (
        "PEER STRONG MOTION DATABASE RECORD. PROCESSING BY SOMEBODY.",
        "SOMEWHERE-02, 5/19/1940, 14:06, Array #9 (upper, left), 180 (STATION 117)",
        "ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.2 Hz LP=12.5 Hz",
        "NPTS=   7, dt=  .01000",
    ),
    "Pacific Engineering": (
        "PACIFIC ENGINEERING AND ANALYSIS STRONG-MOTION DATA",
        "SOMEWHERE-02 5/19/1940 0439, Array #9 (upper, left), 180           ",
        "ACCELERATION TIME HISTORY IN UNITS OF G      ",
        "NPTS=  7, DT= .01000 SEC",
    ),
}
NUMBERS = ("   .1000000E-02  -.2500000E-01   .3000000E+00", "-.400E-01-.500E-01  6.D-02", "7.E-3")
VALUES = np.array([0.001, -0.025, 0.3, -0.04, -0.05, 0.06, 0.007])


def write(path: Path, *lines: str, end: str = "\n") -> Path:
    path.write_bytes("".join(line + end for line in lines).encode("latin-1"))
    return path


@pytest.mark.parametrize("header", HEADERS.values(), ids=HEADERS.keys())
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r\r\n", "\r"])
def test_every_header_with_every_line_end(tmp_path, header, end):
    data = read_record(write(tmp_path / "a.txt", *header, *NUMBERS, end=end))
    np.testing.assert_array_equal(data.acceleration, VALUES * STANDARD_GRAVITY)
    assert (data.format, data.units, data.time_step) == ("at2", "G", 0.01)
    assert (data.event or "").lower() == "somewhere-02"
    assert data.date == "5/19/1940"
    assert data.station == "Array #9 (upper, left)"
    assert data.component == "180"
    assert data.notes == ()


def test_the_hash_is_that_of_the_bytes(tmp_path):
    path = write(tmp_path / "a.at2", *HEADERS["NGA-West2"], *NUMBERS)
    data = read_record(path)
    assert data.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert data.file == str(path)


def test_text_after_the_last_sample_is_noted(tmp_path):
    path = write(tmp_path / "a.at2", *HEADERS["NGA-West2"], *NUMBERS, "*** End ***")
    data = read_record(path)
    assert data.acceleration.size == 7
    assert data.notes == ("line 8: text after the last sample passed over: '*** End ***'",)


def test_units_of_the_header_may_be_others(tmp_path):
    lines = list(HEADERS["NGA-West2"])
    lines[2] = "ACCELERATION TIME SERIES IN UNITS OF CM/SEC/SEC"
    data = read_record(write(tmp_path / "a.at2", *lines, *NUMBERS))
    np.testing.assert_allclose(data.acceleration, VALUES * 0.01, rtol=1e-15)


def test_what_the_caller_knows_must_agree(tmp_path):
    path = write(tmp_path / "a.at2", *HEADERS["NGA-West2"], *NUMBERS)
    assert read_record(path, units="g", time_step=0.01, format="at2").acceleration.size == 7
    with pytest.raises(InputError, match=r"line 3.*'m/s2' were given.*states 'G'"):
        read_record(path, units="m/s2")
    with pytest.raises(InputError, match=r"line 4.*0.02 s was given.*0.01 s"):
        read_record(path, time_step=0.02)


def test_units_the_header_does_not_state_are_asked_for(tmp_path):
    header = list(HEADERS["NGA-West2"])
    header[2] = "ACCELERATION TIME SERIES"
    path = write(tmp_path / "a.at2", *header, *NUMBERS)
    with pytest.raises(InputError, match=r"a.at2: .*not state its units; give units"):
        read_record(path)
    np.testing.assert_array_equal(read_record(path, units="m/s^2").acceleration, VALUES)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({4: "0.1 NaN 0.3"}, "line 5: found 'NaN'"),
        ({4: "0.1 ******** 0.3"}, r"line 5: found '\*\*\*\*\*\*\*\*'"),
        ({4: "0.1 0.123-101 0.3"}, "line 5: found '0.123-101'"),
        ({4: "0.1 1.0E+400 0.3"}, "line 5: found '1.0E"),
        ({6: "-"}, r"line 7: found '-'"),
        ({6: ""}, "6 numbers found up to line 6; line 4 states NPTS = 7"),
        ({6: "0.1 0.2"}, "8 numbers found up to line 7; line 4 states NPTS = 7"),
        ({2: "VELOCITY TIME SERIES IN UNITS OF CM/S"}, "line 3: .*acceleration time series"),
        ({2: "ACCELERATION IN UNITS OF COUNTS"}, "line 3: units 'COUNTS' are not understood"),
        ({3: "NPTS= 7, DT= .0000 SEC"}, "line 4: time step 0.0 s"),
    ],
)
def test_refusals_name_file_line_and_finding(tmp_path, change, message):
    lines = [*HEADERS["NGA-West2"], *NUMBERS]
    for i, line in change.items():
        lines[i] = line
    with pytest.raises(InputError, match=message) as caught:
        read_record(write(tmp_path / "broken.at2", *lines))
    assert all("broken.at2" in problem for problem in caught.value.problems)


def test_all_unreadable_numbers_are_named_together(tmp_path):
    lines = [*HEADERS["NGA-West2"], "0.1 NaN 0.2", "x 0.1 0.2", "0.3"]
    with pytest.raises(InputError) as caught:
        read_record(write(tmp_path / "a.at2", *lines))
    assert len(caught.value.problems) == 2


def test_a_file_without_header_is_not_at2(tmp_path):
    with pytest.raises(InputError, match=r"not a PEER AT2 file.*NPTS"):
        read_record(write(tmp_path / "a.at2", *NUMBERS), format="at2")
