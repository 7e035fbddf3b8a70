"""SUNDIALS CVODE, of the library that scikit-sundae brings along, between events.

Events are found by the event loop on CVODE's own interpolant after each step,
not by CVODE's root finder: docs/method.md says why and what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping

from eventpound.errors import InputError
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.integrator import Integrator
from eventpound.solvers.events.loop import EventLoop

METHODS = ("Adams", "BDF")
"""Multistep families, the default first."""


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
    }
    kernels = "events"

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        method = task.settings.get("method", METHODS[0])
        if method not in METHODS:
            raise InputError(f"[solver]: method = {method!r}; accepted: {' or '.join(METHODS)}")
        return EventLoop(task, integrator(task.rtol, str(method))).run()
