"""Contact elements in the descriptor form: against those of clusters, slopes by differences."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound.mechanics.clusters import form_clusters_of_few
from eventpound.mechanics.contact_elements import FIRST_CODE
from eventpound.mechanics.contact_laws import element_pull, side_of_kink
from eventpound.mechanics.descriptor import Descriptor, descriptor_form
from eventpound.mechanics.descriptor_motion import Problem, jacobian, residual
from eventpound.mechanics.descriptor_observation import observe_descriptor
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.mechanics.model import Model, assemble, with_elements
from eventpound.mechanics.observables import blank
from eventpound.mechanics.reduced import forcing_of
from eventpound.motion import NoMotion
from tests.solvers.laws.test_scenes import WORDS, pair

CLOSED = np.array([0.05, 0.03])
"""Where both contacts of `pair` are closed by 1 cm."""
RATES = (np.array([0.3, 0.1]), np.array([-0.3, -0.1]))
"""Of approach and of parting, at both."""


def _form(word: str) -> tuple[Model, Descriptor]:
    model = with_elements(assemble(pair(word)))
    none = np.zeros(model.contacts, bool)
    alone = form_clusters_of_few(model.left, model.right, model.gap, none, none, model.bodies)
    branch = np.where(np.arange(model.links) < model.plain, 0, -1)
    return model, descriptor_form(model, alone, branch, ledger=model.ledger_entries)


def _problem(d: Descriptor) -> Problem:
    return Problem(d, forcing_of(NoMotion().pieces()[0], 0.0), NO_FRAME)


@pytest.mark.parametrize("v", RATES, ids=["approach", "parting"])
@pytest.mark.parametrize("word", WORDS)
def test_forces_and_their_rates(word: str, v: np.ndarray) -> None:
    model, d = _form(word)
    y, rate, seen = np.zeros(d.size), np.zeros(d.size), blank(*model.counts)
    y[:2], y[2:4] = CLOSED, v
    observe_descriptor(0.0, y, _problem(d), rate, seen)
    gaps, gap_rates = model.gaps(CLOSED), model.rates(v)
    for j in range(2):
        k, c = d.stiffness[model.plain + j], d.law.damping[model.plain + j]
        code = int(d.z_of_link[model.plain + j])
        assert code <= FIRST_CODE
        expected = -element_pull(code, k, k * model.gap[j], c, -model.gap[j] + gaps[j],
                                 gap_rates[j], 0.0)[0]  # fmt: skip
        assert seen.contact_force[0, j] == pytest.approx(expected, rel=1e-12)
    # Momentum: what springs, dashpots and the wall do, none of it the joint.
    springs = seen.force[0, : model.plain]
    total = model.mass @ seen.acceleration[0]
    assert total == pytest.approx(
        -springs[0] - springs[1] - seen.contact_force[0, 1], rel=1e-12, abs=1e-9
    )
    assert seen.shear[0] == pytest.approx(springs[0] + springs[1], rel=1e-12)
    # F' of the forces along the motion; h² of the third derivative, and rounding.
    h, sides = 1e-6, []
    for tau in (-h, h):
        moved, other = y + tau * rate, blank(*model.counts)
        moved[:2] += 0.5 * tau**2 * seen.a
        observe_descriptor(tau, moved, _problem(d), np.zeros(d.size), other)
        sides.append(other.contact_force[0])
    slope = (sides[1] - sides[0]) / (2.0 * h)
    np.testing.assert_allclose(seen.contact_force[1], slope, rtol=1e-6, atol=1e-3)


@pytest.mark.parametrize("v", RATES, ids=["approach", "parting"])
@pytest.mark.parametrize("word", WORDS)
def test_jacobian_by_central_differences(word: str, v: np.ndarray) -> None:
    cj, h = 3.7, 1e-7
    _, d = _form(word)
    y, rate = np.zeros(d.size), np.zeros(d.size)
    y[:2], y[2:4] = CLOSED, v
    J, sides = np.full((d.size, d.size), np.nan), np.empty((2, d.size))
    jacobian(0.0, y, cj, J, _problem(d))
    for i in range(d.size):
        step = np.zeros(d.size)
        step[i] = h
        residual(0.0, y + step, rate + cj * step, sides[1], _problem(d))
        residual(0.0, y - step, rate - cj * step, sides[0], _problem(d))
        # Forces of 400 N: 1e-16 of that through 2h, and h² of third derivatives 1e8.
        expected = (sides[1] - sides[0]) / (2.0 * h)
        np.testing.assert_allclose(J[:, i], expected, rtol=1e-6, atol=2e-5)


def test_sides_of_kinks() -> None:
    """A law that keeps to a side has the force of that side, whatever its state says."""
    k, gap, c = 100.0, 0.0, 5.0
    for code, x, x_rate in ((-6, -0.01, 0.2), (-7, -0.01, 0.3)):
        own = element_pull(code, k, gap, c, x, x_rate, 0.0)
        assert side_of_kink(code, k, gap, c, x, x_rate) > 0.0
        assert own == element_pull(code, k, gap, c, x, x_rate, 1.0)
        assert own[0] != element_pull(code, k, gap, c, x, x_rate, -1.0)[0]
