"""The solvers, by the names a case calls them."""

from __future__ import annotations

from eventpound.errors import InputError
from eventpound.solvers.base import Solver


def available() -> dict[str, Solver]:
    """Every solver, by name."""
    from eventpound.solvers.cvode import Cvode
    from eventpound.solvers.fast.solver import Fast
    from eventpound.solvers.ida import Ida

    return {solver.name: solver for solver in (Cvode(), Ida(), Fast())}


def solver_named(name: str) -> Solver:
    """The solver of this name.

    Raises
    ------
    InputError
        Where there is none.
    """
    known = available()
    if name not in known:
        raise InputError(f"solver = {name!r} is not known; accepted: {', '.join(known)}")
    return known[name]
