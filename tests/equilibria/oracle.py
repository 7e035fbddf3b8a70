"""Whether a scene stands where it should: an independent program, by what an equilibrium is.

Nothing of `eventpound.scene.statics` or `eventpound.mechanics` is used. Laws are written down
anew, hysteresis is integrated. The potential is convex, so that balanced forces *prove* an
equilibrium, and a direction in which it falls without end that there is none:

* no gap is negative, and forces of shut contacts that only push, and of sliders that stick,
  balance the rest (bounded least squares);
* nowhere else nearer to the given place is one (NNLS for the conditions of that projection);
* where it is refused, a linear program finds the body that nothing holds, or no room.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import linprog, lsq_linear, nnls

from eventpound.scene import (
    Backfill,
    BilinearElastic,
    BoucWen,
    DegradingBoucWen,
    Linear,
    Scene,
    Series,
    Slider,
    Spring,
)

SHUT = 1e-13
"""Part of the lengths below which a gap is shut."""
SLACK = 1e-9
"""Part of the largest force below which a cable or stop is slack."""
DIFFERENCE = 1e-5
"""Part of the largest stiffness times length that a force is at the least compared with."""


@dataclass(frozen=True)
class Linkage:
    """Rows of springs and contacts, and where they are at u = 0."""

    B: np.ndarray
    x: np.ndarray
    W: np.ndarray
    gap: np.ndarray
    load: np.ndarray


def linkage(scene: Scene) -> Linkage:
    """Geometry and loads of a scene at t = 0."""
    names = [body.name for body in scene.bodies]
    supports = {s.name: s.motion for s in scene.supports}
    load = np.zeros(len(names))
    for force in scene.forces:
        load[names.index(force.body)] += float(force.history.acceleration(np.array(0.0)))

    def row(ends: list[tuple[str, float]]) -> tuple[np.ndarray, float]:
        u, fixed = np.zeros(len(names)), 0.0
        for end, weight in ends:
            if end in names:
                u[names.index(end)] += weight
            elif end in supports:
                fixed += weight * float(supports[end].displacement(np.array(0.0)))
        return u, fixed

    springs = [row([(s.between[0], -1.0), (s.between[1], 1.0)]) for s in scene.springs]
    contacts = []
    for c in scene.contacts:
        ends = []
        for end, sign in ((c.left, -1.0), (c.right, 1.0)):
            weights = [(end, 1.0)] if isinstance(end, str) else list(end.weights)
            ends += [(name, sign * weight) for name, weight in weights]
        contacts.append(row(ends))
    n = len(names)
    return Linkage(
        np.array([r for r, _ in springs]).reshape(-1, n),
        np.array([x for _, x in springs]),
        np.array([r for r, _ in contacts]).reshape(-1, n),
        np.array([x for _, x in contacts]) + np.array([c.gap for c in scene.contacts]),
        load,
    )


def sides(law: Linear | BilinearElastic | Series) -> tuple[float, float, float]:
    """Stiffness in compression and in extension, and the elongation between."""
    if isinstance(law, Linear):
        return law.stiffness, law.stiffness, 0.0
    if isinstance(law, BilinearElastic):
        return law.compression, law.extension, law.offset
    parts = [sides(part) for part in law.parts]
    below, above, offsets = zip(*parts, strict=True)
    soft = [0.0 if min(k) == 0.0 else 1.0 / sum(1.0 / each for each in k) for k in (below, above)]
    return soft[0], soft[1], sum(offsets)


def hysteresis(law: BoucWen, travel: float) -> float:
    """The z after a travel one way, integrated."""
    way, bound = np.sign(travel), (law.beta + law.gamma) ** (-1.0 / law.exponent)

    def rate(_: float, z: np.ndarray) -> np.ndarray:
        pull = law.gamma * np.sign(z * way) + law.beta
        return way * (1.0 - pull * np.abs(z) ** law.exponent)

    # Yielded for good after some ten times the travel that it takes.
    end = min(abs(travel) / law.yield_displacement, 60.0 * max(bound, 1.0))
    if end == 0.0:
        return law.initial_z
    done = solve_ivp(
        rate, (0.0, end), [law.initial_z], "DOP853", rtol=1e-13, atol=1e-15, max_step=0.05
    )
    return float(np.clip(done.y[0, -1], -bound, bound))


def degraded(law: DegradingBoucWen, travel: float) -> tuple[float, float]:
    """The z and epsilon after a travel one way, integrated by Radau's method."""
    way, u_y = np.sign(travel), law.yield_displacement

    def rate(_: float, y: np.ndarray) -> tuple[float, float]:
        z, epsilon = y
        nu = 1.0 + law.strength_degradation * epsilon
        pull = nu * (law.gamma * abs(z) ** (law.exponent - 1.0) * z * way)
        pull += nu * law.beta * abs(z) ** law.exponent
        return way * (1.0 - pull) / (1.0 + law.stiffness_degradation * epsilon), way * z

    begin = (law.initial_z, law.second_at)
    if travel == 0.0:
        return begin
    done = solve_ivp(rate, (0.0, abs(travel) / u_y), begin, "Radau", rtol=1e-10, atol=1e-13)
    return float(done.y[0, -1]), float(done.y[1, -1])


def soil(law: Backfill, x_0: float, x: float) -> float:
    """Force after one way from x_0 to x: reloaded by a line, never above the hyperbola."""

    def hyperbola(at: float) -> float:
        y = max(-(at + law.gap), 0.0)
        return y / (1.0 / law.initial_stiffness + law.failure_ratio * y / law.ultimate_force)

    left = max(law.gap, law.initial_gap)
    first = min(law.initial_stiffness * max(-(x_0 + left), 0.0), hyperbola(x_0))
    open_by = max(x_0 + left, 0.0) if first == 0.0 else 0.0
    line = first + law.initial_stiffness * (x_0 - x - open_by)
    return -max(min(line, hyperbola(x)), 0.0)


def far(spring: Spring) -> tuple[float, float]:
    """Forces far in compression (its size) and far in extension."""
    law = spring.law
    if isinstance(law, Backfill):
        return law.ultimate_force / law.failure_ratio, 0.0
    if isinstance(law, Slider):
        most = law.friction * law.normal_force
        return (np.inf, np.inf) if law.stiffness > 0.0 else (most, most)
    if isinstance(law, BoucWen):
        most = law.strength * (law.beta + law.gamma) ** (-1.0 / law.exponent)
        return (np.inf, np.inf) if law.stiffness > 0.0 else (most, most)
    k = sides(law)
    return (np.inf if k[0] > 0.0 else 0.0), (np.inf if k[1] > 0.0 else 0.0)


@dataclass(frozen=True)
class Verdict:
    """How far a placed scene is from what it should be, in parts of the largest force and length.

    unbalanced: forces; open: the deepest overlap; farther: what is left of the conditions of the
    nearest equilibrium.
    """

    unbalanced: float
    overlap: float
    farther: float


def judge(scene: Scene, placed: Scene) -> Verdict:
    """Compare a scene with the same in equilibrium."""
    k = linkage(scene)
    u_0 = np.array([body.displacement for body in scene.bodies])
    u = np.array([body.displacement for body in placed.bodies])
    x, g = k.x + k.B @ u, k.gap + k.W @ u
    force, stiff = np.zeros(x.size), np.zeros(x.size)
    bounded: list[np.ndarray] = []
    fixed: list[np.ndarray] = []
    stuck: list[tuple[np.ndarray, float]] = []
    lengths = [np.abs(v).max(initial=0.0) for v in (u, u_0, x, k.gap)]
    for i, (spring, other) in enumerate(zip(scene.springs, placed.springs, strict=True)):
        law, x_0 = spring.law, float((k.x + k.B @ u_0)[i])
        if isinstance(law, Slider):
            force[i], friction = law.stiffness * x[i], law.friction * law.normal_force
            stiff[i] = law.stiffness
            if abs(x[i] - x_0) > SHUT * np.abs(np.concatenate((u, u_0, x))).max():
                force[i] += np.sign(x[i] - x_0) * friction
            else:
                stuck.append((-k.B[i], friction))
        elif isinstance(law, Backfill):
            force[i], stiff[i] = soil(law, x_0, float(x[i])), law.initial_stiffness
            lengths.append(law.ultimate_force / law.initial_stiffness)
        elif isinstance(law, DegradingBoucWen):
            z, epsilon = degraded(law, x[i] - x_0)
            assert isinstance(other.law, DegradingBoucWen)
            assert abs(other.law.initial_z - z) <= 1e-8, (spring.name, other.law.initial_z, z)
            assert abs(other.law.second_at / (epsilon or 1.0) - 1.0) <= 1e-7 or epsilon < 1e-12
            force[i] = law.stiffness * x[i] + law.strength * other.law.initial_z
            stiff[i] = law.stiffness + law.strength / law.yield_displacement
            lengths.append(law.yield_displacement)
        elif isinstance(law, BoucWen):
            z = hysteresis(law, x[i] - (k.x + k.B @ u_0)[i])
            assert isinstance(other.law, BoucWen)
            assert abs(other.law.initial_z - z) <= 1e-9, (spring.name, other.law.initial_z, z)
            force[i] = law.stiffness * x[i] + law.strength * z
            stiff[i] = law.stiffness + law.strength / law.yield_displacement
            lengths.append(law.yield_displacement)
        else:
            below, above, at = sides(law)
            force[i] = (below if x[i] < at else above) * (x[i] - at)
            stiff[i] = max(below, above)
            lengths.append(abs(at))
    length = max(lengths)
    shut = np.abs(g) <= SHUT * length
    wanted = k.B.T @ force - k.load
    pushing = np.zeros(shut.sum())
    holding, rows = np.zeros(len(stuck)), np.array([r for r, _ in stuck]).reshape(-1, u.size)
    if stuck:
        most = np.array([friction for _, friction in stuck])
        all_of = np.vstack((k.W[shut], rows))
        low, high = np.append(0.0 * pushing, -most), np.append(pushing + np.inf, most)
        found = lsq_linear(all_of.T, wanted, (low, high), tol=1e-14).x
        pushing, holding = found[: pushing.size], found[pushing.size :]
    elif shut.any():
        pushing = nnls(k.W[shut].T, wanted)[0]
    residual = k.W[shut].T @ pushing + rows.T @ holding - wanted
    largest = max(np.abs(v).max(initial=0.0) for v in (force, k.load, pushing, holding))
    for (row, friction), held in zip(stuck, holding, strict=True):
        if friction - abs(held) > 1e-9 * largest:
            fixed.append(row)
        else:
            bounded.append(-np.sign(held) * row)
    for i, spring in enumerate(scene.springs):
        law = spring.law
        if isinstance(law, Slider):
            fixed += [k.B[i]] if law.stiffness > 0.0 else []
            continue
        below, above, at = (1.0, 1.0, 0.0)
        if isinstance(law, Backfill):
            placed_law = placed.springs[i].law
            assert isinstance(placed_law, Backfill)
            below, above, at = 1.0, 0.0, -max(placed_law.gap, placed_law.initial_gap)
        elif not isinstance(law, BoucWen):
            below, above, at = sides(law)
        if min(below, above) > 0.0 or abs(force[i]) > SLACK * largest:
            fixed.append(k.B[i])
        elif max(below, above) > 0.0 and abs(x[i] - at) <= 1e-12 * length:
            bounded.append(k.B[i] if below > 0.0 else -k.B[i])
    pressed = np.zeros(g.size, bool)
    pressed[np.flatnonzero(shut)] = pushing > 1e-9 * largest
    fixed += list(k.W[pressed])
    bounded += list(k.W[shut & ~pressed])
    columns = np.array([*fixed, *(-row for row in fixed), *bounded]).reshape(-1, u.size).T
    away = u - u_0
    farther = float(np.abs(away).max())
    if columns.shape[1]:
        farther = float(np.abs(columns @ nnls(columns, away)[0] - away).max())
    # Forces are differences of what the lengths of a scene would make, where they are small.
    largest += DIFFERENCE * stiff.max(initial=0.0) * length
    return Verdict(
        float(np.abs(residual).max() / max(largest, 1e-300)),
        float(max(-g.min(initial=0.0), 0.0) / max(length, 1e-300)),
        farther / max(length, 1e-300),
    )


def loose(scene: Scene) -> np.ndarray | None:
    """A motion (N,) along which forces do work without end; None where there is none."""
    k = linkage(scene)
    n, s = k.load.size, len(scene.springs)
    ends = np.array([far(spring) for spring in scene.springs]).reshape(s, 2)
    size = max(np.abs(k.load).max(), ends[np.isfinite(ends)].max(initial=0.0)) or 1.0
    # d, then how far each spring extends and how far it is compressed.
    finite = np.where(np.isfinite(ends.T), ends.T, 0.0)[::-1]
    cost = np.concatenate((-k.load, finite.ravel())) / size
    limits = [(-1.0, 1.0)] * n
    limits += [(0.0, None if np.isfinite(f) else 0.0) for f in (*ends[:, 1], *ends[:, 0])]
    equal = np.hstack((k.B, -np.eye(s), np.eye(s)))
    done = linprog(
        cost,
        -np.hstack((k.W, np.zeros((k.W.shape[0], 2 * s)))) if k.W.size else None,
        np.zeros(k.W.shape[0]) if k.W.size else None,
        equal if s else None,
        np.zeros(s) if s else None,
        limits,
    )
    assert done.status == 0, done.message
    return done.x[:n] if done.fun < -1e-7 else None


def room(scene: Scene) -> bool:
    """Whether there is a place where no contact overlaps by more than rounding."""
    k = linkage(scene)
    n, m = k.load.size, k.gap.size
    if m == 0:
        return True
    size = np.abs(k.gap).max() or 1.0
    done = linprog(
        np.append(np.zeros(n), -1.0),
        np.hstack((-k.W, np.ones((m, 1)))),
        k.gap / size,
        bounds=[(None, None)] * n + [(None, 0.0)],
    )
    assert done.status == 0, done.message
    return bool(done.x[-1] >= -1e-9)
