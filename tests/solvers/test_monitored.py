"""Which columns of a table of extremes are whose, and that only one module knows."""

import sys
from contextlib import nullcontext
from dataclasses import asdict, replace

import numpy as np
import pytest

from eventpound.mechanics import monitored
from eventpound.mechanics.model import assemble
from eventpound.mechanics.monitored import (
    KINDS,
    SCALES,
    Places,
    Sizes,
    blank_extremes,
    columns_of_kind,
    places_in,
)
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import by_python, in_python
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
from eventpound.solvers.base import Extremes, Recording, Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast import solver as fast

MADE_UP = 3
"""Columns of a quantity that is made up, before all others; no value of it is ever new."""


def shaken(yields: bool = False) -> Scene:
    """Two bodies, a spring between them and a barrier, under a record; they pound."""
    left = BoucWen(4.0, 1.2, 0.1) if yields else Linear(16.0)
    springs = (
        Spring("left", (GROUND, "a"), left),
        Spring("right", ("b", GROUND), Linear(10.0)),
        Spring("cable", ("a", "b"), Linear(0.8)),
    )
    contacts = (Contact("joint", "a", "b", 0.02, 0.7), Contact("end", "b", BARRIER, 0.1, 0.5))
    record = Record(2.0 * np.sin(0.3 * np.arange(60)), 0.05)
    dashpots = (Dashpot((GROUND, "a"), 0.3),)
    return Scene((Body("a", 1.0), Body("b", 2.0)), springs, dashpots, contacts, record)


def alone() -> Scene:
    """One body between two barriers, on which it comes to rest now and then."""
    scene = shaken(True)
    contacts = (Contact("end", "a", BARRIER, 0.1, 0.0), Contact("other", BARRIER, "a", 0.1, 0.5))
    return replace(scene, bodies=scene.bodies[:1], springs=scene.springs[:1], contacts=contacts)


def damped() -> Scene:
    """One body that turns within steps from sample to sample, where its acceleration does not."""
    scene, spring = shaken(), Spring("left", (GROUND, "a"), Linear(4.0))
    contacts, dashpots = (Contact("end", "a", BARRIER, 1.0, 0.5),), (Dashpot((GROUND, "a"), 1.0),)
    return Scene(scene.bodies[:1], (spring,), dashpots, contacts, scene.motion)


def resting() -> Scene:
    """Two bodies that meet and rest: extremes are remembered before a mode that may be none."""
    pushed = BilinearElastic(4.0, 4.0, 0.1)
    springs = Spring("left", (GROUND, "a"), pushed), Spring("right", (GROUND, "b"), Linear(1.0))
    joint = Contact("joint", "a", "b", 0.01, 0.0)
    return Scene((Body("a", 1.0), Body("b", 1.0)), springs, (), (joint,))


SCENES = {
    "a record": shaken(),
    "that yields": shaken(True),
    "alone": alone(),
    "damped": damped(),
    "at rest": resting(),
}


def test_columns_follow_each_other_and_are_told_for_every_kind():
    at = places_in(assemble(shaken()))
    counts = {kind: len(range(at.end)[columns_of_kind(kind, at)]) for kind in KINDS}
    assert counts == {
        "displacement": 2,
        "elongation": 3,
        "gap": 2,
        "acceleration": 2,
        "base_shear": 1,
        "contact_force": 2,
    }
    assert sum(counts.values()) == at.end
    assert len(SCALES) == len(KINDS)


def test_columns_of_many_runs_have_the_scales_of_each():
    """The rounding of a run among many is that of the run by itself."""
    scene = shaken()
    model = assemble(scene)
    scales = scene_scales(scene, model, 3.0)
    one = blank_extremes(places_in(model), scales)
    columns = replace(scales, length=np.array([scales.length, 2.0 * scales.length]))
    many = blank_extremes(places_in(model), columns)
    np.testing.assert_array_equal(many[0], one)
    np.testing.assert_array_equal(many[1, 4], 2.0 * one[4])


@pytest.mark.parametrize(
    ("name", "solver"),
    [(name, "fast") for name in SCENES] + [("that yields", s) for s in ("moreau", "cvode", "ida")],
)
def test_nobody_else_knows_where_they_are(name, solver, monkeypatch):
    """With columns of another quantity in front every run finds the same extremes."""
    expected = _run(SCENES[name], solver)
    original = monitored.places_of
    itself = in_python(original)

    def moved(bodies: int, springs: int, contacts: int) -> Places:
        return Places(*(place + MADE_UP for place in itself(bodies, springs, contacts)))

    def filled(at: Places, scales: Sizes) -> Floats:
        table = blank_extremes(at, scales)
        table[..., 0, :MADE_UP], table[..., 2, :MADE_UP] = np.inf, -np.inf
        return table

    # No run is made in arrays that were laid out before.
    monkeypatch.setattr(fast, "_last_of_thread", fast._LastOfThread())
    for module in list(sys.modules.values()):
        if getattr(module, "places_of", None) is original:
            monkeypatch.setattr(module, "places_of", moved)
        if (
            getattr(module, "blank_extremes", None) is blank_extremes
            and module.__name__ != __name__
        ):
            monkeypatch.setattr(module, "blank_extremes", filled)
    found = _run(SCENES[name], solver)
    assert places_in(assemble(SCENES[name])).gap == MADE_UP
    for kept in (*KINDS, "smallest_gap", "largest_gap", "max_force"):
        np.testing.assert_equal(_plain(found, kept), _plain(expected, kept), err_msg=kept)


def _plain(recording: Recording, name: str) -> object:
    kept = getattr(recording, name, None)
    return asdict(kept) if isinstance(kept, Extremes) else kept


def _run(scene: Scene, solver: str) -> Recording:
    settings = {"time_step": 1e-3} if solver == "moreau" else {}
    task = Task(scene, 0.0, 1.5, 1e-5, settings=settings)
    with nullcontext() if solver in ("cvode", "ida") else by_python():
        return solver_named(solver).solve(task)
