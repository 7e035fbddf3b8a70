"""SUNDIALS CVODE, of the library that scikit-sundae brings along, between events.

Events are found by the event loop on CVODE's own interpolant after each step, or
by CVODE's root finder: the page "method" of the docs says what either sees and costs.
"""

from __future__ import annotations

from collections.abc import Mapping

from eventpound.scene.contact_law import BY_WORD, IMPACT_LAWS
from eventpound.scene.spring import LawName
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.integrator import Integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.roots import OWN, finders, sundials_finds
from eventpound.solvers.settings import Settings, word
from eventpound.solvers.supported import with_supports

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
        from eventpound.solvers.sundials.compiled_cvode import DirectCvode

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
        "events": finders(OWN),
    }
    counts_steps = True
    takes_supports = True
    takes_points = True
    takes_friction = True
    impact_laws = IMPACT_LAWS
    memories = frozenset(LawName)
    lists_springs = True
    contact_laws = tuple(BY_WORD)

    def check_settings(self, settings: Settings) -> None:
        """Refuse values that it cannot take; see `eventpound.solvers.base.Solver`."""
        _choices(settings)

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        return with_supports(task, self._solve)

    def _solve(self, task: Task) -> Recording:
        method, coordinates, finds_events = _choices(task.settings)
        chosen = integrator(task.rtol, method)
        moving = coordinates == "moving"
        return EventLoop(task, chosen, moving=moving, finds_events=finds_events).run()


def _choices(settings: Settings) -> tuple[str, str, bool]:
    """The method, the coordinates, and whether CVODE's root finder finds events."""
    return (
        word(settings, "method", METHODS, METHODS[0]),
        word(settings, "coordinates", COORDINATES, COORDINATES[0]),
        sundials_finds(settings, OWN),
    )
