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

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        method = _setting(task, "method", METHODS)
        moving = _setting(task, "coordinates", COORDINATES) == "moving"
        return EventLoop(task, integrator(task.rtol, method), moving=moving).run()


def _setting(task: Task, key: str, accepted: tuple[str, ...]) -> str:
    """A setting that is one of some words, the first where it is not given.

    Raises
    ------
    InputError
        For any other.
    """
    value = task.settings.get(key, accepted[0])
    if value not in accepted:
        raise InputError(f"[solver]: {key} = {value!r}; accepted: {' or '.join(accepted)}")
    return str(value)
