"""The solvers, by the names a case calls them."""

from __future__ import annotations

from eventpound.errors import InputError
from eventpound.plugins import Plugins
from eventpound.solvers.base import Solver
from eventpound.solvers.plugins import solvers_plugged_in


def available() -> dict[str, Solver]:
    """Every solver that can be used, by name: those of this package, then plug-ins."""
    return {**_own(), **plugins().found}


def plugins() -> Plugins[Solver]:
    """What other packages bring along, and what is wrong with some of it."""
    return solvers_plugged_in(_own())


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
    if name in others.troubles:
        raise InputError(f"solver = {name!r}: {others.troubles[name]}")
    if name == "opensees":
        raise InputError("solver = 'opensees' needs openseespy (docs/opensees.md)")
    known = ", ".join((*own, *others.found))
    raise InputError(f"solver = {name!r} is not known; accepted: {known}")
