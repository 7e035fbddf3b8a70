"""What is written reads back bit by bit."""

import json
import math
import struct
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eventpound.errors import InputError
from eventpound.results import read, write
from eventpound.results.jsontext import canonical, to_json


def bits(table):
    return table.to_numpy(dtype=np.float64).view(np.int64)


def test_history_reads_back_bit_by_bit(run, tmp_path):
    write(run, tmp_path)
    stored, computed = read(tmp_path).history, run.history
    assert list(stored.columns) == list(computed.columns)
    np.testing.assert_array_equal(bits(stored), bits(computed))


def test_random_bit_patterns_read_back(make_run, tmp_path):
    """Doubles of every exponent, not only of the sizes a run produces."""
    rng = np.random.default_rng(3)
    run = make_run(n=2000)
    history = run.recording.history
    values = rng.integers(0, 2**63 - 1, history.u.shape).view(np.float64).copy()
    values[~np.isfinite(values)] = 0.0
    run = replace(run, recording=replace(run.recording, history=replace(history, u=values)))
    write(run, tmp_path)
    np.testing.assert_array_equal(bits(read(tmp_path).history), bits(run.history))


def test_history_columns(run, tmp_path):
    write(run, tmp_path)
    header = (tmp_path / "history.csv").read_text().splitlines()[0]
    assert header == (
        "t,a_g,u.deck1,u.deck2,v.deck1,v.deck2,a.deck1,a.deck2,z.frame1,force.frame1,"
        "force.link,force.abutment,gap.joint,gap.stop,lambda.joint,lambda.stop"
    )


def test_missing_values_survive(run, tmp_path):
    history = run.recording.history
    force = np.full_like(history.contact_force, np.nan)
    recording = replace(run.recording, history=replace(history, contact_force=force))
    write(replace(run, recording=recording), tmp_path)
    assert read(tmp_path).history["lambda.joint"].isna().all()


def test_events_read_back(run, tmp_path):
    write(run, tmp_path)
    stored, computed = read(tmp_path).events, run.events
    assert (tmp_path / "events.csv").read_text().splitlines()[0] == (
        "t,kind,group,contact,gap_velocity_before,gap_velocity_after,impulse,energy_lost,count"
    )
    for name in computed.columns:
        assert stored[name].tolist() == computed[name].tolist(), name
    assert stored["count"].dtype == np.int64


def test_no_events(make_run, tmp_path):
    write(make_run(events=()), tmp_path)
    events = read(tmp_path).events
    assert len(events) == 0
    assert events["t"].dtype == np.float64


def test_awkward_contact_names(bridge, make_run, tmp_path):
    scene = bridge()
    contacts = (replace(scene.contacts[0], name="NA"), replace(scene.contacts[1], name='1,"2'))
    run = make_run(scene=replace(scene, contacts=contacts))
    write(run, tmp_path)
    assert read(tmp_path).events["contact"].tolist() == run.events["contact"].tolist()
    assert list(read(tmp_path).history.columns) == list(run.history.columns)


@given(st.lists(st.floats()))
def test_json_numbers_read_back(values):
    back = json.loads(to_json({"x": values}))["x"]
    for value, found in zip(values, back, strict=True):
        if math.isfinite(value):
            assert struct.pack("d", value) == struct.pack("d", found)
        else:
            assert found is None


def test_json_knows_arrays_and_refuses_objects():
    assert json.loads(to_json({"a": np.arange(3), "b": (np.float64(0.5), np.True_)})) == {
        "a": [0, 1, 2],
        "b": [0.5, True],
    }
    with pytest.raises(TypeError, match="SimpleNamespace"):
        to_json(SimpleNamespace())


def test_canonical_form_ignores_order():
    assert canonical({"a": 1.0, "b": [0.1]}) == canonical({"b": (0.1,), "a": 1.0})


def test_failed_run_is_written_and_marked(make_run, tmp_path):
    write(make_run(success=False), tmp_path)
    results = read(tmp_path)
    assert results.summary["success"] is False
    assert results.summary["message"] == "stopped"
    assert results.manifest["complete"] is False


def test_written_anew(run, make_run, tmp_path):
    write(run, tmp_path)
    write(make_run(n=7), tmp_path)
    assert len(read(tmp_path).history) == 7


@pytest.mark.parametrize("name", ["summary.json", "history.csv", "events.csv", "manifest.json"])
def test_missing_file_is_named(run, tmp_path, name):
    write(run, tmp_path)
    (tmp_path / name).unlink()
    with pytest.raises(InputError, match=f"{name} missing"):
        read(tmp_path)


@pytest.mark.parametrize("name", ["summary.json", "history.csv", "events.csv"])
def test_file_of_another_run_is_named(run, make_run, tmp_path, name):
    write(run, tmp_path / "one")
    write(make_run(success=False, n=9, events=()), tmp_path / "two")
    (tmp_path / "one" / name).write_bytes((tmp_path / "two" / name).read_bytes())
    with pytest.raises(InputError, match=f"{name} not as the run"):
        read(tmp_path / "one")


def test_no_directory(tmp_path):
    with pytest.raises(InputError, match="no such directory"):
        read(tmp_path / "nowhere")


@pytest.mark.parametrize("text", ["{", "[]", "{}"])
def test_broken_manifest(run, tmp_path, text):
    write(run, tmp_path)
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(InputError, match=r"manifest\.json"):
        read(tmp_path)
