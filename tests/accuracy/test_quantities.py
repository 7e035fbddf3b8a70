"""Errors of peaks and final states are what docs/compare.md says, by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from eventpound import InputError, load_case
from eventpound.accuracy.quantities import (
    FINAL,
    PEAKS,
    errors_of,
    motion_scales,
    scales_of_task,
    truth_of,
)
from eventpound.accuracy.reference import CertifiedBounds, reference_of
from eventpound.score.difference import ScaledValue
from eventpound.simulation import task_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Extremes
from tests.models import CASES


@pytest.fixture(scope="module")
def pair():
    case = load_case(CASES / "pair")
    return case, reference_of(case, case.run, None)


def _judged(pair, **changes):
    case, truth = pair
    found = replace(truth.recording, **changes)
    return errors_of(case.scene, found, truth.truth, truth.rows(truth.task.output_times))


def test_the_reference_has_no_error(pair):
    errors = _judged(pair)
    assert errors.largest(PEAKS) == errors.largest(FINAL) == errors.distance.graph == 0.0
    assert (errors.impacts.missed, errors.impacts.extra, errors.impacts.largest_shift) == (0, 0, 0)
    assert [q.quantity.name for q in errors.quantities] == [
        "peaks.flexible.max", "peaks.flexible.min", "peaks.stiff.max", "peaks.stiff.min",
        "final.flexible.u", "final.flexible.v", "final.stiff.u", "final.stiff.v",
        "final.flexible-piers.z", "final.stiff-piers.z",
    ]  # fmt: skip


def test_peaks_by_the_largest_displacement_of_the_body(pair):
    x = pair[1].recording.displacement
    size = np.maximum(x.maximum, -x.minimum)
    off = Extremes(
        x.maximum, x.time_of_maximum, x.minimum + np.array([0.0, 0.01 * size[1]]), x.time_of_minimum
    )
    errors = _judged(pair, displacement=off)
    assert errors.largest(PEAKS) == pytest.approx(0.01, rel=1e-12)
    assert errors.largest(FINAL) == 0.0


def test_final_state_by_speed_and_bound(pair):
    r = pair[1].recording
    fastest = np.abs(r.history.v).max(axis=0)
    errors = _judged(
        pair, v=r.v + np.array([0.0, 0.02 * fastest[1]]), z=r.z + np.array([0.03, 0.0])
    )
    found = {q.quantity.name: q.error for q in errors.quantities}
    assert found["final.stiff.v"] == pytest.approx(0.02, rel=1e-12)
    # beta + gamma = 1: the bound of z is one.
    assert found["final.flexible-piers.z"] == pytest.approx(0.03, rel=1e-12)


def test_what_is_not_known_is_no_error(pair):
    r = pair[1].recording
    errors = _judged(pair, v=np.full(2, np.nan), z=np.full(2, np.nan))
    assert errors.largest(FINAL) == 0.0
    errors = _judged(pair, u=r.u * np.nan, v=np.full(2, np.nan), z=np.full(2, np.nan))
    assert math.isnan(errors.largest(FINAL))


def test_two_methods_agree_and_their_difference_is_the_bound(pair):
    _, truth = pair
    # Both at rtol 1e-13; errors of a hundred steps, amplified by four impacts.
    assert truth.check.distance.graph < 1e-9
    assert truth.check.impacts.missed == truth.check.impacts.extra == 0
    fast = solver_named("fast").solve(replace(truth.task, output_times=np.empty(0)))
    name = "final.flexible.u"
    (q,) = (q for q in truth.truth.quantities if q.name == name)
    assert q.bound == abs(q.value - fast.u[0])
    assert "checked by fast" in truth.words


def test_rows_of_the_reference_are_where_they_are_asked_for(pair):
    _, truth = pair
    times = np.array([0.1, 0.25])
    rows = truth.rows(times)
    assert set(times) <= set(rows.t)
    assert truth.rows(times) is rows


def test_loose_runs_have_larger_errors(pair):
    case, truth = pair
    found = []
    for rtol in (1e-3, 1e-6, 1e-9):
        run = solver_named("cvode").solve(task_of(case, rtol))
        errors = errors_of(case.scene, run, truth.truth, truth.rows(truth.task.output_times))
        found.append((errors.largest(PEAKS), errors.largest(FINAL), errors.distance.graph))
    assert np.all(np.diff(np.log10(np.array(found)), axis=0) < -1.0)


def test_a_certificate_that_contradicts_the_case(pair, tmp_path):
    case, truth = pair
    (value,) = (q.value for q in truth.truth.quantities if q.name == "final.stiff.u")
    stated = CertifiedBounds(tmp_path / "c.json", {"final.stiff.u": (value + 1e-3, 1e-6)})
    with pytest.raises(InputError, match=r"c\.json: final\.stiff\.u = .* run eventpound verify"):
        reference_of(case, case.run, stated)


@pytest.mark.parametrize(("off", "taken"), [(1e-5, True), (1e-3, False)])
def test_a_certificate_beside_a_run_that_nothing_checked(tmp_path, off, taken):
    own = ScaledValue("final.stiff.u", 0.02, 0.05, "m", np.nan)
    stated = CertifiedBounds(tmp_path / "c.json", {own.name: (own.value + off, 1e-6)})
    if taken:
        assert stated.instead_of([own])[0].value == own.value + off
    else:
        with pytest.raises(InputError, match="run eventpound verify again"):
            stated.instead_of([own])


def test_friction_that_is_not_unique_is_not_judged(pair):
    case, reference = pair
    shared = replace(reference.recording, unique_z=np.array([False, True]))
    truth = truth_of(reference.task, shared)
    z = shared.history.z + np.array([0.5, 0.0])
    other = replace(shared, z=z[-1], history=replace(shared.history, z=z))
    errors = errors_of(case.scene, other, truth, shared.history)
    assert "final.flexible-piers.z" not in [q.quantity.name for q in errors.quantities]
    assert errors.largest(FINAL) == errors.distance.graph == errors.distance.sup == 0.0


def test_what_rounding_alone_moves_has_the_scales_of_the_scene(pair):
    r, task = pair[1].recording, pair[1].task
    scale, own = scales_of_task(task), motion_scales(task, r)
    tiny = np.array([1e-15, 1.0])
    x, h = r.displacement, r.history
    still = replace(
        r,
        displacement=replace(x, maximum=x.maximum * tiny, minimum=x.minimum * tiny),
        history=replace(h, u=h.u * tiny, v=h.v * tiny),
    )
    found = motion_scales(task, still)
    assert found.u == pytest.approx([scale.length, own.u[1]], rel=1e-15)
    assert found.v == pytest.approx([scale.speed, own.v[1]], rel=1e-15)
