"""How CVODE is set up for a mode."""

from __future__ import annotations

from typing import NamedTuple

from eventpound.mechanics.contact_elements import SMOOTH_CODES
from eventpound.mechanics.reduced import Reduced, bandwidth
from eventpound.numerics.arrays import Floats

NO_RTOL = 1e-15
"""Relative tolerance where the absolute ones alone are to govern."""
LOCAL_SHARE = 0.1
"""Part of the tolerance given to one step, since the errors of many steps add up."""
BENT_SHARE = 0.1
"""Part of that for a step with a contact element whose force is no smooth function of the
overlap: the method's own estimate of its error falls short where the contact ends."""
BANDED_FROM = 48
"""Length of the state vector from which a banded Jacobian is used where it is narrow."""


class Layout(NamedTuple):
    """Tolerances of a step and half bandwidth of the Jacobian, 0 where it is dense.

    `key` tells layouts apart.
    """

    rtol: float
    atol: Floats
    band: int

    @property
    def key(self) -> tuple[float, bytes, int]:
        """What one CVODE object can serve."""
        return self.rtol, self.atol.tobytes(), self.band


def layout(system: Reduced, frame: Floats, rtol: float, atol: Floats) -> Layout:
    """The layout for a mode.

    Parameters
    ----------
    system : Reduced
        The equations of motion.
    frame : ndarray, shape (4, n)
        The moving frame.
    rtol : float
        Relative tolerance of the motion.
    atol : ndarray, shape (size,)
        Absolute tolerances of the motion.
    """
    band = bandwidth(system) if system.size > BANDED_FROM else system.size
    # Positions in a moving frame are larger than what they stand for.
    framed = frame.shape[1] > 0
    share = LOCAL_SHARE * (BENT_SHARE if (system.iz < SMOOTH_CODES).any() else 1.0)
    return Layout(
        NO_RTOL if framed else max(share * rtol, NO_RTOL),
        (2.0 if framed else 1.0) * share * atol,
        band if 3 * band < system.size else 0,
    )
