"""Recordings from rows, and impacts read off them, against a solver that knows better."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound import load_case
from eventpound.mechanics.model import assemble
from eventpound.simulation import task_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind
from eventpound.solvers.from_samples import inferred_impacts, sampled_recording
from tests.models import CASES


@pytest.fixture(scope="module", params=["pair", "bridge-pulse", "elastic-barrier"])
def solved(request):
    task = task_of(load_case(CASES / request.param), 1e-9)
    return task, solver_named("fast").solve(task)


def _impacts(recording, slowest):
    found = [e for e in recording.events if e.kind is EventKind.IMPACT]
    fastest = max(-e.gap_velocity_before for e in found)
    return [e for e in found if -e.gap_velocity_before > slowest * fastest]


def test_the_rows_of_a_solver_give_its_recording_back(solved):
    task, true = solved
    h = true.history
    found = sampled_recording(task, h.t, h.u, h.v, h.z, events=true.events)
    for field in ("t", "u", "v", "z", "ground", "gap", "force"):
        np.testing.assert_allclose(
            getattr(found.history, field), getattr(h, field), rtol=1e-9, atol=1e-9 * _size(h, field)
        )
    assert found.success
    assert found.t == task.end
    np.testing.assert_array_equal(found.u, true.u)
    # A sampled extreme is short of the true one by at most a h^2 / 8.
    step = np.diff(task.output_times).max()
    slack = np.abs(h.a - h.ground[:, None]).max() * step**2 / 8.0 + 1e-12
    assert np.all(found.displacement.maximum <= true.displacement.maximum + 1e-12)
    assert np.all(found.displacement.maximum >= true.displacement.maximum - slack)


def _size(history, field):
    return max(np.abs(getattr(history, field)).max(initial=0.0), 1e-12)


def test_impacts_at_double_rows(solved):
    """They stand in the rows to the last bit."""
    task, true = solved
    found = inferred_impacts(assemble(task.scene), true.history.t, true.history.u, true.history.v)
    for event in _impacts(true, 1e-3):
        twin = [f for f in found if f.t == event.t and f.contact == event.contact]
        assert len(twin) == 1
        assert twin[0].gap_velocity_before == pytest.approx(event.gap_velocity_before, rel=1e-9)
        assert twin[0].gap_velocity_after == pytest.approx(event.gap_velocity_after, rel=1e-9)


def test_impacts_between_rows(solved):
    """Without rows at the events, as of a time-stepping method, each is found within a step."""
    task, true = solved
    times = np.linspace(task.start, task.end, 20001)
    h = solver_named("fast").solve(replace(task, output_times=times)).history
    rows = np.concatenate(([True], np.diff(h.t) > 0.0)) & np.isin(h.t, times)
    found = inferred_impacts(assemble(task.scene), h.t[rows], h.u[rows], h.v[rows])
    wanted = _impacts(true, 1e-2)
    step = times[1] - times[0]
    for event in wanted:
        near = [f for f in found if f.contact == event.contact and abs(f.t - event.t) <= step]
        assert len(near) == 1
    fast = [f for f in found if -f.gap_velocity_before > 1e-2 * -wanted[0].gap_velocity_before]
    assert len(fast) <= len(_impacts(true, 1e-3))


def test_a_compliant_contact_is_one_impact():
    """A penetration of many rows, twice: entered at 1 and at 3, deepest in between."""
    case = load_case(CASES / "elastic-barrier")
    model = assemble(case.scene)
    t = np.linspace(0.0, 4.0, 401)
    # The gap is cos(pi t / 2) - 0 of a body at u = gap - g: closed on (1, 3).
    gap = np.cos(np.pi * t / 2.0)
    u = model.gap - gap[:, None]
    v = 0.5 * np.pi * np.sin(np.pi * t / 2.0)[:, None]
    (impact,) = inferred_impacts(model, t, u, v)
    assert impact.t == pytest.approx(1.0, abs=0.01)
    # Its speed is that of the last row before, at most a step away from pi/2.
    assert impact.gap_velocity_before == pytest.approx(-np.pi / 2.0, abs=0.01)
    assert impact.gap_velocity_after == pytest.approx(np.pi / 2.0, abs=0.02)


def test_a_turn_with_an_open_gap_is_none():
    case = load_case(CASES / "elastic-barrier")
    model = assemble(case.scene)
    t = np.linspace(0.0, 4.0, 401)
    u = model.gap - (1.1 + np.cos(np.pi * t / 2.0))[:, None]
    v = 0.5 * np.pi * np.sin(np.pi * t / 2.0)[:, None]
    assert inferred_impacts(model, t, u, v) == ()


def test_rows_between_are_linear_and_those_beside_impacts_stay():
    task = replace(
        task_of(load_case(CASES / "elastic-barrier"), 1e-6), start=0.0, end=3.0,
        output_times=np.array([0.0, 0.5, 3.0]),
    )  # fmt: skip
    t = np.array([0.0, 1.0, 2.0, 2.0, 3.0])
    gap = task.scene.contacts[0].gap
    u = np.array([0.0, 0.5, 1.0, 1.0, 0.0]) * gap
    v = np.array([0.5, 0.5, 0.5, -1.0, -1.0]) * gap
    found = sampled_recording(task, t, u, v)
    assert found.history.t.tolist() == [0.0, 0.5, 2.0, 2.0, 3.0]
    np.testing.assert_allclose(found.history.u[:, 0] / gap, [0.0, 0.25, 1.0, 1.0, 0.0])
    assert [event.t for event in found.events] == [2.0]
    assert not sampled_recording(replace(task, end=4.0), t, u, v).success
