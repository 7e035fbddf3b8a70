"""Solvers that other packages bring along, through the entry points ``eventpound.solvers``.

An entry point names a class that can be made without arguments, or an object, with the
duties of `eventpound.solvers.base.Solver`.
"""

from __future__ import annotations

from collections.abc import Container, Mapping

from eventpound.basics.plugins import Plugins, plugged_in
from eventpound.solvers.base import Solver

GROUP = "eventpound.solvers"
DUTIES = ("name", "summary", "settings", "solve")


def solvers_plugged_in(taken: Container[str]) -> Plugins[Solver]:
    """Solvers of other packages.

    Parameters
    ----------
    taken : container of str
        Names that are not free any more.
    """
    return plugged_in(GROUP, "solver", taken, trouble_of)


def trouble_of(solver: object) -> str:
    """Which duties it lacks; empty where it lacks none."""
    lacking = [duty for duty in DUTIES if not hasattr(solver, duty)]
    if lacking:
        return f"has no {', '.join(lacking)}; a solver has {', '.join(DUTIES)}"
    settings, solve = getattr(solver, "settings", None), getattr(solver, "solve", None)
    if not isinstance(settings, Mapping) or not callable(solve):
        return "settings must be a mapping and solve a function"
    return ""
