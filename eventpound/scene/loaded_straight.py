"""Bouc-Wen springs and backfill loaded straight from their initial state, in closed form.

While the elongation of a Bouc-Wen spring grows one way, ``y = ±z / b``, b the bound of z, follows
``y' = 1 - κ |y|^n`` over the travel in parts of ``u_y b``: κ is 1 for y > 0, and
``(β - γ) / (β + γ)`` before. Its inverse is ``y ₂F₁(1, 1/n; 1 + 1/n; κ y^n)``, which Newton's
method solves for y: the function is convex or concave, and the start on that side of the root from
where every step stays there. One that degrades is integrated. Backfill is on its backbone or on the
line of unloading above it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import hyp2f1

from eventpound.numerics.arrays import Floats
from eventpound.scene.spring import Backfill, BoucWen, DegradingBoucWen

ALL_BUT = 1e-12
"""Distance of y from 1 below which it falls exponentially, to rounding."""
MOST_STEPS = 100
"""Of Newton's method; some 40 where y is all but 1, else 5."""


class Loops(NamedTuple):
    """Laws as arrays, an entry each: strength (N), u_y (m), n, b, κ before zero, initial z."""

    strength: Floats
    yield_displacement: Floats
    exponent: Floats
    bound: Floats
    before: Floats
    initial_z: Floats

    @classmethod
    def of(cls, laws: Sequence[BoucWen]) -> Loops:
        """Those of some laws."""
        columns = [
            (
                law.strength,
                law.yield_displacement,
                law.exponent,
                law.bound,
                (law.beta - law.gamma) / (law.beta + law.gamma),
                law.initial_z,
            )
            for law in laws
        ]
        return cls(*np.array(columns, float).reshape(-1, 6).T)

    @property
    def steepest(self) -> Floats:
        """The largest stiffness that each adds (N/m)."""
        return self.strength * ((1.0 + np.maximum(-self.before, 0.0)) / self.yield_displacement)

    @property
    def largest(self) -> Floats:
        """The largest force of each (N)."""
        return self.strength * self.bound

    @property
    def knee(self) -> Floats:
        """Elongations at which they yield (m)."""
        return self.yield_displacement

    def loaded(self, travel: Floats) -> tuple[Floats, Floats]:
        """The z of each after an elongation by `travel` (m) one way, and its slope (1/m).

        Both of the shape of `travel`, (number of laws,).
        """
        n, b = self.exponent, self.bound
        way = np.where(travel < 0.0, -1.0, 1.0)
        y_0 = np.clip(way * self.initial_z / b, -1.0, 1.0)
        xi = np.abs(travel) / (self.yield_displacement * b)
        # The travel on which a loop that pulls the other way comes to zero.
        back = _travel(np.maximum(-y_0, 0.0), n, self.before)
        turned = xi < back
        kappa = np.where(turned, self.before, 1.0)
        ahead = _travel(np.maximum(y_0, 0.0), n, np.ones_like(n)) + np.maximum(xi - back, 0.0)
        y = _value(np.where(turned, back - xi, ahead), n, kappa)
        z = np.where(xi == 0.0, self.initial_z, way * b * np.where(turned, -y, y))
        return z, np.maximum(1.0 - kappa * y**n, 0.0) / self.yield_displacement


class Worn:
    """A degrading law loaded straight one way from its initial state, integrated as far as asked.

    Beyond its largest force (`last`, in parts of u_y) it has no convex potential, and keeps that.
    """

    def __init__(self, law: DegradingBoucWen, way: float) -> None:
        self._law, self._way = law, way
        self._end, begin = 0.0, np.array([law.initial_z, law.second_at])
        self._curve: Callable[[float], Floats] = lambda t: begin
        self.last = np.inf

    def at(self, travel: float) -> tuple[float, float, float]:
        """The z after an elongation by `travel` (m), its slope (1/m), and epsilon."""
        law, t = self._law, abs(travel) / self._law.yield_displacement
        if t > self._end and self.last == np.inf:
            self._integrate(2.0 * t)
        z, epsilon = self._curve(min(t, self.last))
        slope = self._growth(z, epsilon) / law.yield_displacement
        if t > self.last:
            slope = -law.stiffness / law.strength
            z += slope * self._way * (t - self.last) * law.yield_displacement
        return float(z), float(slope), float(epsilon)

    def _growth(self, z: float, epsilon: float) -> float:
        """Rate of z over the travel in parts of u_y."""
        law = self._law
        nu, eta = law.worn_by(epsilon)
        bend = law.beta + law.gamma * np.sign(z * self._way)
        return float((1.0 - nu * np.abs(z) ** law.exponent * bend) / eta)

    def _integrate(self, end: float) -> None:
        law, way = self._law, self._way

        def rate(t: float, y: Floats) -> tuple[float, float]:
            return way * self._growth(*y), way * y[0]

        def hardening(t: float, y: Floats) -> float:
            return law.stiffness * law.yield_displacement + law.strength * self._growth(*y)

        hardening.terminal, hardening.direction = True, -1.0  # type: ignore[attr-defined]
        begin = [law.initial_z, law.second_at]
        tolerance = {"rtol": 1e-12, "atol": 1e-14, "dense_output": True}
        done = solve_ivp(rate, (0.0, end), begin, "DOP853", events=hardening, **tolerance)
        self._end, self._curve = end, done.sol
        self.last = float(done.t_events[0][0]) if done.t_events[0].size else np.inf


class Soils(NamedTuple):
    """Backfill as arrays: K0 (N/m), Q (N), where it is virgin and where it is touched (m)."""

    stiffness: Floats
    strength: Floats
    virgin: Floats
    touched: Floats

    @classmethod
    def of(cls, laws: Sequence[Backfill], x_0: Floats) -> Soils:
        """Those of some laws, loaded straight from elongations (m)."""
        # On the backbone it was pushed in up to here, and is unloaded from there.
        pairs = zip(laws, x_0.tolist(), strict=True)
        touched = [x - law.yield_displacement * law.z_at(x) for law, x in pairs]
        columns = [
            (law.initial_stiffness, law.strength, law.offset, at)
            for law, at in zip(laws, touched, strict=True)
        ]
        return cls(*np.array(columns, float).reshape(-1, 4).T)

    def loaded(self, x: Floats) -> Floats:
        """The z of each at elongations (m)."""
        u_y = self.strength / self.stiffness
        depth = np.maximum(self.virgin - x, 0.0)
        return np.where(
            depth > 0.0,
            np.maximum((x - self.touched) / u_y, -depth / (u_y + depth)),
            (x - self.touched) / u_y,
        )

    def pull(self, x: Floats) -> tuple[Floats, Floats]:
        """What each pulls with at elongations (m), in N, and the slope (N/m)."""
        z = self.loaded(x)
        first = z > (x - self.touched) * self.stiffness / self.strength
        slope = np.where(first, (1.0 + z) ** 2, 1.0)
        return self.strength * np.minimum(z, 0.0), self.stiffness * np.where(z < 0.0, slope, 0.0)


def _last(kappa: Floats) -> Floats:
    """The largest y that the closed form is taken at."""
    return np.where(kappa == 1.0, 1.0 - ALL_BUT, 1.0)


def _travel(y: Floats, n: Floats, kappa: Floats) -> Floats:
    """Travel from 0 to y, for 0 <= y <= 1."""
    near = np.minimum(y, _last(kappa))
    with np.errstate(divide="ignore"):
        beyond = np.where(y > near, np.log(ALL_BUT) - np.log1p(-y), 0.0)
    return np.asarray(near * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, kappa * near**n) + beyond / n)


def _value(xi: Floats, n: Floats, kappa: Floats) -> Floats:
    """The y at a travel from 0: the inverse of `_travel`."""
    highest = _last(kappa)
    last = _travel(highest, n, kappa)
    y = np.minimum(xi, highest)
    for _ in range(MOST_STEPS):
        step = (np.minimum(xi, last) - _travel(y, n, kappa)) * (1.0 - kappa * y**n)
        following = np.clip(y + step, 0.0, highest)
        if (np.abs(following - y) <= 4.0 * np.finfo(float).eps * y).all():
            break
        y = following
    left = ALL_BUT * np.exp(-n * np.maximum(xi - last, 0.0))
    return np.where((kappa == 1.0) & (xi > last), 1.0 - left, following)
