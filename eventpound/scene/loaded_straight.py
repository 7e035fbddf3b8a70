"""Bouc-Wen springs loaded straight from their initial state, in closed form.

While an elongation grows one way, ``y = ±z / b``, b the bound of z, follows ``y' = 1 - κ |y|^n``
over the travel in parts of ``u_y b``: κ is 1 for y > 0, and ``(β - γ) / (β + γ)`` before. Its
inverse is ``y ₂F₁(1, 1/n; 1 + 1/n; κ y^n)``, which Newton's method solves for y: the function is
convex or concave, and the start on that side of the root from where every step stays there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import hyp2f1

from eventpound.numerics.arrays import Floats
from eventpound.scene.spring import BoucWen, Hysteretic

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

    def pull(self, travel: Floats) -> tuple[Floats, Floats]:
        """What each pulls with beside its elastic part (N), and the slope (N/m), as of `loaded`."""
        z, slope = self.loaded(travel)
        return self.strength * z, self.strength * slope

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


def not_convex(law: Hysteretic) -> tuple[str, str] | None:
    """Why a law loaded straight has no convex potential known, and what has; None where it has."""
    if not isinstance(law, BoucWen) or law.beyond_bouc_wen:
        return f"is {law.word.value}", '"initial", or springs of another law'
    if law.gamma >= 0.0:
        return None
    return f"unloads with a negative stiffness (gamma = {law.gamma!r})", "gamma >= 0"


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
