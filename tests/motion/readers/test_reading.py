"""Every text format, written from a synthetic motion and read without being told which."""

from pathlib import Path

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import RecordData, read_record
from eventpound.motion.readers import UnstatedError, components_of, format_names
from tests.motion.readers.writers import WRITERS, Written, motion

ONE_AFTER_ANOTHER = {
    "cosmos": 0.3,
    "cosmos_v1c": 0.3,
    "csmip_v2": 0.2,
    "csmip_structure": 0.2,
    "volume_1": 0.4,
    "volume_2": 0.4,
    "bhrc": 0.2,
    "slist": 0.3,
    "geonet": 0.08,
    "geonet_v1": 0.25,
}
"""Share of a file that ends within its first component, of those with several series."""
SIZE, STEP = 1200, 0.01
MOTION = motion(SIZE, STEP)


@pytest.fixture(params=WRITERS, ids=WRITERS.keys())
def case(request, tmp_path):
    written = WRITERS[request.param](MOTION, STEP)
    path = tmp_path / "record.bin"
    path.write_bytes(written.text.encode())
    return request.param, written, path


def read(written: Written, path: Path) -> RecordData:
    several = len(written.components) > 1
    return read_record(
        path,
        units=written.units,
        time_step=written.time_step,
        component="NS"
        if "NS" in written.components
        else written.components[0]
        if several
        else None,
    )


def test_samples_step_component_and_format(case):
    name, written, path = case
    data = read(written, path)
    expected = MOTION - np.mean(MOTION) if name == "knet" else MOTION
    # Printed decimals, and the rounding of a change of units.
    allowed = written.resolution * (1.0 + 1e-9) + 1e-14
    np.testing.assert_allclose(data.acceleration, expected, rtol=0.0, atol=allowed)
    assert data.time_step == STEP
    assert data.format == (written.format or name)
    assert data.format in format_names()
    if written.components != (None,):
        assert data.component in written.components
    if written.units is None:
        assert "MADE" in (data.station or "Made Up").upper()
    # Peaks that headers state are those of the samples.
    assert not [note for note in data.notes if "peak" in note and name != "usc"]


def test_several_components_are_listed_and_asked_for(case):
    _, written, path = case
    if len(written.components) == 1:
        assert len(components_of(path, units=written.units)) == 1
        return
    names = components_of(path)
    assert sorted(names) == sorted(str(name) for name in written.components)
    with pytest.raises(UnstatedError, match=r"record.bin: the file holds . components \(#1 "):
        read_record(path, units=written.units)
    with pytest.raises(InputError, match=r"'nobody' is not one of its components: #1 "):
        read_record(path, component="nobody", units=written.units)
    by_name = [
        read_record(path, component=name, units=written.units).acceleration for name in names
    ]
    for i, acceleration in enumerate(by_name, start=1):
        by_place = read_record(path, component=f"#{i}", units=written.units)
        np.testing.assert_array_equal(by_place.acceleration, acceleration)
    assert any(not np.array_equal(by_name[0], other) for other in by_name[1:])


def test_a_file_cut_short_is_refused(case):
    name, written, path = case
    if name in ("one_column", "two_columns", "csv", "opensees"):
        pytest.skip("the format does not state how many samples there are")
    lines = written.text.splitlines()
    kept = ONE_AFTER_ANOTHER.get(name, 0.5)
    path.write_text("\n".join(lines[: int(kept * len(lines))]) + "\n")
    with pytest.raises(
        InputError, match=r"record.bin: \d+ (numbers|rows) found up to line \d+; line \d+ states"
    ):
        read(written, path)


@pytest.mark.parametrize("bad", ["NaN", "*****", "1.2.3", "Infinity"])
def test_what_is_no_number_is_named_with_its_line(case, bad):
    name, written, path = case
    lines = written.text.splitlines()
    # A line of samples of the first component: the 60th from its end or that of the file.
    place = len(lines) - 60
    if name in ONE_AFTER_ANOTHER:
        place = next(i for i in range(60, len(lines)) if _numbers(lines[i - 30 : i + 30]))
    separator = "," if "," in lines[place] else None
    token = lines[place].split(separator)[-1]
    lines[place] = lines[place].replace(token, " " + bad)
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=rf"record.bin, line {place + 1}: found ") as caught:
        read(written, path)
    assert bad in str(caught.value)


def _numbers(lines: list[str]) -> bool:
    return all(len(line) > 60 and not any(c.isalpha() and c != "E" for c in line) for line in lines)


@pytest.mark.parametrize("spelt", [str.upper, str.lower], ids=["capitals", "small"])
def test_letter_case_of_a_header_means_nothing(case, spelt):
    _, written, path = case
    ways = [
        read_record(path, component=f"#{i}", units=written.units, time_step=written.time_step)
        for i in range(1, len(written.components) + 1)
    ]
    path.write_bytes(spelt(written.text).encode())
    for i, data in enumerate(ways, start=1):
        other = read_record(
            path, component=f"#{i}", units=written.units, time_step=written.time_step
        )
        np.testing.assert_array_equal(other.acceleration, data.acceleration)
        assert (other.time_step, other.format) == (data.time_step, data.format)
        assert len(other.notes) == len(data.notes)
        assert (other.component or "").upper() == (data.component or "").upper()
        assert (
            read_record(
                path, component=data.component, units=written.units, time_step=written.time_step
            ).component
            == other.component
        )


def test_units_must_agree_with_the_file(case):
    _, written, path = case
    if written.units is not None:
        pytest.skip("the file does not state its units")
    with pytest.raises(InputError, match=r"'mi/h2' are not understood|units = '7 g' were given"):
        read_record(path, units="7 g", component="#1", time_step=STEP)
    with pytest.raises(InputError, match=r"'mi/h2' are not understood"):
        read_record(path, units="mi/h2", component="#1", time_step=STEP)


def test_a_time_step_must_agree_with_the_file(case):
    _, written, path = case
    if written.time_step is not None:
        pytest.skip("the file does not state its time step")
    with pytest.raises(InputError, match=r"0.02 s was given, but the file has a time step of 0.01"):
        read_record(path, units=written.units, component="#1", time_step=2.0 * STEP)


@pytest.mark.parametrize(
    ("name", "found", "instead", "message"),
    [
        ("at2", "NPTS=   1200", "NPTS= 0", "line 4: found '0' for 'NPTS'; a positive whole number"),
        ("at2", "ACCELERATION TIME", "VELOCITY TIME", "line 3: found 'VELOCITY TIME SERIES"),
        ("esm", "NDATA:", "DATA:", "the header has no line 'NDATA'"),
        ("esm", "TYPE: ACCEL", "TYPE: DECEL", "'DECELERATION'; an acceleration time series is"),
        ("knet", "(gal)/6", "(gal)/0 6", r"line 14: found '3920\(gal\)/0 6170801'; a factor"),
        ("knet", "Scale Factor", "Other Factor", "the header has no line 'Scale Factor'"),
        ("geonet", "Component S", "Direction S", r"line \d+: the header has no line 'Component'"),
        ("cwb", "U(+); N(+); E(+)", "", "the header names no components after '#DataSequence'"),
        ("cwb", "Rate(Hz): 1", "Rate(Hz): -1", "line 8: found '-100' for .* a positive number"),
        ("itsak", "components: E N Z", "components:", "no components after 'components'"),
        ("afad", "N-S          E-W", "X Y", "no line of titles 'N-S E-W U-D' before the numbers"),
        ("itsak_fixed", "(8F15.0)", "(F15.0)", "line 1: not an ITSAK header; expected 'NAME"),
        ("smc", "2 CORRECTED ACCELEROGRAM", "2 VELOCITY", "line 1: found '2 VELOCITY'; an accel"),
        ("usc", "AND G/10", "AND G/0", "line 12: units 'UNITS ARE SEC AND G/0 .*positive divisor"),
        ("usc", "UNITS ARE SEC AND", "UNITS ARE", "the header has no line 'UNITS ARE SEC AND'"),
    ],
)
def test_what_a_header_does_not_say_is_named(name, found, instead, message, tmp_path):
    text = WRITERS[name](motion(SIZE, STEP), STEP).text
    assert found in text
    path = tmp_path / "record"
    path.write_text(text.replace(found, instead))
    with pytest.raises(InputError, match=message):
        read_record(path, format=name.replace("_", "-"), component="#1", time_step=STEP)


def test_times_beside_the_components_are_those_of_the_header(tmp_path):
    text = WRITERS["cwb"](motion(SIZE, STEP), STEP).text
    path = tmp_path / "record"
    path.write_text(
        text.replace("Rate(Hz): 100", "Rate(Hz): 200").replace(
            f"Length(sec): {SIZE * STEP:g}", f"Length(sec): {SIZE * STEP / 2:g}"
        )
    )
    with pytest.raises(InputError, match=r"a time step of 0.005 s is stated, its times are 0.01 s"):
        read_record(path, component="N")
