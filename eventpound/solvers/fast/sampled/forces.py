"""Absolute accelerations at the ends of the steps of `sample_steps`, and the line of the ground.

They are ``a = a_0 - K u - C v ± Q z / m``, with K and C for each unit of mass of what is linear
at present (`eventpound.solvers.fast.sampled.exact`), a_0 of the offsets of the links and the
places of their backbones, and Q z of the links on curved parts, by Φ. By Newton's second law
the base shear is ``-Σ m a`` as long as no body rests on a barrier. Every operation is rounded
by itself, so the accelerations depend on nothing but the state.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.elements import pull_per_z
from eventpound.motion.forcing import CurrentPiece, sample_time
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled, compiled_stepwise
from eventpound.solvers.fast.links import (
    DOWN,
    SATURATED,
    UP,
    elongations,
    hysteretic_variable,
    tangent,
    xi_at,
)
from eventpound.solvers.fast.run import FastRun
from eventpound.solvers.fast.sampled.exact import SampleTables, table_of


class GroundLine(NamedTuple):
    """Where the ground is, and where it goes.

    end: the sample at which the next step ends at the latest (s), inf where there is none.
    since: time since the line began (s). g, slope: acceleration at present (m/s²) and its slope
    (m/s³).
    """

    end: float
    since: float
    g: float
    slope: float


@compiled
def slope_of(segment: int, dt: float, samples: Floats) -> float:
    """Slope of the line that begins at a sample (m/s³)."""
    return float((samples[segment + 1] - samples[segment]) / dt)


@compiled
def line_at(segment: int, piece: CurrentPiece, t: float) -> GroundLine:
    """The line that begins at the sample `segment`, on which t (s) is.

    The last line of a record has no next step.
    """
    coefficients, samples = piece.coefficients, piece.samples
    if segment + 2 >= samples.size:
        return GroundLine(np.inf, 0.0, 0.0, 0.0)
    origin, dt = coefficients[0], coefficients[1]
    since = t - sample_time(origin, dt, segment)
    slope = slope_of(segment, dt, samples)
    g = samples[segment] + slope * since
    return GroundLine(sample_time(origin, dt, segment + 1), since, g, slope)


@compiled
def begin(dt: float, run: FastRun) -> int:
    """Elongations and absolute accelerations where the bodies are.

    Returned is the number of the table for the present tangents of the links and steps of dt (s).
    """
    plan, state, series = run.plan, run.state, run.series
    links, along = plan.links, series.tables.along
    elongations(links.ends, state.u, state.v, along.x, along.x_rate)
    for a in range(links.offset.size):
        series.stiffness[a] = tangent(a, links, state)
    tables, damping = series.tables, links.law.damping
    i = table_of(dt, series.stiffness, links.ends, damping, plan.mass, tables)
    accelerations_now(i, run)
    return i


@compiled
def accelerations_now(i: int, run: FastRun) -> None:
    """Absolute accelerations where the bodies are, after a change of what is linear."""
    state, series = run.state, run.series
    tables = series.tables
    _set_unmoved(run)
    accelerations(
        state.u.size, i, tables.along.x, state.u, state.v, tables.bodies.acceleration, run
    )


@compiled_stepwise
def _set_unmoved(run: FastRun) -> None:
    """Absolute accelerations at no displacement if every linear link keeps its tangent (m/s²)."""
    plan, state, series = run.plan, run.state, run.series
    links, hysteresis, unmoved = plan.links, plan.hysteresis, series.tables.bodies.unmoved
    for b in range(plan.mass.size):
        unmoved[b] = 0.0
    for a in range(links.offset.size):
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        force, h = -k * links.offset[a], links.z_of_link[a]
        if h >= 0 and not DOWN <= state.part[h] <= UP:
            xi = 1.0 if state.part[h] == SATURATED else xi_at(h, 0.0, hysteresis, state)
            z = state.sigma[h] * hysteresis.bound[h] * xi
            force += pull_per_z(a, links.law.memory) * z
        _pull(a, force, links.ends, series.inverse_mass, unmoved)


@compiled_stepwise
def _pull(a: int, force: float, ends: Ints, inverse_mass: Floats, out: Floats) -> None:
    """Add what the force of a link does to the bodies at its ends."""
    first, second = ends[a, 0], ends[a, 1]
    if first >= 0:
        out[first] += force * inverse_mass[first]
    if second >= 0:
        out[second] -= force * inverse_mass[second]


@compiled_stepwise
def accelerations(
    n: int, i: int, x: Floats, u: Floats, v: Floats, out: Floats, run: FastRun
) -> None:
    """Absolute accelerations of n bodies at the displacements u and velocities v (m/s²).

    x (L,): the elongations there (m). The hysteretic variables of links on curved parts are
    left where the series of the next step begin.
    """
    plan, state, series = run.plan, run.state, run.series
    linear_accelerations(n, i, u, v, series.tables, out)
    links, hysteresis = plan.links, plan.hysteresis
    for h in range(hysteresis.link.size):
        if DOWN <= state.part[h] <= UP:
            a = hysteresis.link[h]
            z = hysteretic_variable(h, x[a], hysteresis, state)
            series.z[h, 0] = z
            force = pull_per_z(a, links.law.memory) * z
            _pull(a, force, links.ends, series.inverse_mass, out)


@compiled_stepwise
def linear_accelerations(
    n: int, i: int, u: Floats, v: Floats, tables: SampleTables, out: Floats
) -> None:
    """As `accelerations`, where no link is on a curved part."""
    K, C = tables.stiffness, tables.damping
    for b in range(n):
        a = tables.bodies.unmoved[b]
        for c in range(n):
            a -= K[i, b, c] * u[c] + C[i, b, c] * v[c]
        out[b] = a
