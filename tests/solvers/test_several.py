"""Several bodies: peaks beside fine histories; rows, pauses and a ledger change nothing."""

from itertools import pairwise

import numpy as np
import pytest

from eventpound.mechanics.model import assemble
from eventpound.motion.base import GroundMotion
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.mavroeidis_papageorgiou import MavroeidisPapageorgiou
from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.record import Record
from eventpound.motion.ricker import Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast import solver as fast
from eventpound.solvers.fast.constants import blank_located, blank_series, clear_scratch, plan_of
from eventpound.solvers.fast.evaluate import blank_fast_observed

END, STEP = 9.0, 0.02
"""Length of a run (s), and of a step of the record."""
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


def test_base_shear_is_that_of_all_at_once():
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


def test_gaps_are_watched_from_one_step_to_the_other():
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


@pytest.mark.usefixtures("interpreted")
def test_a_run_among_many_takes_no_acceleration_over():
    """That of a run that ended with numbers that are not finite would come into the next defect."""
    task, model = Task(row(0.2), 0.0, END, 1e-9), assemble(row(0.2))
    plan = plan_of(task, model, scene_scales(task.scene, model, END))
    series = blank_series(plan)
    series.expected[:] = np.nan
    clear_scratch(series, blank_located(plan), blank_fast_observed(plan))
    assert (series.expected == 0.0).all()


def record() -> Record:
    t = STEP * np.arange(501)
    return Record(np.sin(2.3 * t) * np.sin(7.1 * t + 1.0) * np.exp(-(((t - 4.0) / 3.0) ** 2)), STEP)


def bridge(yields: bool, gap: float, damping: float = 0.3) -> Scene:
    """Two segments on springs, joined by a cable, one with a stop that acts when pushed into."""
    laws = (
        (BoucWen(4.0, 1.2, 0.1, 20.0), BoucWen(3.0, 1.5, 0.2, 20.0, 0.7, 0.3))
        if yields
        else (Linear(16.0), Linear(10.5))
    )
    springs = (
        Spring("left", (GROUND, "a"), laws[0]),
        Spring("right", (GROUND, "b"), laws[1]),
        Spring("cable", ("a", "b"), Linear(0.8)),
        Spring("stop", ("b", GROUND), BilinearElastic(9.0, 0.4, 0.02)),
    )
    dashpots = (Dashpot((GROUND, "a"), damping), Dashpot(("a", "b"), 0.5 * damping))
    contacts = (Contact("joint", "a", "b", gap, 0.7), Contact("end", "b", BARRIER, 0.4, 0.5))
    bodies = (Body("a", 1.0), Body("b", 2.2, 0.01, 0.05))
    return Scene(bodies, springs, dashpots if damping else (), contacts, record())


SCENES = {
    "linear": bridge(False, 2.0),
    "linear, pounding": bridge(False, 0.02),
    "yielding, undamped": bridge(True, 2.0, 0.0),
    "yielding, pounding": bridge(True, 0.03),
    **{motion: row(0.2, MOTIONS[motion]) for motion in MOTIONS},
}


def solved(scene: Scene, rows: int, energy: bool = False) -> Recording:
    times = np.linspace(0.0, END, rows)
    return solver_named("fast").solve(
        Task(scene, 0.0, END, 1e-8, output_times=times, energy=energy)
    )


@pytest.mark.parametrize("name", SCENES)
def test_rows_pauses_and_a_ledger_change_nothing(name, monkeypatch):
    few, many = solved(SCENES[name], rows=2), solved(SCENES[name], rows=1777)
    kept = solved(SCENES[name], rows=2, energy=True)
    monkeypatch.setattr(fast, "BUDGET", 3)
    for other in (many, kept, solved(SCENES[name], rows=2)):
        assert other.work.steps == few.work.steps
        for which in ("u", "v", "z", "smallest_gap"):
            np.testing.assert_array_equal(getattr(other, which), getattr(few, which))
        np.testing.assert_array_equal(other.displacement.maximum, few.displacement.maximum)
        np.testing.assert_array_equal(other.base_shear.minimum, few.base_shear.minimum)
