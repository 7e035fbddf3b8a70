"""Invariants of a run: one that breaks them stops and says so.

The state after every step is audited where it is examined
(`eventpound.solvers.events.step_check`: numbers that are none, |z| beyond its
bound); here are the rules for contacts and energy.
"""

from __future__ import annotations

from eventpound.errors import ComputationError
from eventpound.mechanics.observables import Observed
from eventpound.numerics.compiled import scalar_kernel
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Energy
from eventpound.solvers.events.event_bounds import Watched

CONTACT_NOISE = 1e3
"""Multiples of the noise of a gap or contact force that are an error."""
ENERGY_ERROR = 1e3
"""Multiples of rtol by which the energy ledger may fail to close."""


@scalar_kernel
def broken_contact(seen: Observed, watched: Watched, length_noise: float) -> int:
    """The first contact that penetrates or pulls although no event was found, or -1.

    `length_noise`: gaps below this have no sign (m).
    """
    for j in range(seen.gap.shape[1]):
        if watched.open_contacts[j] and seen.gap[0, j] < -CONTACT_NOISE * length_noise:
            return j
    for j in range(seen.gap.shape[1]):
        if watched.unlocked[j] and seen.contact_force[0, j] < -CONTACT_NOISE * watched.force_noise:
            return j
    return -1


def contact_error(
    t: float, j: int, seen: Observed, watched: Watched, scene: Scene
) -> ComputationError:
    """What to raise of contact j, which `broken_contact` names."""
    name = scene.contacts[j].name
    if watched.open_contacts[j]:
        depth = -float(seen.gap[0, j])
        return ComputationError(
            f"contact {name!r} penetrates by {depth:.3g} m; try a smaller rtol", t
        )
    pull = -float(seen.contact_force[0, j])
    return ComputationError(
        f"resting contact {name!r} pulls with {pull:.3g} N; try a smaller rtol", t
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
