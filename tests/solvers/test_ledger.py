"""A body alone between barriers in `fast`, by its own kernel and by that of several: the same run.

That of several keeps the energy ledger.
"""

import numpy as np
import pytest

from eventpound.mechanics.model import assemble
from eventpound.motion.pulses import Cosine, Sine
from eventpound.motion.ricker import Ricker
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.fast.constants import links_of
from eventpound.solvers.fast.sdof.body import oscillator_of
from tests.benchmarks.agreement import distances, loud, sequence
from tests.solvers.accuracy import allowed
from tests.solvers.test_several import record

RIGHT = Contact("right", "a", BARRIER, 0.2, 0.6)
LEFT = Contact("left", BARRIER, "a", 0.3, 0.4)
PULSE = Sine(1.0, 2.0 * np.pi, reverse=True)


def scene(law, *contacts, motion=PULSE, damping=0.0, body=None, ends=(GROUND, "a")) -> Scene:
    dashpots = (Dashpot((GROUND, "a"), damping),) if damping else ()
    springs = (Spring("s", ends, law),) if law else ()
    return Scene((body or Body("a", 1.3),), springs, dashpots, contacts, motion)


def bouc_wen(exponent=20.0, beta=0.5, gamma=0.5, initial_z=0.0, stiffness=0.4) -> BoucWen:
    return BoucWen(stiffness, 0.4, 0.05, exponent, beta, gamma, initial_z)


ALONE = {
    "elastic": scene(Linear(3.0), RIGHT),
    "elastic between barriers": scene(Linear(3.0), RIGHT, LEFT),
    "elastic and damped": scene(Linear(3.0), RIGHT, damping=0.3),
    "no spring": scene(None, RIGHT, LEFT, motion=Cosine(1.0, 2.0 * np.pi)),
    "elastoplastic": scene(bouc_wen(stiffness=0.0), RIGHT),
    "bilinear": scene(bouc_wen(), RIGHT, LEFT),
    "bilinear and damped": scene(bouc_wen(), RIGHT, damping=0.2),
    "turned spring": scene(bouc_wen(2.0, 0.6, 0.4), RIGHT, ends=("a", GROUND)),
    "n = 1": scene(bouc_wen(1.0), RIGHT),
    "n = 2, unloading curved": scene(bouc_wen(2.0, 0.1, 0.9), RIGHT),
    "n = 20, unloading curved": scene(bouc_wen(20.0, 0.8, 0.2), RIGHT, LEFT),
    "initial z": scene(bouc_wen(initial_z=-0.7), RIGHT, body=Body("a", 1.3, 0.1, -0.4)),
    "no strength": scene(BoucWen(3.0, 0.0, 0.05), RIGHT),
    "Ricker": scene(bouc_wen(), RIGHT, motion=Ricker(1.5, 2.0, center=3.0)),
    "record": scene(bouc_wen(), RIGHT, motion=record()),
    "record, elastic and damped": scene(Linear(9.0), RIGHT, LEFT, motion=record(), damping=0.2),
    "record, damped": scene(bouc_wen(), Contact("r", "a", BARRIER, 0.05, 0.5), motion=record()),
    "no contact": scene(bouc_wen(), motion=record()),
    "comes to rest": scene(Linear(3.0), Contact("r", "a", BARRIER, 0.02, 0.3)),
}
PEAKS = ("displacement", "elongation", "acceleration", "base_shear")
TIES = {"elastoplastic": ("acceleration", "base_shear")}
"""What is largest at many times: all along a yield plateau."""
END = 12.0
"""Length of a run (s)."""


def both(of: Scene, rtol: float) -> tuple[Recording, Recording]:
    """Without the ledger and with it."""
    times = np.linspace(0.0, END, 61)
    tasks = (Task(of, 0.0, END, rtol, output_times=times, energy=e) for e in (False, True))
    without, kept = (solver_named("fast").solve(task) for task in tasks)
    return without, kept


def assert_near(one: object, other: object, error: float, **scales: float) -> None:
    """Arrays or numbers of both, by their names, each to a part of its scale."""
    for name, scale in scales.items():
        mine, theirs = getattr(one, name), getattr(other, name)
        np.testing.assert_allclose(mine, theirs, rtol=0.0, atol=error * scale, err_msg=name)


@pytest.mark.parametrize("of", ALONE.values(), ids=ALONE)
def test_a_body_alone_has_a_way_of_its_own_without_a_ledger(of):
    model = assemble(of)
    assert oscillator_of(model, 1.0, links_of(model), energy=False).alone
    assert not oscillator_of(model, 1.0, links_of(model), energy=True).alone


@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
@pytest.mark.parametrize("name", ALONE)
def test_the_same_run(name, rtol):
    """Ends, extremes, events and rows, to what the tolerance allows."""
    without, kept = both(ALONE[name], rtol)
    error = allowed(1.0, rtol)
    apart = distances(kept, without, END)
    if without.resting_time.sum() > 0.0:
        # At rest the acceleration is the ground's, known at the ends of steps only.
        apart = {key: apart[key] for key in apart if not key.startswith("a_")}
    narrow = ("u", "v", "u_max", "u_min", "gap", "x_max", "x_min")
    bounds = {key: error if key in narrow else 10.0 * error for key in apart}
    assert {key: value for key, value in apart.items() if value > bounds[key]} == {}

    # A rate is zero at a peak, a gap at an impact: the error of such a time is theirs over how
    # fast they change. In these scenes that takes no more than the length of the run.
    for which in PEAKS:
        if which not in TIES.get(name, ()):
            peaks = getattr(without, which), getattr(kept, which)
            assert_near(*peaks, error, time_of_maximum=END, time_of_minimum=END)
    assert sequence(without) == sequence(kept)
    rows = kept.history
    speed = np.abs(rows.v).max()
    hardest, most = (
        max((getattr(e, what) for e in kept.events), default=0.0)
        for what in ("impulse", "energy_lost")
    )
    for events in zip(loud(without), loud(kept), strict=True):
        assert_near(
            *events,
            error,
            t=END,
            gap_velocity_before=speed,
            gap_velocity_after=speed,
            impulse=hardest,
            energy_lost=most,
        )
    # The rows beside an event stand where it happens: there an error of its time counts.
    assert_near(without.history, rows, error, t=END)
    columns = ("u", "v", "a", "z", "force", "gap")
    sizes = {key: np.abs(getattr(rows, key)).max(initial=0.0) for key in columns}
    assert_near(without.history, rows, 10.0 * error, **sizes)
