"""Bodies that go apart: what comes out is what bodies that step together, or are alone, do."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from eventpound.mechanics.model import assemble
from eventpound.mechanics.supported import lowered
from eventpound.motion.base import GroundMotion
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.mavroeidis_papageorgiou import MavroeidisPapageorgiou
from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.ricker import Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Force,
    Linear,
    Scene,
    Spring,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast.constants import blank_series, clear_scratch, plan_of
from tests.solvers.stepping import stepper_of

END = 9.0
"""Length of a run (s)."""
FAR = 1e3
"""A gap that never closes (m)."""
MOTIONS = {
    "sine": Sine(3.0, 1.4),
    "cosine, from below": Cosine(2.5, 1.1, reverse=True),
    "harmonic": Harmonic(2.0, 1.3),
    "Ricker": Ricker(4.0, 1.2),
    "Mavroeidis and Papageorgiou": MavroeidisPapageorgiou(3.0, 1.0),
}


def row(gap: float, motion: GroundMotion = MOTIONS["sine"], damped: bool = True) -> Scene:
    """Four bodies between two barriers: three that yield, one seen from its other end, one linear.

    The first all but stays at rest on a stiff spring, the second starts with a load on it.
    """
    bodies = (
        Body("a", 1.0),
        Body("b", 2.0, 0.01, -0.2),
        Body("c", 0.7, -0.02, 0.3),
        Body("d", 1.5),
    )
    springs = (
        Spring("a", (GROUND, "a"), BoucWen(900.0, 30.0, 0.05, 20.0)),
        Spring("b", ("b", GROUND), BoucWen(1.0, 1.8, 0.03, 20.0, 0.7, 0.3, initial_z=0.4)),
        Spring("c", (GROUND, "c"), BoucWen(2.0, 0.9, 0.06, 5.0, 0.9, 0.1)),
        Spring("c too", (GROUND, "c"), Linear(3.0)),
        Spring("d", (GROUND, "d"), Linear(40.0)),
    )
    dashpots = (Dashpot((GROUND, "a"), 0.3), Dashpot(("c", GROUND), 0.2)) if damped else ()
    ends = (BARRIER, "a", "b", "c", "d", BARRIER)
    contacts = tuple(
        Contact(f"{left}{right}", left, right, gap, 0.6) for left, right in pairwise(ends)
    )
    return Scene(bodies, springs, dashpots, contacts, motion)


def test_a_row_where_they_set_out_stands_once() -> None:
    """They may do so at the very start, of which there is a row already, at an output time."""
    for gap in np.linspace(0.2, 0.9, 40):
        task = Task(row(float(gap)), 0.0, END, 1e-9, output_times=np.linspace(0.0, END, 200))
        t = solver_named("fast").solve(task).history.t
        assert (t[:2] == 0.0).sum() == 1


def test_base_shear_is_that_of_all_at_once() -> None:
    """Its peaks are those of the sum of the forces, which a fine history comes close to."""
    times = np.linspace(0.0, END, 20_001)
    for damped in (False, True):
        task = Task(row(FAR, damped=damped), 0.0, END, 1e-10, output_times=times)
        found = solver_named("fast").solve(task)
        shear = -(found.history.a @ [b.mass for b in task.scene.bodies])
        near = 1e-5 * np.abs(shear).max()
        assert found.base_shear.maximum[0] == pytest.approx(shear.max(), abs=near)
        assert found.base_shear.minimum[0] == pytest.approx(shear.min(), abs=near)
        assert found.base_shear.maximum[0] >= shear.max() - 1e-9 * near


def test_gaps_are_watched_from_one_step_to_the_other() -> None:
    """Smallest and largest gap between bodies that never touch, beside a fine history."""
    times = np.linspace(0.0, END, 20_001)
    task = Task(row(FAR), 0.0, END, 1e-10, output_times=times)
    found = solver_named("fast").solve(task)
    gap = found.history.gap
    near = 1e-6 * np.ptp(gap, axis=0).max()
    np.testing.assert_allclose(found.smallest_gap, gap.min(axis=0), rtol=0.0, atol=near)
    assert (found.smallest_gap <= gap.min(axis=0) + 1e-12 * FAR).all()
    assert found.largest_gap is not None
    np.testing.assert_allclose(found.largest_gap, gap.max(axis=0), rtol=0.0, atol=near)
    assert (found.largest_gap >= gap.max(axis=0) - 1e-12 * FAR).all()


def _with(**changes: object) -> Scene:
    return replace(row(0.2), **changes)


ROW = row(0.2)
STAY = {
    "one body": Scene(ROW.bodies[:1], ROW.springs[:1], (), ROW.contacts[:1], ROW.motion),
    "no hysteresis": _with(springs=ROW.springs[3:]),
    "a spring between two": _with(springs=(*ROW.springs, Spring("e", ("a", "b"), Linear(1.0)))),
    "two that yield": _with(
        springs=(*ROW.springs, Spring("f", (GROUND, "a"), BoucWen(1.0, 1.0, 0.1)))
    ),
    "a force": _with(forces=(Force("a", Sine(1.0, 1.0)),)),
}


def _bodies_that_may(scene: Scene) -> int:
    """How many bodies have arrays of their own."""
    scene = lowered(scene, 0.0)
    task, model = Task(scene, 0.0, END, 1e-9), assemble(scene)
    plan = plan_of(task, model, scene_scales(scene, model, END))
    return blank_series(plan, model.loads > 0).each.body.size


@pytest.mark.parametrize("why", STAY)
def test_who_never_goes_apart(why: str) -> None:
    """There are no arrays for them, and so no step that they do not need."""
    assert _bodies_that_may(STAY[why]) == 0
    assert _bodies_that_may(ROW) == len(ROW.bodies)


@pytest.mark.usefixtures("interpreted")
def test_a_run_among_many_takes_no_acceleration_over() -> None:
    """That of a run that ended with numbers that are not finite would come into the next defect."""
    at = stepper_of(ROW, np.zeros(3), 1e-9)
    at.series.expected[:] = np.nan
    clear_scratch(at.series, at.run.located, at.run.observed)
    assert (at.series.expected == 0.0).all()
