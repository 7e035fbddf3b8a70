"""What is said where SUNDIALS cannot go on."""

from __future__ import annotations

from eventpound.errors import ComputationError


def could_not_continue(name: str, message: str, t: float) -> ComputationError:
    """The error of an integrator that stands still.

    Parameters
    ----------
    name : str
        Of the integrator.
    message : str
        SUNDIALS' own.
    t : float
        Time of its last step (s).
    """
    return ComputationError(
        f"{name} could not continue ({message.rstrip('.')}); "
        "try a larger rtol, or look at the state written so far",
        t,
    )
