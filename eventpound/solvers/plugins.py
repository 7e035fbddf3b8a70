"""Solvers that other packages bring along, through the entry points ``eventpound.solvers``.

An entry point names a class that can be made without arguments, or an object, with the
duties of `eventpound.solvers.base.Solver`. What cannot be loaded or lacks a duty is left
out and its trouble kept, so that it spoils nothing else and can be named when it is asked
for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points

from eventpound.solvers.base import Solver

GROUP = "eventpound.solvers"
DUTIES = ("name", "summary", "settings", "solve")


@dataclass(frozen=True)
class Plugins:
    """What the installed packages offer.

    Parameters
    ----------
    solvers : mapping of str to Solver
        Those that can be used.
    troubles : mapping of str to str
        A sentence on each that cannot, by the name of its entry point.
    """

    solvers: Mapping[str, Solver]
    troubles: Mapping[str, str]


def plugged_in(taken: Mapping[str, Solver]) -> Plugins:
    """Solvers of other packages.

    Parameters
    ----------
    taken : mapping of str to Solver
        Solvers whose names are not free any more.
    """
    solvers: dict[str, Solver] = {}
    troubles: dict[str, str] = {}
    for entry in entry_points(group=GROUP):
        try:
            solver = _made(entry)
        # Whatever another package does wrong must not stop the others.
        except Exception as error:
            troubles[entry.name] = f"{_place(entry)} cannot be loaded: {_what(error)}"
            continue
        trouble = trouble_of(solver)
        if not trouble and (solver.name in taken or solver.name in solvers):
            trouble = f"another solver is called {solver.name!r}"
        if trouble:
            troubles[entry.name] = f"{_place(entry)}: {trouble}"
        else:
            solvers[solver.name] = solver
    return Plugins(solvers, troubles)


def _made(entry: EntryPoint) -> Solver:
    loaded = entry.load()
    solver: Solver = loaded() if isinstance(loaded, type) else loaded
    return solver


def trouble_of(solver: object) -> str:
    """Which duties it lacks; empty where it lacks none."""
    lacking = [duty for duty in DUTIES if not hasattr(solver, duty)]
    if lacking:
        return f"has no {', '.join(lacking)}; a solver has {', '.join(DUTIES)}"
    settings, solve = getattr(solver, "settings", None), getattr(solver, "solve", None)
    if not isinstance(settings, Mapping) or not callable(solve):
        return "settings must be a mapping and solve a function"
    return ""


def _place(entry: EntryPoint) -> str:
    package = f" of {entry.dist.name}" if entry.dist is not None else ""
    return f"the entry point {entry.name} = {entry.value}{package}"


def _what(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
