"""What is said where SUNDIALS cannot go on."""

from __future__ import annotations

from eventpound.solvers.events.integrator import StandstillError, Stretch


def could_not_continue(name: str, message: str, origin: float, stretch: Stretch) -> StandstillError:
    """The error of an integrator that stands still.

    Parameters
    ----------
    name : str
        Of the integrator.
    message : str
        SUNDIALS' own.
    origin : float
        Time from which the local ones count (s).
    stretch : Stretch
        Its steps.
    """
    return StandstillError(
        f"{name} could not continue ({message.rstrip('.')}); "
        "try a larger rtol, or look at the state written so far",
        origin + stretch.start,
        stretch,
    )
