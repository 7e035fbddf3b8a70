"""Series of bodies that go by themselves and of those that are tied, as one set of equations."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound.motion.pulses import Cosine
from eventpound.scene import GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.solvers.fast.expansion import begin_series, expand
from eventpound.solvers.fast.links import DOWN, UP
from eventpound.solvers.fast.many import _clear as clear_scratch
from eventpound.solvers.fast.run import ACTIVE, LINEAR, TIED, TOGETHER, piece_of
from tests.solvers.stepping import Stepper, stepper_of

pytestmark = pytest.mark.usefixtures("interpreted")

H = 0.02
"""Length of the step (s)."""


def _scene(seed: int) -> Scene:
    """Four bodies in a row: a linear one, one that yields, and two that are joined."""
    rng = np.random.default_rng(seed)
    bodies = tuple(
        Body(name, rng.uniform(0.5, 2.0), rng.uniform(-0.1, 0.1), rng.uniform(-1.0, 1.0))
        for name in "abcd"
    )
    # The second is seen from its other end: elongation is the negative of displacement.
    springs = (
        Spring("a", (GROUND, "a"), Linear(rng.uniform(1.0, 9.0))),
        Spring("b", ("b", GROUND), BoucWen(rng.uniform(0.0, 4.0), 1.2, 0.1, 20.0)),
        Spring("c", (GROUND, "c"), BoucWen(3.0, 1.5, 0.2, 20.0, 0.7, 0.3)),
        Spring("cd", ("c", "d"), Linear(rng.uniform(1.0, 9.0))),
    )
    dashpots = (Dashpot((GROUND, "a"), 0.3), Dashpot(("b", GROUND), 0.2), Dashpot(("c", "d"), 0.1))
    contacts = tuple(Contact(f"{x}{y}", x, y, 5.0, 0.5) for x, y in ("ab", "bc", "cd"))
    return Scene(bodies, springs, dashpots, contacts, Cosine(1.5, 2.0))


def _expanded(at: Stepper, h: float) -> tuple[int, float]:
    """Order and error of the series."""
    begin_series(0.0, piece_of(0, at.plan.ground), at.run)
    return expand(h, at.plan.limits.order, at.run)


@pytest.mark.parametrize("seed", range(12))
def test_a_body_by_itself_has_the_series_that_all_together_give(seed: int) -> None:
    z = np.random.default_rng(seed).uniform(-0.97, 0.97, 2)
    at = stepper_of(_scene(seed), z, 1e-9)
    series, count = at.series, at.state.count
    hysteretic = at.plan.hysteresis.link
    assert series.apart.hysteretic.tolist() == [LINEAR, hysteretic[0], TIED, TIED]
    order, error = _expanded(at, H)
    alone = series.X.copy()
    series.apart.hysteretic[:], count[TOGETHER] = TIED, count[ACTIVE]
    series.active[:] = np.arange(at.model.links)
    other, its = _expanded(at, H)
    assert order == other == at.plan.limits.order or max(error, its) <= 0.5
    terms, others = (x[:, 2 : other + 1] * H ** np.arange(2, other + 1) for x in (alone, series.X))
    kept = terms != 0.0
    np.testing.assert_allclose(terms[kept], others[kept], rtol=1e-11, atol=1e-19)
    # Terms beyond those that a body needs are left out, as they do not count.
    left = np.abs(np.where(kept, 0.0, others)).sum(axis=1)
    assert (left <= at.plan.limits.rtol * np.abs(at.state.v) * H).all()


def test_some_of_these_are_on_curved_parts() -> None:
    """Both ways are tried where the hysteresis bends, up and down."""
    parts = set()
    for seed in range(12):
        z = np.random.default_rng(seed).uniform(-0.97, 0.97, 2)
        parts |= {int(stepper_of(_scene(seed), z, 1e-9).state.part[0])}
    assert {UP, DOWN} & parts


def test_a_run_among_many_takes_no_acceleration_over() -> None:
    """That of a run that ended with numbers that are not finite would come into the next defect."""
    at = stepper_of(_scene(0), np.zeros(2), 1e-9)
    at.series.expected[:] = np.nan
    clear_scratch(at.series, at.run.happened, at.run.seen)
    assert (at.series.expected == 0.0).all()
