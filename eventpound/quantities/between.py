"""The motion between the rows of a history: extremes and integrals of what no solver locates.

A run is made again with rows close together, and with one on either side of every jump of the
ground acceleration. On a cell between two rows

    x(t)    is the quintic of x, x', x'' at both ends       error O(h^6 x^(6))
    F(t)    is the cubic of F, F' at both ends              error O(h^4 F'''')

and an extreme of F is one of its rows or of the roots of F'. Where a hysteretic spring turns
(x' = 0) the slope of its force breaks: a row is put there, with z carried to it by its law
along x, which needs no time. Work is summed by the trapezoidal rule with its end correction,
``h (f_0 + f_1)/2 + h^2 (f_0' - f_1')/12``, error O(h^4); that on Q z along x instead of t, where
both the elastic and the yielded part are exact.

Rows are doubled until none of the sums and extremes of a run changes by more than `AGREEMENT`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from eventpound.errors import AccuracyWarning
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.supported import lowered
from eventpound.motion.base import Family, GroundMotion
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.scene.elastic_laws import elastic_force
from eventpound.scene.periods import local_periods
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.solvers.base import Extremes, Recording, Task

AGREEMENT = 1e-7
"""Part of its own size by which a number may still change when rows are doubled."""
ROWS_A_PERIOD = 80.0
"""Rows in the shortest period, at first."""
FEWEST_ROWS, MOST_ROWS = 1000, 2_000_000
_DOUBLINGS = 4
_MOST_PIECES = 100_000
_MOST_NAMED = 3
"""Numbers that a warning names."""


@dataclass(frozen=True)
class Between:
    """The motion of a scene on cells between rows; N bodies, H hysteretic springs.

    Parameters
    ----------
    scene : Scene
        What moves.
    t : ndarray, shape (n,)
        Times of the rows (s), twice at events.
    u, v, a : ndarray, shape (n, N)
        Displacement (m), velocity (m/s) and acceleration (m/s^2) relative to the ground.
    z : ndarray, shape (n, H)
        Hysteretic variables.

    A scene with supports is a lowered one (`eventpound.mechanics.supported`), and they are the
    first bodies.
    """

    scene: Scene
    t: Floats
    u: Floats
    v: Floats
    a: Floats
    z: Floats

    @cached_property
    def model(self) -> Model:
        """The scene as arrays."""
        return assemble(self.scene)

    def extremes(self, values: Floats, slopes: Floats) -> Extremes:
        """Extremes of something with a value and a slope at every row, each of one entry."""
        t, found = _turning_points(self.t, values, slopes)
        t, found = np.concatenate([self.t, t]), np.concatenate([values, found])
        order = np.argsort(t, kind="stable")
        t, found = t[order], found[order]
        high, low = int(np.argmax(found)), int(np.argmin(found))
        return Extremes(found[[high]], t[[high]], found[[low]], t[[low]])

    def velocity(self, body: int) -> Extremes:
        """Extremes of the velocity of a body (m/s)."""
        body += self.model.supports
        return self.extremes(self.v[:, body], self.a[:, body])

    def gap(self, contact: int) -> Extremes:
        """Extremes of a gap (m)."""
        left, right = self.model.left[contact], self.model.right[contact]
        gap, rate = _difference(self.u, left, right), _difference(self.v, left, right)
        for row in self.model.spread[self.model.points == contact]:
            gap, rate = self.u @ row, self.v @ row
        return self.extremes(gap + self.model.gap[contact], rate)

    def force(self, spring: int) -> Extremes:
        """Extremes of the force of a spring, without the dashpot beside it (N)."""
        values, _ = self.spring_force(spring)
        # Between turning points, which are rows, the force of a law of this kind is monotone.
        return self.extremes(values, np.zeros_like(values))

    def shear(self, bodies: Ints) -> Extremes:
        """Extremes of the force that springs and dashpots of some bodies put on the ground (N)."""
        return self._sum_on(-1, bodies + self.model.supports)

    def shear_of_support(self, name: str, scene: Scene) -> Extremes:
        """Extremes of the force that springs and dashpots put on a support (N).

        `scene` still has those that move with the ground, by their names.
        """
        value, slope = np.zeros_like(self.t), np.zeros_like(self.t)
        place = {body.name: i for i, body in enumerate(self.scene.bodies)}
        for i, spring in enumerate(scene.springs):
            sign = _side(name, spring.between)
            if sign:
                force, rate = self.spring_force(i)
                value, slope = value + sign * force, slope + sign * rate
        for d in scene.dashpots:
            sign = _side(name, d.between) * d.coefficient
            if sign:
                first, second = (place.get(end, -1) for end in d.between)
                value = value + sign * _difference(self.v, first, second)
                slope = slope + sign * _difference(self.a, first, second)
        return self.extremes(value, slope)

    def _sum_on(self, place: int, bodies: Ints) -> Extremes:
        """Extremes of the sum of the forces of links from some bodies on one place (N)."""
        value, slope = np.zeros_like(self.t), np.zeros_like(self.t)
        for link, (first, second) in enumerate(self.model.link_ends):
            if place not in (first, second) or not {first, second} - {place} <= {*bodies.tolist()}:
                continue
            sign = 1.0 if first == place else -1.0
            force, rate = self.spring_force(link)
            c = self.model.law.damping[link]
            value += sign * (force + c * self.elongation(link, self.v))
            slope += sign * (rate + c * self.elongation(link, self.a))
        return self.extremes(value, slope)

    def work_on_z(self, spring: int) -> float:
        """Work done on the Q z part of a spring (J)."""
        x, z, law = self.elongation(spring, self.u), self.hysteretic(spring), self.model.law
        dx = np.diff(x)
        rate = self.z_by_x(spring, z[:-1], np.sign(dx)), self.z_by_x(spring, z[1:], np.sign(dx))
        cells = dx * (z[:-1] + z[1:]) / 2.0 + dx**2 * (rate[0] - rate[1]) / 12.0
        return float(law.strength[spring] * cells.sum())

    def dissipated(self, spring: int) -> float:
        """Work done on the Q z part of a spring, less what z can give back (J)."""
        law, z = self.model.law, self.hysteretic(spring)
        stored = 0.5 * law.strength[spring] * law.yield_displacement[spring] * z[[0, -1]] ** 2
        return self.work_on_z(spring) - float(stored[1] - stored[0])

    def work_of_dashpot(self, dashpot: int) -> float:
        """Work done in a dashpot (J)."""
        names = [body.name for body in self.scene.bodies]
        one = self.scene.dashpots[dashpot]
        first, second = (-1 if end == GROUND else names.index(end) for end in one.between)
        rate, second_rate = _difference(self.v, first, second), _difference(self.a, first, second)
        power, slope, h = rate**2, 2.0 * rate * second_rate, np.diff(self.t)
        cells = h * (power[:-1] + power[1:]) / 2.0 + h**2 * (slope[:-1] - slope[1:]) / 12.0
        return float(one.coefficient * cells.sum())

    def sums(self) -> dict[str, Floats]:
        """Numbers by which two of them are compared, by what they are called."""
        own = self.model.bodies - self.model.supports
        found: dict[str, Floats] = {}
        for i, body in enumerate(self.scene.bodies[self.model.supports :]):
            x = self.velocity(i)
            found[f"velocity of {body.name}"] = np.array([x.maximum[0], x.minimum[0]])
        whole = self.shear(np.arange(own))
        found["base shear"] = np.array([whole.maximum[0], whole.minimum[0]])
        works = {
            f"work in spring {self.scene.springs[s].name}": self.work_on_z(s)
            for s in map(int, self.model.hysteretic)
        }
        for d, dashpot in enumerate(self.scene.dashpots):
            works[f"work in dashpot {'-'.join(dashpot.between)} ({d + 1})"] = self.work_of_dashpot(
                d
            )
        largest = max(map(abs, works.values()), default=0.0)
        # What is small beside the others need not agree beside itself.
        return found | {
            name: np.array([work if abs(work) > 1e-6 * largest else 0.0])
            for name, work in works.items()
        }

    def elongation(self, link: int, values: Floats) -> Floats:
        """Value at the second end of a spring less that at the first, at every row."""
        return _difference(values, *self.model.link_ends[link])

    def hysteretic(self, link: int) -> Floats:
        """The variable z of a spring at every row."""
        return self.z[:, list(self.model.hysteretic).index(link)]

    def z_by_x(self, link: int, z: Floats, direction: Floats) -> Floats:
        """Slope dz/dx (1/m) where x grows, or falls."""
        law = self.model.law
        kappa = law.beta[link] + law.gamma[link] * np.sign(direction * z)
        return np.asarray(
            (1.0 - kappa * np.abs(z) ** law.exponent[link]) / law.yield_displacement[link]
        )

    def spring_force(self, link: int) -> tuple[Floats, Floats]:
        """Force of a link without its dashpot, and its rate (N, N/s)."""
        law = self.model.law
        x, rate = self.elongation(link, self.u), self.elongation(link, self.v)
        force, k = elastic_force(self.model.elastic.one(link), x)
        slope = k * rate
        if link in self.model.hysteretic:
            z = self.hysteretic(link)
            force = force + law.strength[link] * z
            slope = slope + law.strength[link] * self.z_by_x(link, z, np.sign(rate)) * rate
        return force, slope


def between_rows(
    task: Task,
    rerun: Callable[[Task], Recording],
    numbers: Callable[[Between], Mapping[str, Floats]] = Between.sums,
) -> Between:
    """The motion of a task between rows, run again until its numbers have settled.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task.
    numbers : callable
        Those that have to settle, by what a warning calls them.

    Raises
    ------
    ComputationError
        Where a run fails.

    Warns
    -----
    AccuracyWarning
        Where they have not settled with `MOST_ROWS` rows.
    """
    step = _first_step(task)
    task = replace(task, energy=False)
    found: Between | None = None
    last: Mapping[str, Floats] | None = None
    apart: dict[str, float] = {}
    for _ in range(_DOUBLINGS + 1):
        times = _times(task, step)
        if found is not None and times.size > MOST_ROWS:
            break
        run = rerun(replace(task, output_times=times))
        found = with_turns(of_recording(task, run))
        last, before = numbers(found), last
        if before is not None:
            apart = _apart(before, last)
            if not apart:
                return found
        step *= 0.5
    assert found is not None
    warnings.warn(_unsettled(apart), AccuracyWarning, stacklevel=2)
    return found


def _apart(one: Mapping[str, Floats], two: Mapping[str, Floats]) -> dict[str, float]:
    """Numbers that differ by more than `AGREEMENT`, and by which part of their size at most."""
    found = {}
    for name in one:
        size = np.maximum(np.abs(one[name]), np.abs(two[name]))
        off = np.abs(two[name] - one[name])
        if not (off <= AGREEMENT * size).all():
            found[name] = float((off / np.where(size > 0.0, size, 1.0)).max())
    return found


def _unsettled(apart: Mapping[str, float]) -> str:
    """What a warning says: which numbers, by how much, and what helps."""
    if not apart:
        return (
            "what lies between rows (velocities, openings, work) could not be checked by closer "
            f"rows, which would be more than {MOST_ROWS}; a shorter duration helps"
        )
    largest = sorted(apart, key=lambda name: apart[name], reverse=True)
    others = " and others" if len(apart) > _MOST_NAMED else ""
    return (
        f"{', '.join(largest[:_MOST_NAMED])}{others}: known to some {max(apart.values()):.0e} of "
        f"their size, not to {AGREEMENT:g}, as runs with closer rows show; a smaller rtol helps, "
        "with fixed steps a smaller time_step"
    )


def _first_step(task: Task) -> float:
    """Distance of the rows that are tried first (s)."""
    periods = [p for p in local_periods(task.scene).values() if np.isfinite(p)]
    scales = task.scene.motion.scales()
    if scales is not None:
        periods.append(scales.period)
    length = task.end - task.start
    step = min(min(periods, default=length) / ROWS_A_PERIOD, length / FEWEST_ROWS)
    return max(step, length / MOST_ROWS * 4.0)


def _times(task: Task, step: float) -> Floats:
    """Times of the rows: corners of the ground motion, either side of its jumps, steps between."""
    corners, jumps = (np.concatenate(x) for x in zip(*map(_corners, _signals(task)), strict=True))
    jumps = jumps[(jumps > task.start) & (jumps < task.end)]
    inside = corners[(corners > task.start) & (corners < task.end)]
    base = np.unique(np.concatenate([[task.start, task.end], inside]))
    parts = [
        np.linspace(low, high, max(1, int(np.ceil((high - low) / step))), endpoint=False)
        for low, high in pairwise(base)
    ]
    # Both one-sided values at a jump: the row at its time has the one after it.
    before = np.nextafter(jumps, -np.inf)
    return np.unique(np.concatenate([*parts, before, [task.end]]))


def _signals(task: Task) -> list[GroundMotion]:
    """All that moves a scene."""
    scene = task.scene
    return [
        scene.motion,
        *(support.moved_by(scene.motion) for support in scene.supports),
        *(force.history for force in scene.forces),
    ]


def _corners(motion: GroundMotion) -> tuple[Floats, Floats]:
    """Times where a ground motion is not smooth, and where it may jump."""
    corners: list[Floats] = []
    borders: list[float] = []
    for piece in motion.pieces()[:_MOST_PIECES]:
        borders += [x for x in (piece.start, piece.end) if np.isfinite(x)]
        if piece.family is Family.SAMPLES:
            first, dt = piece.coefficients[:2]
            corners.append(first + dt * np.arange(piece.samples.size))
    jumps = np.unique(borders)
    return np.concatenate([jumps, *corners]), jumps


def of_recording(task: Task, recording: Recording) -> Between:
    """Rows as they are, with the moving supports before the bodies."""
    scene, h = task.scene, recording.history
    u, v, a = h.u, h.v, h.a - h.ground[:, None]
    supports = recording.supports
    if supports is not None:
        moving = [i for i, support in enumerate(scene.supports) if support.moves_apart]
        own = [scene.supports[i].moved_by(scene.motion).acceleration(h.t) for i in moving]
        relative = np.reshape([x - h.ground for x in own], (len(own), h.t.size)).T
        u = np.hstack((supports.s[:, moving], u))
        v = np.hstack((supports.sv[:, moving], v))
        a = np.hstack((relative, a))
    return Between(lowered(scene, task.start), h.t, u, v, a, h.z)


def with_turns(rows: Between) -> Between:
    """The same with a row wherever a hysteretic spring turns within a cell."""
    model = rows.model
    cells, parts, owners = [], [], []
    dt = np.diff(rows.t)
    for s, link in enumerate(model.hysteretic):
        rate, slope = rows.elongation(link, rows.v), rows.elongation(link, rows.a)
        turning = np.flatnonzero((dt > 0.0) & (rate[:-1] * rate[1:] < 0.0))
        cells.append(turning)
        parts.append(_root(rate, slope, dt, turning))
        owners.append(np.full(turning.size, s))
    if not cells:
        return rows
    cell, part, owner = np.concatenate(cells), np.concatenate(parts), np.concatenate(owners)
    inside = (part > 0.0) & (part < 1.0)
    cell, part, owner = cell[inside], part[inside], owner[inside]
    u, v, a = _quintic(rows, cell, part)
    z = _carried(rows, cell, part, owner, u)
    t = rows.t[cell] + part * dt[cell]
    order = np.lexsort(
        (np.concatenate([rows.t, t]), np.concatenate([np.arange(rows.t.size), cell]))
    )
    together = [
        np.concatenate([old, new])[order]
        for old, new in ((rows.t, t), (rows.u, u), (rows.v, v), (rows.a, a), (rows.z, z))
    ]
    return Between(rows.scene, *together)


def _carried(rows: Between, cell: Ints, part: Floats, owner: Ints, u: Floats) -> Floats:
    """Every z at new rows: that of the spring that turns by its law along x, others by cubics."""
    model = rows.model
    h = np.diff(rows.t)[cell][:, None]
    rates = np.empty_like(rows.z)
    for s, link in enumerate(model.hysteretic):
        x_rate = rows.elongation(link, rows.v)
        rates[:, s] = rows.z_by_x(link, rows.z[:, s], np.sign(x_rate)) * x_rate
    z = _cubic(rows.z[cell], rates[cell], rows.z[cell + 1], rates[cell + 1], h, part[:, None])
    for s, link in enumerate(model.hysteretic):
        own = owner == s
        dx = _difference(u[own], *model.link_ends[link])
        dx = dx - rows.elongation(link, rows.u)[cell[own]]
        start, direction = rows.z[cell[own], s], np.sign(dx)

        def slope(y: Floats, link: int = int(link), way: Floats = direction) -> Floats:
            return rows.z_by_x(link, y, way)

        k1 = slope(start)
        k2 = slope(start + 0.5 * dx * k1)
        k3 = slope(start + 0.5 * dx * k2)
        k4 = slope(start + dx * k3)
        z[own, s] = start + dx * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    return z


def _side(name: str, between: tuple[str, str]) -> float:
    """Sign of a tension at an end of that name: it pulls the first end to the right."""
    return 1.0 if between[0] == name else -1.0 if between[1] == name else 0.0


def _difference(values: Floats, first: int, second: int) -> Floats:
    """Value at the second end less that at the first; the ground's is zero."""
    zero = np.zeros(values.shape[0])
    return (values[:, second] if second >= 0 else zero) - (values[:, first] if first >= 0 else zero)


def _cubic(p0: Floats, d0: Floats, p1: Floats, d1: Floats, h: Floats, x: Floats) -> Floats:
    """Values of cubics at the part x of cells of length h."""
    y = 1.0 - x
    return y * y * ((1.0 + 2.0 * x) * p0 + x * h * d0) + x * x * ((1.0 + 2.0 * y) * p1 - y * h * d1)


def _root(value: Floats, slope: Floats, dt: Floats, cell: Ints) -> Floats:
    """Where the cubics of some cells, which change sign there, vanish: parts of the cells."""
    p0, p1, d0, d1, h = value[cell], value[cell + 1], slope[cell], slope[cell + 1], dt[cell]
    low, high = np.zeros(cell.size), np.ones(cell.size)
    for _ in range(54):
        middle = 0.5 * (low + high)
        same = (_cubic(p0, d0, p1, d1, h, middle) > 0.0) == (p0 > 0.0)
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return 0.5 * (low + high)


def _quintic(rows: Between, cell: Ints, part: Floats) -> tuple[Floats, Floats, Floats]:
    """Displacements, velocities and accelerations at parts of cells, by their quintics."""
    h, x = np.diff(rows.t)[cell][:, None], part[:, None]
    u0, v0, a0 = rows.u[cell], rows.v[cell], rows.a[cell]
    c3, c4, c5 = (c[cell] for c in quintic_parts(rows.u, rows.v, rows.a, np.diff(rows.t)))
    u = u0 + x * h * v0 + 0.5 * (x * h) ** 2 * a0 + x**3 * (c3 + x * (c4 + x * c5))
    v = v0 + x * h * a0 + x**2 * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)) / h
    a = a0 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5)) / h**2
    return u, v, a


def quintic_parts(u: Floats, v: Floats, a: Floats, h: Floats) -> tuple[Floats, Floats, Floats]:
    """What quintics of values, slopes and second derivatives have beyond their parabolas.

    Parameters
    ----------
    u, v, a : ndarray, shape (n,) or (n, N)
        At rows.
    h : ndarray, shape (n - 1,)
        Lengths of the cells between them.

    Returns
    -------
    tuple of ndarray, shape (n - 1,) or (n - 1, N)
        c_3, c_4, c_5 of ``u_0 + v_0 s + a_0 s^2/2 + c_3 x^3 + c_4 x^4 + c_5 x^5``, x = s/h.
    """
    h = h.reshape(-1, *[1] * (u.ndim - 1))
    du = u[1:] - u[:-1] - h * v[:-1] - 0.5 * h**2 * a[:-1]
    dv, da = h * (v[1:] - v[:-1] - h * a[:-1]), h**2 * (a[1:] - a[:-1])
    return (
        10.0 * du - 4.0 * dv + 0.5 * da,
        -15.0 * du + 7.0 * dv - da,
        6.0 * du - 3.0 * dv + 0.5 * da,
    )


def _turning_points(t: Floats, p: Floats, d: Floats) -> tuple[Floats, Floats]:
    """Times and values of the turning points of cubics within cells."""
    h = np.diff(t)
    inner: Bools = h > 0.0
    h, p0, p1, d0, d1 = h[inner], p[:-1][inner], p[1:][inner], d[:-1][inner], d[1:][inner]
    start = t[:-1][inner]
    # p'(x) h = A x^2 + B x + C on 0 <= x <= 1.
    rise = 3.0 * (p1 - p0)
    a, b, c = 3.0 * h * (d0 + d1) - 2.0 * rise, 2.0 * rise - h * (4.0 * d0 + 2.0 * d1), h * d0
    with np.errstate(all="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
        roots = np.concatenate([q / a, c / q])
    twice = np.tile(np.arange(h.size), 2)
    chosen = (roots > 0.0) & (roots < 1.0)
    x, k = roots[chosen], twice[chosen]
    return start[k] + x * h[k], _cubic(p0[k], d0[k], p1[k], d1[k], h[k], x)
