"""SUNDIALS CVODE, of the library that scikit-sundae brings along, between events.

Events are found by the event loop on CVODE's own interpolant after each step,
not by CVODE's root finder: docs/method.md says why and what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping

from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.integrator import Integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.settings import Settings, word

METHODS = ("Adams", "BDF")
"""Multistep families, the default first."""
COORDINATES = ("moving", "relative")
"""Of a record: a frame in which it is smoother, or relative to the ground."""


def integrator(rtol: float, method: str) -> Integrator:
    """CVODE for one run, called from compiled code where that can be had.

    Parameters
    ----------
    rtol : float
        Relative tolerance of the motion.
    method : str
        One of `METHODS`.
    """
    from eventpound.solvers.sundials.library import library

    found = library()
    if found is not None:
        from eventpound.solvers.sundials.direct import DirectCvode

        return DirectCvode(found, rtol, method)
    from eventpound.solvers.sundials.wrapped import WrappedCvode

    return WrappedCvode(rtol, method)


class Cvode:
    """The reference solver."""

    name = "cvode"
    summary = "SUNDIALS CVODE between events: the reference"
    settings: Mapping[str, str] = {
        "method": 'multistep family, "Adams" (default) or "BDF"',
        "coordinates": 'under a record: "moving" (default), a frame in which it is smoother, '
        'or "relative" to the ground',
    }
    counts_steps = True

    def check_settings(self, settings: Settings) -> None:
        """Refuse values that it cannot take; see `eventpound.solvers.base.Solver`."""
        _choices(settings)

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        method, coordinates = _choices(task.settings)
        moving = coordinates == "moving"
        return EventLoop(task, integrator(task.rtol, method), moving=moving).run()


def _choices(settings: Settings) -> tuple[str, str]:
    """The method and the coordinates."""
    return (
        word(settings, "method", METHODS, METHODS[0]),
        word(settings, "coordinates", COORDINATES, COORDINATES[0]),
    )
