"""The table of a study against runs made one by one."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound.errors import ComputationError
from eventpound.scene.parameters import with_values
from eventpound.simulation import ReadyScene, response_of
from eventpound.study.forms import TABLE
from eventpound.study.table import compute, header, read_table
from eventpound.study.variants import rows_of_base, scene_of_row
from tests.study.conftest import ELASTOPLASTIC


@pytest.fixture
def table(tmp_path):
    """Maker of the table of a study."""

    def make(study):
        rows = b"".join(compute(study, chunk) for chunk in study.chunks())
        (tmp_path / TABLE).write_bytes(header(study) + rows)
        return read_table(tmp_path)

    return make


def test_rows_are_the_runs_that_simulate_makes(make_study, table):
    study = make_study().study
    found = table(study)
    assert len(found) == study.size
    assert found.success.all()
    assert (found.message == "").all()
    for i in (0, 57, 80, 159):
        base = study.bases[i // 80]
        rows = rows_of_base(base, i % 80, i % 80 + 1)
        scene = scene_of_row(rows, 0)
        duration = float(rows.lengths[0])
        run = response_of(scene, "fast", study.rtol, duration=duration)
        free = response_of(replace(scene, contacts=()), "fast", study.rtol, duration=duration)
        peaks = [float(r.peaks.loc["0", "abs_max"]) for r in (run, free)]
        row, scales = found.iloc[i], scene.motion.scales()
        assert row["pi_um"] == peaks[0] / scales.length
        assert row["free.pi_um"] == peaks[1] / scales.length
        # Both are ratios of the same two doubles, by two roundings each.
        assert row["amplification"] == pytest.approx(peaks[0] / peaks[1], rel=1e-15)
        assert row["impacts"] == run.impacts
        assert row["resting_time"] == sum(run.recording.resting_time)


def test_other_solvers_agree(make_study, table):
    text = ELASTOPLASTIC.replace("count = 40", "count = 4")
    fast = table(make_study(text).study)
    cvode = table(make_study(text + '[solver]\nname = "cvode"\nrtol = 1e-10').study)
    assert np.array_equal(cvode["impacts"], fast["impacts"])
    # rtol 1e-9 promises a hundred times that.
    for name in ("pi_um", "free.pi_um", "amplification"):
        np.testing.assert_allclose(cvode[name], fast[name], rtol=1e-7)


def test_a_scene_that_cannot_be_run_is_a_row_with_its_reason(make_study, table):
    text = """
body = [{ name = "a", mass = 1 }]
spring = [{ between = ["ground", "a"], name = "s", law = "linear", stiffness = 10 }]
contact = [{ between = ["a", "barrier"], name = "c", gap = 0.01, restitution = 0.5 }]
[excitation]
kind = "sine"
amplitude = 1.0
period = 1.0
[study]
quantities = ["peaks.a.abs_max"]
[[study.axis]]
key = "contact.c.gap"
values = [0.01, 0.05]
[[study.axis]]
key = "body.a.displacement"
values = [0.0, 0.01, -0.02, 0.005]
"""
    # Each value by itself is sound but the third: 0.01 opens no gap of 0.01, which may touch.
    study = make_study(text.replace("0.01, -0.02", "0.009, -0.02")).study
    assert table(study).success.all()
    study = make_study(
        text.replace("values = [0.01, 0.05]", "values = [0.05, 0.01]").replace(
            "0.01, -0.02", "0.03, -0.02"
        )
    ).study
    found = table(study)
    assert found.success.tolist() == [True] * 5 + [False, True, True]
    assert found["peaks.a.abs_max"].isna().tolist() == [False] * 5 + [True, False, False]
    assert "not penetrated" in found.message[5]


def test_a_failed_run_is_a_row_with_its_reason(make_study, table, monkeypatch):
    run = ReadyScene.run

    def failing(ready, values, task):
        if with_values(task.scene, values).contacts[0].gap > 0.4:
            raise ComputationError("no step is small enough", 1.25)
        return run(ready, values, task)

    monkeypatch.setattr(ReadyScene, "run", failing)
    text = ELASTOPLASTIC.replace("count = 40", "count = 2") + '[solver]\nname = "cvode"\n'
    text = text.replace('"free.pi_um", "amplification", ', "")
    found = table(make_study(text).study)
    assert found.success.tolist() == [True, True, False, False] * 2
    assert found["pi_um"].isna().tolist() == [False, False, True, True] * 2
    assert found.message[2] == "at t = 1.25 s: no step is small enough"
