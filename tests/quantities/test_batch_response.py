"""Quantities of many runs are those of each."""

from dataclasses import replace

import numpy as np

from eventpound import simulate, simulate_many
from tests.solvers.scenes import pounding_pair

END = 6.0


def test_named_quantities_of_many_are_those_of_each():
    gaps = {"contact.joint.gap": np.array([0.03, 0.045])}
    named = ["contacts.joint.sum_impulse", "peaks.a.max", "energy.viscous"]
    many = simulate_many(pounding_pair(), gaps, duration=END, quantities=named, rtol=1e-8)
    for i, gap in enumerate(gaps["contact.joint.gap"]):
        scene = pounding_pair()
        contacts = tuple(replace(c, gap=gap) if c.name == "joint" else c for c in scene.contacts)
        one = simulate(
            replace(scene, contacts=contacts), "fast", 1e-8, duration=END, energy=True
        ).summary
        assert [many.table[name][i] for name in named] == [one[name] for name in named]
