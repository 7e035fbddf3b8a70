"""Contacts whose forces are not unique decide nothing: a split body moves as the whole one."""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import simulate


def _row(middle: dict[str, tuple[float, float]]) -> Scene:
    """Body A, bodies in the middle (mass, stiffness) side by side, body D, a barrier."""
    masses = {"A": (1.0, 1.5), **middle, "D": (2.0, 1.0)}
    bodies = tuple(Body(name, mass) for name, (mass, _) in masses.items())
    springs = tuple(
        Spring(f"s{name}", (GROUND, name), Linear(stiffness))
        for name, (_, stiffness) in masses.items()
    )
    pairs = [("A", name) for name in middle] + [(name, "D") for name in middle] + [("D", BARRIER)]
    contacts = tuple(Contact(a + b, a, b, 0.0, 0.4) for a, b in pairs)
    return Scene(bodies, springs, (), contacts, Sine(1.0, 2.0 * math.pi, reverse=True))


def test_two_halves_side_by_side_move_as_the_whole(solver: str):
    rtol = 1e-9
    whole = simulate(_row({"B": (1.0, 1.0)}), solver, rtol, duration=25.0)
    split = simulate(_row({"B": (0.5, 0.5), "C": (0.5, 0.5)}), solver, rtol, duration=25.0)
    for body in ("A", "B", "D"):
        wanted = whole.history[f"u.{body}"]
        # The two runs take the same steps; their difference is rounding through
        # some twenty events, far below the tolerance.
        assert abs(split.final[body]["u"] - whole.final[body]["u"]) < rtol * wanted.abs().max()
    assert not split.recording.unique_forces[:4].any()
    assert whole.recording.unique_forces.all()
    assert np.all(split.recording.history.contact_force > -1e-10)
