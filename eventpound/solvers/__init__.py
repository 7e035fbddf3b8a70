"""The solvers, by the names a case calls them."""

from __future__ import annotations

from collections.abc import Collection

from eventpound.errors import InputError
from eventpound.plugins import Plugins
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Solver
from eventpound.solvers.plugins import solvers_plugged_in, trouble_of


def available() -> dict[str, Solver]:
    """Every solver that can be used, by name: those of this package, then plug-ins."""
    return {**_own(), **plugins().found}


def plugins() -> Plugins[Solver]:
    """What other packages bring along, and what is wrong with some of it."""
    return solvers_plugged_in(_own())


def takes_loads(solver: Solver, scene: Scene) -> bool:
    """Whether a solver takes the supports and forces of a scene, if there are any."""
    return not (scene.supports or scene.forces) or getattr(solver, "takes_supports", False)


def knows_laws(solver: Solver, scene: Scene) -> bool:
    """Whether a solver knows the law of every contact of a scene."""
    known: Collection[str] = getattr(solver, "contact_laws", ())
    return all(c.law is None or c.law.kind in known for c in scene.contacts)


def takes_points(solver: Solver, scene: Scene) -> bool:
    """Whether a solver takes contacts at points between bodies, if there are any."""
    at_points = any(contact.at_point for contact in scene.contacts)
    return not at_points or getattr(solver, "takes_points", False)


def knows_contacts(solver: Solver, scene: Scene) -> bool:
    """Whether a solver takes every contact of a scene."""
    return knows_laws(solver, scene) and takes_points(solver, scene)


def _own() -> dict[str, Solver]:
    from eventpound.solvers.cvode import Cvode
    from eventpound.solvers.fast.solver import Fast
    from eventpound.solvers.ida import Ida
    from eventpound.solvers.moreau.solver import Moreau
    from eventpound.solvers.opensees.solver import OpenSees, installed
    from eventpound.solvers.penalty.solver import Penalty

    own: list[Solver] = [Cvode(), Ida(), Fast(), Moreau(), Penalty()]
    if installed():
        own.append(OpenSees())
    return {solver.name: solver for solver in own}


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
    own = _own()
    if name in own:
        return own[name]
    others = solvers_plugged_in(own)
    if name in others.found:
        return others.found[name]
    if name in _GIVEN:
        return _GIVEN[name]
    if name in others.troubles:
        raise InputError(f"solver = {name!r}: {others.troubles[name]}")
    if name == "opensees":
        raise InputError("solver = 'opensees' needs openseespy (docs/opensees.md)")
    known = ", ".join((*own, *_GIVEN, *others.found))
    raise InputError(f"solver = {name!r} is not known; accepted: {known}")
