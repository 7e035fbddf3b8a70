"""SUNDIALS CVODE, of the library that scikit-sundae brings along, between events.

Events are found by the event loop on CVODE's own interpolant after each step, or
by CVODE's root finder: docs/method.md says what either sees and costs.
"""

from __future__ import annotations

from collections.abc import Mapping

from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.integrator import Integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.roots import EVENTS
from eventpound.solvers.sundials.settings import FINDERS, check_events, word

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
        "events": FINDERS,
    }
    counts_steps = True

    def check_settings(self, settings: Mapping[str, object]) -> None:
        """Refuse wrong values.

        Raises
        ------
        InputError
            For the first of them.
        """
        word(settings, "method", METHODS)
        word(settings, "coordinates", COORDINATES)
        check_events(settings)

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        settings = task.settings
        self.check_settings(settings)
        chosen = integrator(task.rtol, word(settings, "method", METHODS))
        moving = word(settings, "coordinates", COORDINATES) == "moving"
        loop = EventLoop(task, chosen, moving=moving)
        if word(settings, "events", EVENTS) == "sundials":
            rules = loop.now.rules
            chosen.find_events(loop.now.model, rules.length_noise, rules.force_noise)
        return loop.run()
