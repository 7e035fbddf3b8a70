"""The manifest says what was run, and on what."""

import hashlib
import json
import struct
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from eventpound.case.case import Case
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.motion.readers.base import RecordData
from eventpound.results import read, write


def _case(scene):
    record = RecordData(np.array([0.5]), 0.1, "g", "at2", "/somewhere/quake.AT2", "beef")
    understood = {"title": "Bridge", "run": {"duration": 12.0}}
    run = RunOptions(0.0, 12.0, 0.01)
    return Case("Bridge", scene, run, SolverOptions(), Path("."), "cafe", record, (), understood)


def test_manifest(run, tmp_path):
    case = _case(run.scene)
    write(run, tmp_path, case, started=datetime(2024, 5, 6, 7, 8, tzinfo=UTC))
    manifest = read(tmp_path).manifest
    assert manifest["case_file_sha256"] == "cafe"
    assert manifest["record"]["file"] == "quake.AT2"
    assert manifest["record"]["file_sha256"] == "beef"
    assert manifest["case"] == case.understood
    text = json.dumps(case.understood, sort_keys=True, separators=(",", ":"))
    assert manifest["case_sha256"] == hashlib.sha256(text.encode()).hexdigest()
    assert manifest["started"] == "2024-05-06T07:08:00+00:00"
    assert manifest["wall_time"] == 0.125
    assert manifest["complete"] is True
    assert manifest["options"] == {
        "solver": "cvode",
        "rtol": 1e-9,
        "atol": {"z": 1e-8},
        "start": 0.0,
        "end": 12.0,
        "outputs": 50,
        "energy": False,
        "settings": {"order": 3},
    }


def test_record_hash(run, tmp_path):
    write(run, tmp_path)
    samples = struct.pack("<3d", 0.5, -1.0, 0.25)
    assert read(tmp_path).manifest["record"] == {
        "samples_sha256": hashlib.sha256(samples).hexdigest(),
        "samples": 3,
        "start": 0.0,
        "time_step": 0.1,
    }


def test_accelerations_are_told_to_leave_impacts_out(run, tmp_path):
    write(run, tmp_path)
    assert "impacts left out" in read(tmp_path).manifest["columns"]["a."]


def test_versions_and_machine(run, tmp_path):
    write(run, tmp_path)
    manifest = read(tmp_path).manifest
    assert manifest["versions"]["numpy"] == np.__version__
    assert set(manifest["machine"]) == {"architecture", "system", "python_implementation"}


def test_without_a_case(run, tmp_path):
    write(run, tmp_path)
    manifest = read(tmp_path).manifest
    assert manifest["case"] is None
    assert manifest["case_sha256"] is None
    assert manifest["started"] is None


def test_file_hashes(run, tmp_path):
    write(run, tmp_path)
    for name, digest in read(tmp_path).manifest["files"].items():
        assert hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() == digest
