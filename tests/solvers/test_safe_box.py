"""Accelerations of bodies on linear and curved links; the box in which nothing happens."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound.solvers.fast.links import DOWN, UP, elongations, set_curve
from eventpound.solvers.fast.sampled.bounds import (
    NOTHING,
    keeps_parts,
    places_unseen,
    stays_open,
)
from eventpound.solvers.fast.sampled.exact import propose_by_matrices
from eventpound.solvers.fast.sampled.forces import begin
from eventpound.solvers.fast.sampled.safe_box import set_safe_box, stays_in_safe_box
from tests.solvers.stepping import Stepper, stepper_of
from tests.solvers.test_sample_steps import STEP, bridge

pytestmark = pytest.mark.usefixtures("interpreted")


def moving(rng: np.random.Generator) -> Stepper:
    """The bridge anywhere in its range, its frames on any part, its stop on either side."""
    at = stepper_of(bridge(True, 0.5), np.zeros(2), 1e-9)
    state, plan = at.state, at.plan
    state.u[:] = rng.uniform(-0.2, 0.2, 2)
    state.v[:] = rng.uniform(-1.0, 1.0, 2)
    for h, link in enumerate(plan.hysteresis.link):
        first, second = plan.links.ends[link]
        x = state.u[second] - (state.u[first] if first >= 0 else 0.0)
        rate = state.v[second] - (state.v[first] if first >= 0 else 0.0)
        # Half of them on the straight part in the middle.
        y = rng.uniform(-0.97, 0.97) * rng.choice([0.3, 1.0])
        set_curve(h, x, np.sign(rate), y, plan.hysteresis, state)
    state.branch[3] = np.sign(-state.u[1] - plan.links.offset[3])
    state.gap[:] = 0.5 + state.u[1] - state.u[0], 0.4 - state.u[1]
    return at._replace(table=begin(STEP, at.run))


def test_a_step_that_stays_in_its_box_meets_nothing() -> None:
    """The bounds of `sampled.bounds` agree, one by one, wherever the box says so."""
    inside = linear = 0
    for seed in range(200):
        rng = np.random.default_rng(1000 + seed)
        at = moving(rng)
        plan, state, tables, running = at.plan, at.state, at.series.tables, at.run.running
        if any(DOWN <= part <= UP for part in state.part):
            continue
        linear += 1
        sizes = np.array([1.0, 0.7, 0.3, 0.3, 0.3, 0.3, 0.6, 0.3, 9.0, 9.0, 15.0, 1.0, 1.0])
        sizes = rng.uniform(0.2, 1.0, 13)[: running.maximum.size] * sizes
        running.maximum[:], running.minimum[:] = sizes, -sizes
        bodies = tables.bodies
        bodies.pulled[:] = bodies.acceleration - rng.uniform(-1.0, 1.0)
        propose_by_matrices(2, at.table, rng.uniform(-9.0, 9.0), state.u, state.v, tables)
        set_safe_box(tables, at.run)
        if not stays_in_safe_box(2, STEP, state, tables):
            continue
        inside += 1
        along, ends = tables.along, plan.links.ends
        elongations(ends, bodies.next_u, bodies.next_v, along.next_x, along.next_x_rate)
        assert stays_open(STEP, NOTHING, -1, plan, state, tables)
        assert keeps_parts(STEP, NOTHING, -1, plan, state, tables)
        assert places_unseen(STEP, tables, at.run)
    assert linear > 50
    assert 8 < inside < linear
