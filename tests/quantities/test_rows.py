"""The state at any time: beside a closed form, rows of the run, and either side of its jumps."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eventpound import Body, Contact, Cosine, InputError, Linear, Scene, Spring, load_case, simulate
from eventpound.quantities.rows import rows_at
from eventpound.solvers import solver_named
from tests.models import CASES

BRIDGE = CASES / "bridge-el-centro"
SOLVERS = pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
M, K, GAP, E = 2.0, 50.0, 0.1, 0.5
FREE = Scene(
    (Body("a", M, velocity=1.0),),
    (Spring("s", ("ground", "a"), Linear(K)),),
    contacts=(Contact("c", "a", "barrier", gap=GAP, restitution=E),),
)


@SOLVERS
def test_before_and_after_an_impact_it_is_the_swing_of_the_closed_form(solver):
    omega, t = math.sqrt(K / M), np.linspace(0.0, 0.5, 101)[::-1]
    struck = math.asin(omega * GAP) / omega
    response = simulate(FREE, solver, 1e-10, duration=0.5, output_step=0.5)
    (event,) = response.events["t"]
    for side in ("before", "after"):
        at = response.at([*t, event], side)
        assert at["t"].tolist() == [*t, event]
        later, x = at["t"] > struck + 1e-9, at["t"] - struck
        later |= (at["t"] == event) & (side == "after")
        back = -E * math.cos(omega * struck)
        u = np.where(
            later,
            GAP * np.cos(omega * x) + back / omega * np.sin(omega * x),
            np.sin(omega * at["t"]) / omega,
        )
        v = np.where(
            later,
            -GAP * omega * np.sin(omega * x) + back * np.cos(omega * x),
            np.cos(omega * at["t"]),
        )
        # The tolerance, of some dozen steps.
        for name, expected, size in (
            ("u.a", u, 0.2), ("v.a", v, 1.0), ("a.a", -K / M * u, 5.0),
            ("force.s", K * u, 10.0), ("gap.c", GAP - u, 0.2),
        ):  # fmt: skip
            assert_allclose(at[name], expected, rtol=0.0, atol=2e-9 * size)


@SOLVERS
def test_it_is_what_the_run_has_rows_of(solver):
    response = simulate(load_case(BRIDGE), solver, error_estimate=False)
    whole = response.history
    assert set(whole["t"][whole["t"].duplicated()]) > set(response.events["t"][1:])
    for side, keep in (("before", "first"), ("after", "last")):
        rows = whole.drop_duplicates("t", keep=keep)
        # Where the record ends, both rows have the ground after its jump.
        rows = rows[rows["t"] != response.scene.motion.end]
        found = response.at(rows["t"].to_numpy()[::-1], side).iloc[::-1]
        assert found.attrs["units"] == whole.attrs["units"]
        # Rounding: `fast` looks at one polynomial from other places.
        apart = np.abs(found.to_numpy() - rows.to_numpy()).max(axis=0)
        assert (apart <= 1e-11 * whole.abs().max().to_numpy()).all()


@pytest.mark.parametrize(
    ("name", "solver"),
    [
        *((name, "fast") for name in ("bridge-pulse", "elastic-record", "isolated-building")),
        *(("bridge-pulse", solver) for solver in ("cvode", "ida", "moreau", "penalty")),
    ],
)
def test_times_that_are_asked_for_change_no_step(name, solver):
    response = simulate(load_case(BRIDGE.parent / name), solver, error_estimate=False)
    task, kept = response.task, response.recording
    t = np.random.default_rng(1).uniform(task.start, task.end, 500)
    run, places = rows_at(task, solver_named(solver).solve, t, "after")
    assert np.array_equal(run.history.t[places], t)
    assert run.events == kept.events
    assert np.array_equal(np.r_[run.u, run.v, run.z], np.r_[kept.u, kept.v, kept.z])


def test_a_jump_of_the_ground_has_two_sides():
    scene = Scene(FREE.bodies, FREE.springs, motion=Cosine("1 m/s^2", "0.8 s", start=0.25))
    response = simulate(scene, duration=1.2)
    sides = [response.at("250 ms", side)["a_g"].item() for side in ("before", "after")]
    assert sides == pytest.approx([0.0, 1.0], abs=1e-12)
    assert response.at(0.0, "before").equals(response.history.iloc[:1])


@pytest.mark.parametrize(
    ("t", "side", "said"),
    [
        (0.6, "after", "t: found 0.6 s; accepted: times of the run, 0 to 0.5 s"),
        ([], "after", "t: found none"),
        (np.nan, "after", "t: found nan, not finite"),
        ("1 kg", "after", "t: found '1 kg'"),
        (0.1, "left", "side: found 'left'; accepted: 'after' or 'before'"),
        (0.1, "before", "side: found 'before' at 0.1 s, an event inside a step"),
    ],
)
def test_what_there_is_no_state_of_is_refused(t, side, said):
    response = simulate(FREE, "moreau:time_step=0.01", duration=0.5)
    with pytest.raises(InputError, match=said):
        response.at(response.events["t"][0] if side == "before" else t, side)
