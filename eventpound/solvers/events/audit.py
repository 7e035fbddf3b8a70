"""Invariants of a run: one that breaks them stops and says so.

The state after every step is audited where it is examined
(`eventpound.solvers.events.examination`: numbers that are none, |z| beyond its
bound); here are the rules for contacts and energy.
"""

from __future__ import annotations

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.observables import Observed
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Energy
from eventpound.solvers.events.happening import Noise
from eventpound.solvers.events.inspection import Watched

CONTACT_NOISE = 1e3
"""Multiples of the noise of a gap or contact force that are an error."""
ENERGY_ERROR = 1e3
"""Multiples of rtol by which the energy ledger may fail to close."""


def check_contacts(t: float, seen: Observed, watched: Watched, noise: Noise, scene: Scene) -> None:
    """Stop where a contact penetrates or pulls and no event was found.

    Raises
    ------
    ComputationError
        Naming the contact.
    """
    deep = watched.open_contacts & (seen.gap[0] < -CONTACT_NOISE * noise.length)
    if deep.any():
        j = int(np.flatnonzero(deep)[0])
        raise ComputationError(
            f"contact {scene.contacts[j].name!r} penetrates by {-seen.gap[0, j]:.3g} m; "
            "try a smaller rtol",
            t,
        )
    pulls = watched.unlocked & (seen.contact_force[0] < -CONTACT_NOISE * noise.force)
    if pulls.any():
        j = int(np.flatnonzero(pulls)[0])
        raise ComputationError(
            f"resting contact {scene.contacts[j].name!r} pulls with "
            f"{-seen.contact_force[0, j]:.3g} N; try a smaller rtol",
            t,
        )


def check_energy(t: float, energy: Energy, rtol: float) -> None:
    """Stop where the energy ledger does not close.

    Raises
    ------
    ComputationError
        With the error as part of the largest term.
    """
    if not abs(energy.closure) <= ENERGY_ERROR * rtol:
        raise ComputationError(
            f"the energy ledger fails to close by {energy.closure:.3g} of its largest term; "
            "try a smaller rtol",
            t,
        )
