"""The solvers, by the names a case calls them."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache
from pkgutil import resolve_name

from eventpound.basics.plugins import Plugins
from eventpound.case.run_options import LISTED
from eventpound.errors import InputError
from eventpound.scene.contact_law import NEWTON
from eventpound.scene.scene import Scene
from eventpound.scene.spring import LawName
from eventpound.solvers.base import Solver
from eventpound.solvers.opensees import installed
from eventpound.solvers.plugins import solvers_plugged_in, trouble_of

OPENSEES = "opensees"
_OWN = {
    "cvode": "eventpound.solvers.cvode:Cvode",
    "ida": "eventpound.solvers.ida:Ida",
    "fast": "eventpound.solvers.fast.solver:Fast",
    "moreau": "eventpound.solvers.moreau.solver:Moreau",
    "penalty": "eventpound.solvers.penalty.solver:Penalty",
    OPENSEES: "eventpound.solvers.opensees.solver:OpenSees",
}
"""Where the solvers of this package stand, by name. A run imports the one that it asks for."""


def available() -> dict[str, Solver]:
    """Every solver that can be used, by name: those of this package, then plug-ins."""
    return {**{name: _own(name) for name in _own_names()}, **plugins().found}


def plugins() -> Plugins[Solver]:
    """What other packages bring along, and what is wrong with some of it."""
    return solvers_plugged_in(_own_names())


def takes_loads(solver: Solver, scene: Scene) -> bool:
    """Whether a solver takes the supports and forces of a scene, or its decks in plan."""
    if getattr(solver, "takes_supports", False) or not scene.is_driven:
        return True
    return not scene.supports and getattr(solver, "takes_forces", False)


def takes_friction(solver: Solver, scene: Scene) -> bool:
    """Whether a solver takes the friction of contacts, if there is any, and its law of impact."""
    known: Collection[str] = getattr(solver, "impact_laws", (NEWTON,))
    takes = getattr(solver, "takes_friction", False) and scene.impact_law in known
    return not scene.rubbing or takes


def knows_laws(solver: Solver, scene: Scene) -> bool:
    """Whether a solver knows the law of every contact of a scene."""
    known: Collection[str] = getattr(solver, "contact_laws", ())
    return all(c.law is None or c.law.kind in known for c in scene.contacts)


def takes_points(solver: Solver, scene: Scene) -> bool:
    """Whether a solver takes ends at points between bodies, if there are any."""
    return not scene.at_points or getattr(solver, "takes_points", False)


def unknown_springs(solver: Solver, scene: Scene) -> dict[str, LawName]:
    """Laws that a solver does not know, by their springs."""
    known: Collection[str] = getattr(solver, "memories", ())
    return {s: law for s, law in scene.branched_springs.items() if law not in known}


def knows_springs(solver: Solver, scene: Scene) -> bool:
    """Whether a solver knows the law of every spring of a scene."""
    return not unknown_springs(solver, scene)


def lists_springs(solver: Solver, scene: Scene) -> bool:
    """Whether a solver tells the events of the springs of a scene, if any has some to list."""
    listed = set(LISTED.values()) & set(scene.branched_springs.values())
    return not listed or getattr(solver, "lists_springs", False)


def knows_scene(solver: Solver, scene: Scene) -> bool:
    """Whether a solver takes every spring and contact of a scene."""
    return all(
        can(solver, scene) for can in (knows_laws, takes_points, takes_friction, knows_springs)
    )


def _own_names() -> list[str]:
    """Solvers of this package that can be used; those that are not asked for are not imported."""
    return [name for name in _OWN if name != OPENSEES or installed()]


@cache
def _own(name: str) -> Solver:
    solver: Solver = resolve_name(_OWN[name])()
    return solver


_GIVEN: dict[str, Solver] = {}
"""Solvers that were handed over as objects, by their names."""


def name_of(solver: str | Solver) -> str:
    """Name of a solver; an object is known by its own from then on, in this process.

    Raises
    ------
    InputError
        Where it lacks a duty, or has the name of another solver.
    """
    if isinstance(solver, str):
        return solver
    trouble = trouble_of(solver)
    if trouble:
        raise InputError(f"solver = {solver!r}: {trouble}; accepted: a name, or such an object")
    if solver.name in available():
        raise InputError(f"solver = {solver!r}: another solver is called {solver.name!r}")
    _GIVEN[solver.name] = solver
    return solver.name


def solver_named(name: str) -> Solver:
    """The solver of this name.

    Raises
    ------
    InputError
        Where there is none, or where it comes with a package that does not work.
    """
    own = _own_names()
    if name in own:
        return _own(name)
    others = solvers_plugged_in(own)
    if name in others.found:
        return others.found[name]
    if name in _GIVEN:
        return _GIVEN[name]
    if name in others.troubles:
        raise InputError(f"solver = {name!r}: {others.troubles[name]}")
    if name == OPENSEES:
        where = 'the page "opensees" of the documentation'
        raise InputError(f"solver = 'opensees' needs openseespy ({where})")
    known = ", ".join((*own, *_GIVEN, *others.found))
    raise InputError(f"solver = {name!r} is not known; accepted: {known}")
