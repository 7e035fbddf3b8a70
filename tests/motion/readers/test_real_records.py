"""Real records beside the checkout: counts, steps, PGA and mean period; and the damaged ones."""

from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.scales import mean_period
from eventpound.units import STANDARD_GRAVITY
from tests.motion.readers.real_records import FOLDER, read_row, rows_of_index

pytestmark = pytest.mark.skipif(
    not FOLDER.is_dir(), reason=f"there are no real records in {FOLDER}"
)


@pytest.mark.parametrize(
    "row", rows_of_index(), ids=lambda row: f"{row['file']}-{row['component']}"
)
def test_numbers_of_the_index(row):
    if row["format"].startswith(("SAC", "miniSEED")) and find_spec("obspy") is None:
        pytest.skip("ObsPy reads SAC and miniSEED; it is not installed")
    data = read_row(row)
    assert data.acceleration.size == int(row["npts"])
    assert data.time_step == pytest.approx(float(row["dt_s"]), rel=1e-12)
    assert not [note for note in data.notes if "states a peak" in note]
    if not row["pga_m_s2"]:
        return
    # The index has four decimals.
    assert np.max(np.abs(data.acceleration)) == pytest.approx(float(row["pga_m_s2"]), abs=0.5001e-4)
    # It pads to powers of two; from 20 s on there are no zeros here.
    long = data.acceleration.size * data.time_step >= 20.0
    for column, convention in (
        ("tm_nopad_s", "padded" if long else "literal"),
        ("tm_slammer_convention_s", "slammer"),
    ):
        period = mean_period(data.acceleration, data.time_step, convention)
        assert period == pytest.approx(float(row[column]), abs=0.5001e-4), column


ODD: list[tuple[str, dict[str, Any], int, float, float]] = [
    ("01_crcrlf_line_ends.at2", {}, 2000, 0.02, 0.3081),
    ("02_footer_after_data.at2", {}, 1559, 0.02, 0.3188),
    ("07_glued_fortran_numbers.acc", {}, 1000, 0.005, 0.67694 / STANDARD_GRAVITY),
    ("15_utf8_bom_crlf.csv", {"units": "g"}, 398, 0.02, 0.4153),
]


@pytest.mark.parametrize(("name", "arguments", "size", "dt", "pga"), ODD)
def test_odd_files_that_can_be_read(name, arguments, size, dt, pga):
    data = read_record(FOLDER / "damaged" / name, **arguments)
    assert (data.acceleration.size, data.time_step) == (size, dt)
    assert np.max(np.abs(data.acceleration)) / STANDARD_GRAVITY == pytest.approx(pga, abs=0.5001e-4)


def test_line_ends_do_not_change_the_motion():
    odd = read_record(FOLDER / "damaged" / "01_crcrlf_line_ends.at2")
    good = read_record(FOLDER / "at2" / "ARL360.at2")
    np.testing.assert_array_equal(odd.acceleration, good.acceleration)


REFUSED: list[tuple[str, dict[str, Any], str]] = [
    ("03_dt_and_npts_in_columns.AT2", {}, "line 1: 3 numbers"),
    ("03_dt_and_npts_in_columns.AT2", {"format": "at2"}, "none of the first"),
    ("03_dt_and_npts_in_columns.AT2", {"component": "#1"}, "line 7922: found 'NaN'"),
    ("04_no_header.AT2", {}, "its units and its time step"),
    ("05_dt_rounded_in_time_column.txt", {"units": "g", "time_step": 0.0025}, "0.003 s"),
    ("06_scale_and_dt_as_first_values.txt", {"units": "g", "time_step": 0.01}, "scale factor"),
    ("08_truncated_mid_number.AT2", {}, "line 184: found '-'"),
    ("08_truncated_mid_number.AT2", {}, "NPTS = 2676"),
    ("09_npts_larger_than_data.AT2", {}, "980 numbers found up to line 200.*NPTS = 1000"),
    ("10_nan_and_stars.AT2", {}, r"line 61: found 'NaN'"),
    ("10_nan_and_stars.AT2", {}, r"line 62: found '\*+'"),
    ("11_no_dt_crlf.txt", {}, "its units and its time step"),
    ("12_spectrum_not_accelerogram_bytes.txt", {}, "line 1: not an accelerogram"),
    ("13_bad_header.V2", {}, "832 numbers found up to line 150; line 46 states points = 12000"),
    ("14_decimal_comma.csv", {"units": "g"}, "line 2: .*decimal comma"),
    ("16_uneven_time_step.txt", {"units": "g"}, "line 151: the time step is not even"),
]


@pytest.mark.parametrize(("name", "arguments", "message"), REFUSED)
def test_damaged_files_are_refused(name, arguments, message):
    with pytest.raises(InputError, match=message) as caught:
        read_record(FOLDER / "damaged" / name, **arguments)
    assert all(name in problem for problem in caught.value.problems)


def test_nothing_damaged_is_left_out():
    files = {path.name for path in (FOLDER / "damaged").iterdir()} - {"README.md"}
    assert files == {name for name, *_ in ODD} | {name for name, *_ in REFUSED}
