"""SAC and miniSEED through ObsPy, K-NET beside ObsPy's reader, and what is said without ObsPy."""

import subprocess
import sys
import warnings
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.readers import UnstatedError, components_of
from tests.motion.readers.writers import WRITERS, motion

SAMPLES = motion(500, 0.01)


@pytest.fixture
def obspy():
    with warnings.catch_warnings(action="ignore"):
        return pytest.importorskip("obspy", reason="ObsPy, an optional extra, is not installed")


def trace(obspy: ModuleType, data: Any, channel: str = "HNE") -> Any:
    header = {"network": "XX", "station": "MADE", "channel": channel, "delta": 0.01}
    return obspy.Trace(data, header=header)


@pytest.mark.parametrize("byte_order", ["<", ">"])
def test_sac_of_either_byte_order(obspy, tmp_path, byte_order):
    path = tmp_path / "a.bin"
    trace(obspy, SAMPLES.astype("f4")).write(str(path), format="SAC", byteorder=byte_order)
    with pytest.raises(UnstatedError, match="does not state its units"):
        read_record(path)
    data = read_record(path, units="cm/s2")
    np.testing.assert_array_equal(data.acceleration, 0.01 * SAMPLES.astype("f4").astype(float))
    assert (data.format, data.component, data.station) == ("sac", "HNE", "XX.MADE")
    # SAC keeps the time step in single precision.
    assert data.time_step == pytest.approx(0.01, rel=6e-8)


def test_sac_of_velocities_is_refused(obspy, tmp_path):
    path = tmp_path / "a.sac"
    one = trace(obspy, SAMPLES.astype("f4"))
    one.stats.sac = {"idep": 7}
    one.write(str(path), format="SAC")
    with pytest.raises(InputError, match="velocities or displacements, not accelerations"):
        read_record(path, units="m/s2")


def test_miniseed_of_numbers_with_a_unit(obspy, tmp_path):
    path = tmp_path / "a.mseed"
    stream = obspy.Stream([trace(obspy, SAMPLES), trace(obspy, -2.0 * SAMPLES, "HNN")])
    stream.write(str(path), format="MSEED")
    assert components_of(path) == ["HNE", "HNN"]
    data = read_record(path, units="m/s2", component="HNN")
    np.testing.assert_array_equal(data.acceleration, -2.0 * SAMPLES)
    assert data.time_step == pytest.approx(0.01, rel=1e-12)


def test_counts_need_a_sensitivity(obspy, tmp_path):
    path = tmp_path / "a.mseed"
    counts = np.rint(SAMPLES * 1e5).astype("i4")
    trace(obspy, counts).write(str(path), format="MSEED")
    for units in (None, "m/s2"):
        with pytest.raises(UnstatedError, match="counts and not accelerations; give response ="):
            read_record(path, units=units)
    data = read_record(path, units="1e-5 m/s2")
    np.testing.assert_allclose(data.acceleration, counts * 1e-5, rtol=1e-15)
    for units, value in (("M/S**2", 1e5), ("M/S", 1e5)):
        write_response(obspy, tmp_path / "station.xml", units, value)
        if units == "M/S":
            with pytest.raises(InputError, match=r"measures M/S; an accelerometer"):
                read_record(path, response=tmp_path / "station.xml")
        else:
            by_response = read_record(path, response=tmp_path / "station.xml")
            np.testing.assert_allclose(by_response.acceleration, data.acceleration, rtol=1e-14)
            assert "100000 counts per m/s2" in by_response.notes[0]
    with pytest.raises(InputError, match=r"none.xml' has none for channel XX.MADE..HNE"):
        read_record(path, response=tmp_path / "none.xml")


def write_response(obspy: Any, path: Path, units: str, value: float) -> None:
    from obspy.core.inventory import Channel, Inventory, Network, Response, Site, Station
    from obspy.core.inventory.response import InstrumentSensitivity

    response = Response(
        instrument_sensitivity=InstrumentSensitivity(
            value=value, frequency=1.0, input_units=units, output_units="COUNTS"
        )
    )
    place = {"latitude": 0.0, "longitude": 0.0, "elevation": 0.0}
    channel = Channel("HNE", "", depth=0.0, response=response, **place)
    station = Station("MADE", channels=[channel], site=Site(), **place)
    inventory = Inventory([Network("XX", stations=[station])], source="made up")
    inventory.write(str(path), format="STATIONXML")


def test_a_trace_with_a_gap_is_refused(obspy, tmp_path):
    path = tmp_path / "a.mseed"
    second = trace(obspy, SAMPLES)
    second.stats.starttime += 100.0
    obspy.Stream([trace(obspy, SAMPLES), second]).write(str(path), format="MSEED")
    with pytest.raises(InputError, match=r"XX.MADE..HNE comes in 2 pieces"):
        read_record(path, units="m/s2")


def test_knet_agrees_with_obspy(obspy, tmp_path):
    path = tmp_path / "a.ns2"
    path.write_text(WRITERS["knet"](motion(1000, 0.01), 0.01).text)
    data = read_record(path)
    theirs = obspy.read(str(path), format="KNET")[0]
    expected = theirs.data * theirs.stats.calib
    # One rounding of the factor, one of each product, and the mean's own.
    np.testing.assert_allclose(
        data.acceleration,
        expected - np.mean(expected),
        rtol=0.0,
        atol=8.0 * np.finfo(float).eps * np.max(np.abs(expected)),
    )
    assert data.time_step == theirs.stats.delta


def test_what_obspy_warns_of_at_its_import_stops_nobody(obspy, tmp_path):
    path = tmp_path / "motion"
    trace(obspy, SAMPLES.astype("f4")).write(str(path), format="SAC")
    read = f"from eventpound.motion import read_record; read_record({str(path)!r}, units='m/s2')"
    command = [sys.executable, "-W", "error", "-c", read]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stderr) == (0, "")


def test_without_obspy_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "obspy", None)
    path = tmp_path / "a"
    header = bytearray(632 + 8)
    header[304:308] = (6).to_bytes(4, "little")
    header[316:320] = (2).to_bytes(4, "little")
    path.write_bytes(bytes(header))
    with pytest.raises(InputError, match=r"'sac' is read by ObsPy.*pip install 'eventpound"):
        read_record(path, units="m/s2")
    path.write_bytes(b"000001D XXXX" + bytes(500))
    with pytest.raises(InputError, match=r"'miniseed' is read by ObsPy"):
        read_record(path, units="m/s2")


def test_a_response_is_only_for_counts(tmp_path):
    path = tmp_path / "a.at2"
    path.write_text(WRITERS["at2"](SAMPLES, 0.01).text)
    with pytest.raises(InputError, match="'at2' holds accelerations, not counts"):
        read_record(path, response="x.xml")
