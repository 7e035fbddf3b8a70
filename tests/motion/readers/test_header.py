"""What agencies and programs write otherwise than their format says, and what is no text at all."""

import gzip
import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.readers import UnstatedError, components_of
from eventpound.motion.readers.header import unit_factor
from tests.motion.readers import writers
from tests.motion.readers.writers import motion

STEP = 0.01
MOTION = motion(400, STEP)


def written(path: Path, text: str, name: str = "record") -> Path:
    file = path / name
    file.write_text(text)
    return file


@pytest.mark.parametrize(
    "data",
    [
        "pts, approx {0:4.0f} secs, units=cm/sec2(04),Format=(8F10.5)",
        "pts, approx {0:4.0f} secs, units=cm/sec2.    (04)Format=(8f10.5)   ",
        "points approx {0:.2f} sec  units = cm/s/s (04) format (8F10.5)",
        "pts., approx. {0:4.0f} secs., UNITS: CM/SEC/SEC, FORMAT=(8F10.5)",
        "accel. pts,units=gal,Format=(8F10.5)",
    ],
)
def test_cosmos_is_read_by_meaning(data, tmp_path):
    file = written(tmp_path, writers.cosmos(MOTION, STEP, data).text)
    read = read_record(file, component="70")
    np.testing.assert_allclose(read.acceleration, -0.5 * MOTION, rtol=0.0, atol=0.6e-7)
    assert (read.time_step, read.acceleration.size) == (STEP, MOTION.size)


def test_cosmos_with_the_step_of_the_raw_record_alone(tmp_path):
    text = writers.cosmos(MOTION, STEP).text
    line = next(x for x in text.splitlines() if "    10.000000" in x)
    raw = text.splitlines()[text.splitlines().index(line) - 5]
    assert raw.split()[3] == "-999.000000"
    changed = raw[:39] + f"{STEP:13.6f}" + raw[52:]
    text = text.replace(line, line.replace("    10.000000", "  -999.000000"))
    text = text.replace(raw, changed)
    assert read_record(written(tmp_path, text), component="70").time_step == STEP


def test_cosmos_with_semicolons(tmp_path):
    text = writers.cosmos(MOTION, STEP, "pts, approx {0:4.0f} secs; units=cm/sec2;Format=(8F10.5)")
    text = text.text.replace("0 deg (Rcrdr", "0 deg Roof (Rcrdr")
    data = read_record(written(tmp_path, text), component="#1")
    np.testing.assert_allclose(data.acceleration, MOTION, atol=1e-5)
    assert data.component.isdecimal()


def test_cosmos_counts_are_no_accelerations(tmp_path):
    data = "pts, approx {0:4.0f} secs, units=counts (50),Format=(8F10.5)"
    file = written(tmp_path, writers.cosmos(MOTION, STEP, data).text)
    with pytest.raises(InputError, match="accelerations and not counts, as its V1 and V2 have"):
        read_record(file, component="#1")


def test_a_channel_of_a_structure_is_named_without_its_location(tmp_path):
    text = writers.csmip_structure(MOTION, STEP).text
    file = written(tmp_path, text)
    assert components_of(file) == ["90", "UP"]
    for asked in ("up", "#2", "Chan 2", "deck: center"):
        assert read_record(file, component=asked).component == "UP"
    both = written(tmp_path, text.replace("UP  ", " 90 DEG  "), "both")
    assert components_of(both) == ["#1", "#2"]
    with pytest.raises(InputError, match=r"'90' is the name of 2 .*: #1 90 \(CHAN  1, Abutment 1"):
        read_record(both, component="90")
    assert read_record(both, component="deck: center").component == "90"


@pytest.mark.parametrize(
    ("printed", "asked"),
    [
        ("90 DEG Roof", "90"),
        ("90 Deg, Roof - East", "Roof - East"),
        ("90 Deg.   Location:", "90"),
        ("90 Deg Deck: Span 3", "Deck: Span 3"),
        ("90 Deg    from", "90"),
        ("Down Roof", "down"),
        ("Ref. North  Location: pile", "Ref. North"),
    ],
)
def test_names_and_locations_of_channels(tmp_path, printed, asked):
    text = writers.csmip_v2(MOTION, STEP).text.replace(":  90 DEG\r\n", f": {printed}\r\n")
    assert printed in text
    data = read_record(written(tmp_path, text), component=asked)
    np.testing.assert_allclose(data.acceleration, MOTION, atol=1e-5)


def test_a_response_spectrum_is_no_accelerogram(tmp_path):
    text = writers.esm(MOTION, STEP).text.replace("ACCELERATION", "ACCELERATION RESPONSE SPECTRUM")
    with pytest.raises(InputError, match="an acceleration time series is needed"):
        read_record(written(tmp_path, text))


def test_pairs_at_uneven_times_need_a_time_step(tmp_path):
    """Every other time is 2 ms late: a straight line is sampled as itself."""
    t = STEP * np.arange(200)
    late = t + 0.002 * (np.arange(200) % 2)
    text = writers.volume_1(1.3 * t, STEP).text
    pairs = np.column_stack([t, 1.3 * t / 0.980665]).ravel().tolist()
    moved = np.column_stack([late, 1.3 * late / 0.980665]).ravel().tolist()
    text = text.replace(writers.rows(pairs, 10, "7.3f"), writers.rows(moved, 10, "7.3f"))
    file = written(tmp_path, text)
    with pytest.raises(UnstatedError, match=r"0.008 to 0.012 s apart; give time_step"):
        read_record(file, component="90")
    read = read_record(file, component="90", time_step=0.02)
    np.testing.assert_allclose(
        read.acceleration, 1.3 * 0.02 * np.arange(read.acceleration.size), atol=2e-3
    )
    assert any("200 samples at uneven times" in note for note in read.notes)


def test_times_are_those_of_the_rate(tmp_path):
    text = writers.tspair(MOTION, STEP).text
    with pytest.raises(InputError, match=r"line 3: its time is -0.01 s off those of 50 Hz"):
        read_record(written(tmp_path, text.replace("100 sps", "50 sps")), units="m/s2")
    changed = written(tmp_path, text.replace("1999-01-02T03:04:05.000000  ", "noon "))
    with pytest.raises(InputError, match=r"line 2: found 'noon'; a time is expected"):
        read_record(changed, units="m/s2")


def test_a_channel_in_pieces_is_refused(tmp_path):
    text = writers.slist(MOTION, STEP).text.replace("HNN", "HNE")
    with pytest.raises(InputError, match="channel xx_made__hne_r begins again, after a gap"):
        read_record(written(tmp_path, text))


def test_more_samples_than_a_series_states_are_refused(tmp_path):
    text = writers.slist(MOTION, STEP).text.replace("400 samples", "384 samples", 1)
    with pytest.raises(InputError, match=r"400 numbers found .* states samples = 384"):
        read_record(written(tmp_path, text), component="HNE")


@pytest.mark.parametrize(
    ("index", "value", "message"),
    [(16, 7, "says velocities"), (16, 6, "says displacements"), (35, 0, "its times are uneven")],
)
def test_sac_that_is_no_accelerogram(index, value, message, tmp_path):
    lines = writers.sac_alphanumeric(MOTION, STEP).text.splitlines()
    line, at = 14 + index // 5, 10 * (index % 5)
    lines[line] = lines[line][:at] + f"{value:10d}" + lines[line][at + 10 :]
    with pytest.raises(InputError, match=message):
        read_record(written(tmp_path, "\n".join(lines)), units="m/s2")


COLUMN = "".join(f"{x:.6f}\n" for x in MOTION)
PAIRS = "".join(f"{i * STEP:.2f}\t{x:.6f}\n" for i, x in enumerate(MOTION))


ONE_LINE = [
    f"400 0.01\n{PAIRS}",
    f"400, 0.01\n{COLUMN}",
    f"0.01 400\n{COLUMN}",
    f"A title of 3 words\n400 0.01\n{COLUMN}",
    f"# made up\n400\t1e-2\n{PAIRS}".replace("\t", ","),
    "Title\nAnother 2\n 400 .01\n" + writers.rows(MOTION, 8, "9.6f"),
    f"400.0 0.01\n{COLUMN}",
]
OTHERWISE = [
    f"400 0.01 g\n{PAIRS}",
    f"400\n0.01\n{COLUMN}",
    f"0.01\n400\n{COLUMN}",
    f"NPTS = 400\nDT = 0.01\n{COLUMN}",
    f"# Number of points: 400\n# Time step: 0.01 s\n{PAIRS}",
    "  400  512  .01   (8F9.6)    a title\n" + writers.rows(MOTION, 8, "9.6f"),
]


@pytest.mark.parametrize("text", ONE_LINE + OTHERWISE, ids=range(13))
def test_a_count_and_a_step_before_the_samples(text, tmp_path):
    file = written(tmp_path, text)
    read = read_record(file, units="m/s2")
    np.testing.assert_allclose(read.acceleration, MOTION, rtol=0.0, atol=0.51e-6)
    assert (read.time_step, read.format) == (STEP, "count-and-step")
    with pytest.raises(InputError, match=r"0.02 s was given, but the file has a time step of 0.01"):
        read_record(file, units="m/s2", time_step=0.02)
    if text in ONE_LINE:
        cut = written(tmp_path, "\n".join(text.splitlines()[:-20]), "cut")
        with pytest.raises(InputError, match=r"found up to line \d+; line \d states .*samples"):
            read_record(cut, units="m/s2")


def test_units_in_a_head_are_heeded(tmp_path):
    file = written(tmp_path, f"NPTS = 400\nDT = 0.01\nUNITS: CM/S2\n{COLUMN}")
    read = read_record(file)
    np.testing.assert_allclose(read.acceleration, 0.01 * MOTION, rtol=0.0, atol=0.51e-8)
    with pytest.raises(InputError, match=r"units = 'g' were given, but the file states 'CM/S2'"):
        read_record(file, units="g")


def test_another_count_than_words_say_is_refused(tmp_path):
    for samples in (COLUMN, PAIRS):
        file = written(tmp_path, f"# Number of points: 500\n# Time step: 0.01 s\n{samples}")
        with pytest.raises(InputError, match=r"line 2 states .*samples = (500|1000)"):
            read_record(file, units="m/s2")


def test_a_scale_beside_a_count_and_a_step_is_not_ignored(tmp_path):
    with pytest.raises(InputError, match="unlike the 400 numbers after it"):
        read_record(written(tmp_path, f"400 0.01 9.81\n{COLUMN}"), units="m/s2", time_step=STEP)


def test_times_beside_a_count_and_a_step_are_as_stated(tmp_path):
    text = f"400 0.0104\n{PAIRS}"
    with pytest.raises(InputError, match=r"step of 0.0104 s is stated, its times are 0.01 s apart"):
        read_record(written(tmp_path, text), units="m/s2")


def test_rows_of_times_are_no_count_and_step(tmp_path):
    text = "".join(f"{10 + i} {0.01 * i + 0.01:.2f}\n" for i in range(5))
    assert read_record(written(tmp_path, text), units="m/s2", time_step=1.0).format == "columns"


def test_rows_that_repeat_the_last_are_no_samples(tmp_path):
    text = writers.unam(MOTION, STEP).text
    filled = text + 2 * (text.splitlines()[-1] + "\n")
    read = read_record(written(tmp_path, filled), component="V")
    assert read.acceleration.size == MOTION.size
    assert read.notes == ("2 rows that repeat the last one passed over",)
    with pytest.raises(InputError, match="401 rows found"):
        read_record(written(tmp_path, text + " 1.0 2.0 3.0\n"), component="V")


def test_wide_characters_are_text(tmp_path):
    file = tmp_path / "record"
    file.write_bytes(PAIRS.encode("utf-16"))
    read = read_record(file, units="m/s2")
    np.testing.assert_allclose(read.acceleration, MOTION, rtol=0.0, atol=0.51e-6)


def _zip(*names: str) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name in names:
            archive.writestr(name, PAIRS)
    return content.getvalue()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (_zip("a.V2", "b.V2"), r"found a zip archive with a.V2, b.V2; unpack it and name the file"),
        (_zip("a.at2"), r"a zip archive with a.at2; unpack it"),
        (_zip("a.V2")[:60], "a zip archive that is damaged"),
        (_zip("[Content_Types].xml"), "an Office file .*; write the accelerations as text"),
        (gzip.compress(PAIRS.encode()), "a gzip archive; unpack it"),
        (b"\x89HDF\r\n\x1a\n" + bytes(100), "an HDF5 file"),
        (b"MATLAB 5.0 MAT-file" + bytes(100), "a MATLAB file"),
        (b"\x93NUMPY\x01\x00", "a NumPy file"),
        (bytes(range(256)), "a binary file; write the accelerations as text"),
        (bytes(257) + b"ustar\x00", "a tar archive"),
    ],
    # Archives hold the time at which they are made: named by that, tests differ among workers.
    ids=[
        "zip",
        "one-in-zip",
        "damaged",
        "office",
        "gzip",
        "hdf5",
        "matlab",
        "numpy",
        "binary",
        "tar",
    ],
)
def test_what_is_no_text_is_named_and_never_shown(content, message, tmp_path):
    file = tmp_path / "record"
    file.write_bytes(content)
    for name in (None, "at2", "columns"):
        with pytest.raises(InputError, match=message) as caught:
            read_record(file, format=name, units="g")
        assert str(caught.value).isprintable()
        assert "\\x" not in str(caught.value)


@pytest.mark.parametrize("begins", [b"000001V 010", b"000001D \x00", b"000001R*", b"MS\x03\x00"])
def test_seed_without_obspy_is_named(begins, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "obspy", None)
    file = tmp_path / "record"
    file.write_bytes(begins + bytes(200))
    with pytest.raises(InputError, match=r"'miniseed' is read by ObsPy, which is not installed"):
        read_record(file, units="g")


def test_smc_of_uneven_times_is_named(tmp_path):
    text = writers.smc(MOTION, STEP).text
    assert text.count("  1.0000000E+02") == 1
    text = text.replace("  1.0000000E+02", "  1.7000000E+38")
    with pytest.raises(InputError, match="no samples per second: an uncorrected record"):
        read_record(written(tmp_path, text))


@pytest.mark.parametrize(
    ("units", "factor"),
    [
        ("g.", 9.80665),
        ("CMS/SEC/SEC", 0.01),
        ("gals", 0.01),
        ("Cm/Sec**2", 0.01),
        ("1.00 mm/s/s", 0.001),
    ],
)
def test_units_as_headers_spell_them(units, factor):
    assert unit_factor(units) == factor


def test_a_line_of_digits_without_end_is_read_past(tmp_path):
    # Each digit was tried as the end of what stands behind a name, for minutes.
    digits = "EVENT   " + "9" * 3000 + "   " + "9" * 3000
    head = "FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:"
    with pytest.raises(InputError, match="the header has no line"):
        read_record(written(tmp_path, f"{head}\n{digits}\n{digits}"))
