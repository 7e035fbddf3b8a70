"""Absolute accelerations at the ends of the steps of `sample_steps`, and what they start from.

Where all links are linear at present they are ``a = a_0 - K u - C v``, with K and C for each
unit of mass (`eventpound.solvers.fast.sample_tables`) and a_0 of the offsets of the links and
the places of their backbones; else the forces of the links tell. By Newton's second law the base
shear is ``-Σ m a`` as long as no body rests on a barrier.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.backbone_parts import SATURATED, UNLOADING, place, set_variables
from eventpound.solvers.fast.compiled import compiled, compiled_stepwise
from eventpound.solvers.fast.elongation import elongations
from eventpound.solvers.fast.plan import Plan, Series, State
from eventpound.solvers.fast.sample_tables import (
    ACCELERATION,
    NEXT_ACCELERATION,
    NEXT_X,
    NEXT_X_RATE,
    UNMOVED,
    X_RATE,
    SampleTables,
    X,
    table_of,
)


@compiled
def begin(dt: float, plan: Plan, state: State, series: Series) -> int:
    """Elongations and absolute accelerations where the bodies are.

    Returned is the number of the table for steps of dt (s) and the present tangents of the links.
    """
    links, along = plan.links, series.tables.along
    elongations(links.ends, state.u, state.v, along[NEXT_X], along[NEXT_X_RATE])
    for a in range(links.offset.size):
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        h = links.z_of_link[a]
        if h >= 0 and state.part[h] <= UNLOADING:
            k += links.law.strength[a] / links.law.yield_displacement[a]
        series.stiffness[a] = k
    accelerations_by_forces(plan, state, series)
    end_is_now(series.tables)
    return table_of(dt, series.stiffness, links.ends, links.law.damping, plan.mass, series.tables)


@compiled
def end_is_now(tables: SampleTables) -> None:
    """Make accelerations, elongations and their rates at the end of a step those of the present."""
    bodies, along = tables.bodies, tables.along
    for b in range(bodies.shape[1]):
        bodies[ACCELERATION, b] = bodies[NEXT_ACCELERATION, b]
    for a in range(along.shape[1]):
        along[X, a], along[X_RATE, a] = along[NEXT_X, a], along[NEXT_X_RATE, a]


@compiled
def accelerations_by_forces(plan: Plan, state: State, series: Series) -> None:
    """Absolute accelerations at the end of a step by the forces of the links there (m/s²).

    The hysteretic variables there are left where the series of the next step begin.
    """
    links, law, z = plan.links, plan.links.law, series.z
    bodies, along = series.tables.bodies, series.tables.along
    set_variables(along[NEXT_X], plan.hysteresis, state, z)
    for b in range(plan.mass.size):
        bodies[NEXT_ACCELERATION, b] = 0.0
    for a in range(links.offset.size):
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        force = k * (along[NEXT_X, a] - links.offset[a]) + law.damping[a] * along[NEXT_X_RATE, a]
        h = links.z_of_link[a]
        if h >= 0:
            force += law.strength[a] * z[h, 0]
        _pull(links.ends[a, 0], links.ends[a, 1], force, bodies[NEXT_ACCELERATION])
    for b in range(plan.mass.size):
        bodies[NEXT_ACCELERATION, b] *= series.inverse_mass[b]


@compiled
def _pull(first: int, second: int, force: float, out: Floats) -> None:
    """Add the force of a link to those on the bodies at its ends."""
    if first >= 0:
        out[first] += force
    if second >= 0:
        out[second] -= force


@compiled_stepwise
def set_unmoved(plan: Plan, state: State, series: Series) -> None:
    """Absolute accelerations at no displacement if every link keeps its present tangent (m/s²)."""
    links, hysteresis, unmoved = plan.links, plan.hysteresis, series.tables.bodies[UNMOVED]
    for b in range(plan.mass.size):
        unmoved[b] = 0.0
    for a in range(links.offset.size):
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        force, h = -k * links.offset[a], links.z_of_link[a]
        if h >= 0:
            xi = 1.0 if state.part[h] == SATURATED else place(h, 0.0, hysteresis, state)
            force += links.law.strength[a] * (state.sigma[h] * hysteresis.bound[h] * xi)
        _pull(links.ends[a, 0], links.ends[a, 1], force, unmoved)
    for b in range(plan.mass.size):
        unmoved[b] *= series.inverse_mass[b]


@compiled_stepwise
def linear_accelerations(
    n: int, i: int, u: Floats, v: Floats, tables: SampleTables, out: Floats
) -> None:
    """Absolute accelerations of n bodies on links that all keep their tangents (m/s²)."""
    K, C = tables.stiffness, tables.damping
    for b in range(n):
        a = tables.bodies[UNMOVED, b]
        for c in range(n):
            a -= K[i, b, c] * u[c] + C[i, b, c] * v[c]
        out[b] = a


@compiled
def base_shear(n: int, row: int, mass: Floats, tables: SampleTables) -> float:
    """Base shear (N) that the accelerations in a row of `SampleTables.bodies` need."""
    shear = 0.0
    for b in range(n):
        shear -= mass[b] * tables.bodies[row, b]
    return shear
