"""What breaks an invariant is an error that names it."""

import numpy as np
import pytest

from eventpound.errors import ComputationError
from eventpound.mechanics.model import assemble
from eventpound.mechanics.monitored import places_in
from eventpound.mechanics.observables import Observed, blank_observed
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.solvers.base import Energy
from eventpound.solvers.events.event_bounds import Guards
from eventpound.solvers.events.step_check import broken_contact, check_energy, contact_error

pytestmark = pytest.mark.usefixtures("interpreted")

SCENE = Scene(
    (Body("deck", 1.0),),
    (Spring("frame", (GROUND, "deck"), Linear(1.0)),),
    (),
    (Contact("joint", "deck", BARRIER, 0.1, 0.5),),
)
LENGTH_NOISE, FORCE_NOISE = 1e-15, 1e-12


def _guards(*, rests: bool) -> Guards:
    none = np.array([np.inf])
    marks = np.array([not rests]), np.array([rests])
    forces, turns = (np.zeros(1), none), np.zeros(1, np.bool_)
    at, rubs = places_in(assemble(SCENE)), (np.full(1, -1), np.zeros(1))
    return Guards(*marks, False, *forces, -none, none, turns, FORCE_NOISE, at, *rubs)


def _check(t: float, observed: Observed, guards: Guards) -> None:
    j = broken_contact(observed, guards, LENGTH_NOISE)
    if j >= 0:
        raise contact_error(t, j, observed, guards, ["joint"])


def test_penetration_names_the_contact_and_the_depth():
    observed = blank_observed(*assemble(SCENE).counts)
    observed.gap[0, 0] = -1e-6
    with pytest.raises(ComputationError, match=r"t = 2 s: contact 'joint' penetrates by 1e-06 m"):
        _check(2.0, observed, _guards(rests=False))


def test_rounding_is_not_penetration():
    observed = blank_observed(*assemble(SCENE).counts)
    observed.gap[0, 0] = -1e-16
    _check(2.0, observed, _guards(rests=False))


def test_a_resting_contact_does_not_pull():
    observed = blank_observed(*assemble(SCENE).counts)
    observed.contact_force[0, 0] = -1e-3
    with pytest.raises(ComputationError, match=r"'joint' pulls with 0.001 N"):
        _check(2.0, observed, _guards(rests=True))


@pytest.mark.parametrize("closure", [1e-2, -1e-2, np.nan])
def test_an_open_ledger_is_an_error(closure):
    ledger = Energy(0.0, 1.0, 0.5, 0.4, 0.0, 0.0, 0.1, closure)
    with pytest.raises(ComputationError, match="energy ledger fails to close"):
        check_energy(1.0, ledger, 1e-6)
    check_energy(1.0, Energy(0.0, 1.0, 0.5, 0.4, 0.0, 0.0, 0.1, 1e-5), 1e-6)
