"""Spring laws and the springs that carry them.

The elongation of a spring is ``x = u_second - u_first``; its force pulls the
ends together where it is positive. The displacement of the ground is zero.
Every number may be given as a string with a unit, ``"1051 kN/m"``.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from enum import StrEnum
from typing import Annotated, ClassVar, Self

import numpy as np

from eventpound.basics.given import (
    Accepted,
    Given,
    Number,
    OptionalNumber,
    above_zero,
    checked,
    converting,
    converting_base,
    default,
    not_negative,
    number,
    read_fields,
)
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.ends import End, GivenEnd, Joining, read_ends
from eventpound.units import STANDARD_GRAVITY, Dimension

GROUND = "ground"
_TINY = sys.float_info.min
_NOT_BELOW = Accepted(
    "a stiffness >= 0 (N/m); P-Delta is weight and height of the spring, or a linear one beside it",
    not_negative,
)
_STIFF = Accepted("a positive stiffness (N/m)", above_zero)
_LONG = Accepted("a positive length (m)", above_zero)
_FROM_ONE = Accepted("a number >= 1", lambda law, n: n >= 1.0)
_BETA = Accepted("a number, beta + gamma > 0", lambda law, b: not b + law.gamma < _TINY)
_SHARE = Accepted("a number above 0, at most 1", lambda soil, r: 0.0 < r <= 1.0)
_GAP = Accepted("a length >= 0 (m)", not_negative)
_WIDER = Accepted("a length of at least gap (m), or 0", lambda s, g: g in (0.0, max(g, s.gap)))
_Stiffness = Annotated[Number, Dimension.STIFFNESS, _NOT_BELOW]
_PULL = Accepted("a positive force (N)", above_zero)
_Force = Annotated[Number, Dimension.FORCE, _PULL]
_PUSH = Accepted(
    "a positive force (N), by which initial_stiffness has a yield displacement",
    lambda soil, f: f > _TINY * max(soil.initial_stiffness, 0.0),
)
_Loss = Annotated[Number, Dimension.NUMBER, Accepted("a number >= 0", not_negative)]
_BEYOND = 0.1
"""Part of its bound by which z may exceed it at the end of a run of the largest tolerance."""
DRAWN = 40
"""Parts of a curve that stands for a law."""


class LawName(StrEnum):
    """What a spring law is called in a case and in results."""

    LINEAR = "linear"
    BILINEAR_ELASTIC = "bilinear-elastic"
    BOUC_WEN = "bouc-wen"
    DEGRADING_BOUC_WEN = "degrading-bouc-wen"
    BACKFILL = "backfill"
    SLIDER = "slider"
    SERIES = "series"

    @property
    def hysteretic(self) -> bool:
        """Whether it has a memory."""
        return self not in (LawName.LINEAR, LawName.BILINEAR_ELASTIC, LawName.SERIES)


@converting
class Linear:
    """``F = k x``.

    Parameters
    ----------
    stiffness : float
        k (N/m). Negative only where all springs of the scene together resist at rest, as the
        couplings of a condensed frame do.

    Examples
    --------
    >>> Linear("12 MN/m").stiffness
    12000000.0
    """

    word: ClassVar[LawName] = LawName.LINEAR
    equation: ClassVar[str] = "F = stiffness x"
    stiffness: Annotated[Number, Dimension.STIFFNESS, Accepted("a stiffness (N/m)")]

    def secant(self, elongation: float) -> float:
        """Resistance over an elongation (N/m)."""
        return self.stiffness


@converting
class BilinearElastic:
    """``F = k_c (x - o)`` for ``x < o`` and ``k_e (x - o)`` above; no hysteresis.

    Parameters
    ----------
    compression, extension : float
        k_c and k_e (N/m), not negative; either may be zero (a stop, a cable).
    offset : float
        o (m), the elongation at which the force vanishes.
    """

    word: ClassVar[LawName] = LawName.BILINEAR_ELASTIC
    equation: ClassVar[str] = (
        "F = compression (x - offset) for x < offset, extension (x - offset) above"
    )
    compression: _Stiffness
    extension: _Stiffness
    offset: Annotated[Number, Dimension.LENGTH, Accepted("a number (m)")] = default(0.0)


@converting
class Series:
    """Linear and bilinear-elastic laws in series through massless nodes.

    The elongations of the parts add up and their forces are equal, which
    makes the whole a piecewise-linear law of the total elongation.

    Parameters
    ----------
    parts : sequence of Linear or BilinearElastic
        At least one; kept as a tuple.
    """

    word: ClassVar[LawName] = LawName.SERIES
    equation: ClassVar[str] = (
        "parts carry one force, their elongations add up; 'condensed' is the whole"
    )
    parts: Given[tuple[Linear | BilinearElastic, ...], Iterable[Linear | BilinearElastic]]


class Hysteretic:
    """A law with a memory, whose internal variable z adds to its force.

    Not every solver knows one that has branches of its own (`has_branches`), or a `second` number,
    whose name that is: it starts with `second_at`.
    """

    __slots__ = ()
    word: ClassVar[LawName]
    equation: ClassVar[str]
    has_branches: ClassVar[bool] = False
    second: ClassVar[str] = ""

    @property
    def beyond_bouc_wen(self) -> bool:
        """Whether it has more to it than z of eq. 3."""
        return self.has_branches or bool(self.second)

    @property
    def second_at(self) -> float:
        """The second number of the memory at the start."""
        raise NotImplementedError

    @property
    def offset(self) -> float:
        """Elongation at which the first branches meet (m)."""
        return 0.0

    @property
    def numbers(self) -> dict[str, float]:
        """What a table of a case shows of it (SI)."""
        raise NotImplementedError

    def z_at(self, elongation: float) -> float:
        """The z of a start at an elongation (m)."""
        raise NotImplementedError

    def tangents(self, elongation: float) -> tuple[float, float]:
        """Stiffness (N/m) as it closes and as it opens from its start at an elongation (m)."""
        raise NotImplementedError

    def going_on(self, elongation: float, state: Mapping[str, float]) -> Self:
        """The same law where a run ended, at an elongation (m), its memory in that state."""
        raise NotImplementedError

    def drawn(self) -> tuple[list[float], list[float]]:
        """Elongations (m) and forces (N) of a loop that shows what it does."""
        raise NotImplementedError

    def z_along(self, x: Floats, z: Floats) -> Floats | None:
        """Give z along elongations x, a row a way from z; None where its rate has to tell."""
        return None


@converting_base()
class BoucWen(Hysteretic):
    """``F = k x + Q z`` with the hysteretic variable z of eq. 3 of the founding paper.

    ``z' = (1/u_y) [x' - gamma |x'| z |z|^(n-1) - beta x' |z|^n]``, so that
    ``|z| <= (beta + gamma)^(-1/n)``.

    Parameters
    ----------
    stiffness : float
        k, the post-yield stiffness (N/m), not negative.
    strength : float
        Q (N), not negative.
    yield_displacement : float
        u_y (m), positive.
    exponent : float
        n >= 1; larger is a sharper knee.
    beta, gamma : float
        Shape of the loop, ``beta + gamma > 0``.
    initial_z : float
        z at the start, within its bound.
    """

    word: ClassVar[LawName] = LawName.BOUC_WEN
    equation: ClassVar[str] = (
        "F = stiffness x + strength z, z' = (x' - gamma |x'| z |z|^(exponent-1)"
        " - beta x' |z|^exponent) / yield_displacement"
    )
    stiffness: _Stiffness
    strength: Annotated[Number, Dimension.FORCE, Accepted("a force >= 0 (N)", not_negative)]
    yield_displacement: Annotated[Number, Dimension.LENGTH, _LONG]
    exponent: Annotated[Number, Dimension.NUMBER, _FROM_ONE] = default(20.0)
    beta: Annotated[Number, Dimension.NUMBER, _BETA] = default(0.5)
    gamma: Annotated[Number, Dimension.NUMBER, Accepted("a number")] = default(0.5)
    initial_z: Annotated[Number, Dimension.NUMBER] = default(0.0)

    @property
    def initial_stiffness(self) -> float:
        """K0 (N/m), that at z = 0."""
        return self.stiffness + self.strength / self.yield_displacement

    def tangents(self, elongation: float) -> tuple[float, float]:
        """Stiffness (N/m) as it closes and as it opens from its start."""
        nu, eta = self.worn
        own = self.strength / (eta * self.yield_displacement)
        spent = nu * abs(self.initial_z) ** self.exponent
        # Where gamma is negative, it may unload downwards; that is no stiffness.
        factors = (1.0 - spent * (self.beta - self.gamma * way) for way in (1.0, -1.0))
        back, on = (max(factor, 0.0) for factor in factors)
        unloads, loads = self.stiffness + own * back, self.stiffness + own * on
        return (unloads, loads) if self.initial_z > 0.0 else (loads, unloads)

    @property
    def worn(self) -> tuple[float, float]:
        """Factors nu and eta of a start, by which it degrades."""
        return 1.0, 1.0

    @property
    def yield_force(self) -> float:
        """F_y (N), where the bilinear backbone has its knee."""
        return self.strength + self.stiffness * self.yield_displacement

    def secant(self, elongation: float) -> float:
        """Resistance over an elongation (N/m) that it is first loaded to; up to yield K0."""
        return self.stiffness + self.bound * self.strength / max(
            elongation, self.bound * self.yield_displacement
        )

    @property
    def yields(self) -> bool:
        """Whether z has a part in the force."""
        return self.strength > 0.0

    def z_at(self, elongation: float) -> float:
        """The z of a start at an elongation (m)."""
        return self.initial_z

    def going_on(self, elongation: float, state: Mapping[str, float]) -> Self:
        """The same law where a run ended, its memory in that state."""
        # What a tolerance leaves beyond the bound is a spring that has yielded.
        z, bound = state["z"], self.bound
        within = min(max(z, -bound), bound)
        return replace(self, initial_z=within if abs(z - within) <= _BEYOND * bound else z)

    @property
    def bound(self) -> float:
        """Largest |z| that loading can reach, (β + γ)^(-1/n)."""
        return float((self.beta + self.gamma) ** (-1.0 / self.exponent))

    @classmethod
    @checked
    def from_yield(
        cls,
        initial_stiffness: float | str,
        yield_force: float | str,
        hardening: float | str = 0.0,
        *,
        exponent: float | str = 20.0,
        beta: float | str = 0.5,
        gamma: float | str = 0.5,
        initial_z: float | str = 0.0,
    ) -> BoucWen:
        """Law of a bilinear backbone: ``k = alpha K0``, ``Q = (1 - alpha) F_y``, ``u_y = F_y/K0``.

        Parameters
        ----------
        initial_stiffness : float
            K0 (N/m), positive.
        yield_force : float
            F_y (N), positive.
        hardening : float
            alpha = k/K0, from 0 to 1.
        exponent, beta, gamma, initial_z : float
            As of the class.

        Raises
        ------
        InputError
            Naming what is out of its range.

        Examples
        --------
        >>> law = BoucWen.from_yield("200 MN/m", "3.6 MN", "5 %")
        >>> round(law.yield_displacement, 6), round(law.stiffness)
        (0.018, 10000000)
        """
        from eventpound.scene.bouc_wen_parameters import OF_LAW, Parameter, bouc_wen_parameters

        given = (
            (Parameter.INITIAL_STIFFNESS, initial_stiffness, Dimension.STIFFNESS),
            (Parameter.YIELD_FORCE, yield_force, Dimension.FORCE),
            (Parameter.HARDENING, hardening, Dimension.NUMBER),
        )
        found = bouc_wen_parameters({p: number(p.value, value, of) for p, value, of in given})
        k, strength, u_y = (found[p] for p in OF_LAW)
        return cls(k, strength, u_y, exponent, beta, gamma, initial_z)


@converting_base()
class DegradingBoucWen(BoucWen):
    """Bouc-Wen's law that loses strength and stiffness with the energy that has gone into it.

    ``z' = [x' - nu (gamma |x'| z |z|^(n-1) + beta x' |z|^n)] / (eta u_y)``, with
    ``nu = 1 + delta_nu epsilon`` and ``eta = 1 + delta_eta epsilon`` (Baber and Wen 1981; Foliente
    1995, without pinching). epsilon is the hysteretic energy over ``Q u_y``, so
    ``epsilon' = z x' / u_y``. Its part ``epsilon e^(-a) - (1 - e^(-a)) / delta_eta`` with
    ``a = delta_eta z^2 / 2`` is lost; elastic motion, ``eta u_y z' = x'``, does not change it.

    Parameters
    ----------
    stiffness, strength, yield_displacement, exponent, beta, gamma, initial_z : float
        As of `BoucWen`, but ``|beta| <= gamma``.
    strength_degradation, stiffness_degradation : float
        delta_nu and delta_eta, not negative.
    initial_loss : float
        Energy lost before the start, over ``Q u_y``.
    """

    word: ClassVar[LawName] = LawName.DEGRADING_BOUC_WEN
    equation: ClassVar[str] = (
        "F = stiffness x + strength z, epsilon' = z x' / yield_displacement,"
        " nu = 1 + strength_degradation epsilon, eta = 1 + stiffness_degradation epsilon,"
        " z' = (x' - nu (gamma |x'| z |z|^(exponent-1) + beta x' |z|^exponent))"
        " / (eta yield_displacement)"
    )
    second: ClassVar[str] = "epsilon"
    strength_degradation: _Loss = default(0.0)
    stiffness_degradation: _Loss = default(0.0)
    initial_loss: _Loss = default(0.0)

    @property
    def second_at(self) -> float:
        """The epsilon of a start: what was lost, and what z holds."""
        a = 0.5 * self.stiffness_degradation * self.initial_z**2
        return self.initial_loss * math.exp(a) + 0.5 * self.initial_z**2 * _mean_growth(a)

    @property
    def worn(self) -> tuple[float, float]:
        """Factors nu and eta of a start."""
        return self.worn_by(self.second_at)

    def worn_by(self, epsilon: float) -> tuple[float, float]:
        """Factors nu and eta at a hysteretic energy in parts of ``Q u_y``."""
        return (
            1.0 + self.strength_degradation * epsilon,
            1.0 + self.stiffness_degradation * epsilon,
        )

    @property
    def numbers(self) -> dict[str, float]:
        """What a table of a case shows of it beside Bouc-Wen's (SI)."""
        found = {"delta_nu": self.strength_degradation, "delta_eta": self.stiffness_degradation}
        return found | {"n": self.exponent}

    def epsilon(self, elongation: float, z: float, epsilon: float) -> float:
        """The hysteretic energy in parts of ``Q u_y``."""
        return epsilon

    def strength_lost(self, elongation: float, z: float, epsilon: float) -> float:
        """Part of its first strength that is gone, 1 - nu^(-1/n)."""
        return -math.expm1(-math.log1p(self.strength_degradation * epsilon) / self.exponent)

    def strength_left(self, elongation: float, z: float, epsilon: float) -> float:
        """The other part, nu^(-1/n)."""
        return 1.0 - self.strength_lost(elongation, z, epsilon)

    def stiffness_lost(self, elongation: float, z: float, epsilon: float) -> float:
        """Part of K0 that is gone at z = 0, where ``k + Q/(eta u_y)`` is left."""
        more = self.stiffness_degradation * epsilon
        own = self.strength / self.yield_displacement / self.initial_stiffness
        return own * more / (1.0 + more)

    def stiffness_left(self, elongation: float, z: float, epsilon: float) -> float:
        """The other part, ``(k + Q/(eta u_y)) / K0``."""
        return 1.0 - self.stiffness_lost(elongation, z, epsilon)

    def dissipated(self, elongation: float, z: float, epsilon: float) -> float:
        """Work that was lost from the start up to here (J)."""
        lost = self.lost(z, epsilon) - self.initial_loss
        return self.strength * self.yield_displacement * lost

    def going_on(self, elongation: float, state: Mapping[str, float]) -> Self:
        """The same law where a run ended, its memory in that state."""
        later = BoucWen.going_on(self, elongation, state)
        lost = self.lost(later.initial_z, state[self.second])
        return replace(later, initial_loss=max(lost, 0.0))

    def lost(self, z: float, epsilon: float) -> float:
        """What of epsilon is lost, in parts of ``Q u_y``."""
        a = 0.5 * self.stiffness_degradation * z**2
        return epsilon * math.exp(-a) - 0.5 * z**2 * _mean_growth(-a)


def _mean_growth(a: float) -> float:
    """``(e^a - 1) / a``."""
    return math.expm1(a) / a if a != 0.0 else 1.0


@converting
class Backfill(Hysteretic):
    """Soil behind an abutment, which resists compression beyond a gap.

    ``F = -y / (1/K0 + R_f y / F_ult)`` at the depth ``y = -(x + gap)`` where it is pushed in for
    the first time (Shamsabadi, Rollins and Kapuskar 2007). It is unloaded and reloaded with K0,
    and does not come back: where the force has gone a wider gap stays.

    Parameters
    ----------
    initial_stiffness : float
        K0 (N/m), positive.
    ultimate_force : float
        F_ult (N), positive.
    failure_ratio : float
        R_f, above 0 and at most 1; far in, the force tends to ``F_ult/R_f``.
    gap : float
        Compression before the soil is touched (m), not negative.
    initial_gap : float
        The same at the start of a run (m), where it was pushed in before; 0 where it was not.
    """

    word: ClassVar[LawName] = LawName.BACKFILL
    equation: ClassVar[str] = (
        "Q = ultimate_force / failure_ratio, u_y = Q / initial_stiffness, F = Q min(z, 0);"
        " z' = (1 + z)^2 x' / u_y where x' < 0 and z = -eta / (1 + eta), eta = -(x + gap) / u_y,"
        " else z' = x' / u_y"
    )
    has_branches: ClassVar[bool] = True
    initial_stiffness: Annotated[Number, Dimension.STIFFNESS, _STIFF]
    ultimate_force: Annotated[Number, Dimension.FORCE, _PUSH]
    failure_ratio: Annotated[Number, Dimension.NUMBER, _SHARE]
    gap: Annotated[Number, Dimension.LENGTH, _GAP] = default(0.0)
    initial_gap: Annotated[Number, Dimension.LENGTH, _WIDER] = default(0.0)

    @classmethod
    @checked
    def of_wall(cls, height: float | str, width: float | str, gap: float | str = 0.0) -> Backfill:
        """Granular soil behind a wall without skew (Caltrans SDC 2.0, 2019, 6.3.1.2).

        Its hyperbola has the code's stiffness as the secant at half of the code's force, and
        reaches that at a depth of 0.05 of the height (Shamsabadi, Rollins and Kapuskar 2007).

        Parameters
        ----------
        height : float
            Of the wall (m), from 0.6096 to 3.048.
        width : float
            Of the wall (m), positive.
        gap : float
            As of the class.

        Raises
        ------
        InputError
            Where a number is none, or out of its range.
        """
        from eventpound.scene.wall import soil_behind

        size = (number(w, v, Dimension.LENGTH) for w, v in (("height", height), ("width", width)))
        return cls(*soil_behind(*size), gap)

    @property
    def strength(self) -> float:
        """Q (N), to which the force tends."""
        return self.ultimate_force / self.failure_ratio

    @property
    def yield_displacement(self) -> float:
        """u_y (m), at which K0 would reach it."""
        return self.strength / self.initial_stiffness

    @property
    def offset(self) -> float:
        """Elongation at which the soil is touched (m)."""
        return -self.gap

    @property
    def touched(self) -> float:
        """Elongation at which it is touched at the start (m)."""
        return -max(self.initial_gap, self.gap)

    def tangents(self, elongation: float) -> tuple[float, float]:
        """Stiffness (N/m) as it closes and as it opens from its start at an elongation (m)."""
        z = self.z_at(elongation)
        if z > 0.0:
            return 0.0, 0.0
        # On the backbone it is pushed in for the first time; short of it, it is reloaded.
        first = z > (elongation - self.touched) / self.yield_displacement
        closing = self.initial_stiffness * ((1.0 + z) ** 2 if first else 1.0)
        return closing, self.initial_stiffness if z < 0.0 else 0.0

    def z_at(self, elongation: float) -> float:
        """The z of a start at an elongation (m), never beyond the backbone."""
        z = (elongation - self.touched) / self.yield_displacement
        depth = self.offset - elongation
        return max(z, -self.push(depth) / self.strength) if depth > 0.0 else z

    def going_on(self, elongation: float, state: Mapping[str, float]) -> Self:
        """The same law where a run ended, at an elongation (m), its memory in that state."""
        return replace(self, initial_gap=max(self.residual_gap(elongation, state["z"]), self.gap))

    @property
    def numbers(self) -> dict[str, float]:
        """What a table of a case shows of it (SI)."""
        found = {"K0": self.initial_stiffness, "F_ult": self.ultimate_force}
        found |= {"R_f": self.failure_ratio, "gap": self.gap}
        return found | ({"y_ult": self.ultimate_depth} if self.failure_ratio < 1.0 else {})

    @property
    def ultimate_depth(self) -> float:
        """Depth at which the ultimate force is reached (m), infinite where R_f is 1."""
        rest = 1.0 - self.failure_ratio
        return self.ultimate_force / self.initial_stiffness / rest if rest else math.inf

    def drawn(self) -> tuple[list[float], list[float]]:
        """Elongations (m) and forces (N) from rest into the soil and back."""
        end = min(self.ultimate_depth, 10.0 * self.yield_displacement)
        depths = [end * k / DRAWN for k in range(DRAWN + 1)]
        force = [-self.push(y) for y in depths]
        freed = self.offset - end - force[-1] / self.initial_stiffness
        x = [0.0, *(self.offset - y for y in depths), freed, 0.0]
        return x, [0.0, *force, 0.0, 0.0]

    def z_along(self, x: Floats, z: Floats) -> Floats:
        """Give z along elongations x, a row a way from z: the gap widens on the backbone."""
        u_y, depth = self.yield_displacement, np.maximum(self.offset - x, 0.0)
        left = np.maximum(-u_y * depth / (u_y + depth) - x, (u_y * z - x[:, 0])[:, None])
        return np.asarray((x + np.maximum.accumulate(left, axis=1)) / u_y)

    def push(self, depth: float) -> float:
        """Force at a depth (m) to which it is pushed for the first time (N)."""
        return depth / (1.0 / self.initial_stiffness + depth / self.strength)

    def residual_gap(self, elongation: float, z: float) -> float:
        """Compression before the soil is touched again (m)."""
        return self.yield_displacement * z - elongation

    def dissipated(self, elongation: float, z: float) -> float:
        """Work lost since the start (J)."""
        return self._lost(self.residual_gap(elongation, z)) - self._lost(self.initial_gap)

    def _lost(self, gap: float) -> float:
        """Work that left a gap (m), ``∫ F dp`` along the backbone in its plastic depth (J)."""
        zeta = max((gap - self.gap) / self.yield_displacement, 0.0)
        t = 1.0 + 0.5 * (zeta + math.sqrt(zeta * (zeta + 4.0)))
        lost = t - math.log(t) + 1.0 / t - 0.5 / t**2 - 1.5
        return self.strength * self.yield_displacement * lost


@converting
class Slider(Hysteretic):
    """Coulomb friction under a constant normal force, perhaps with a spring beside it.

    ``F = stiffness x + friction normal_force z``. While it slips z is the sign of x'; while it
    sticks x stands still and z is what holds it, ``|z| <= 1``.

    Parameters
    ----------
    friction : float
        Coefficient of friction, positive.
    normal_force : float
        N (N), positive.
    stiffness : float
        Of the spring beside it (N/m), not negative.
    """

    word: ClassVar[LawName] = LawName.SLIDER
    equation: ClassVar[str] = (
        "F = stiffness x + friction normal_force z, z = sign x' where it slips, |z| <= 1 where it"
        " sticks"
    )
    has_branches: ClassVar[bool] = True
    friction: Annotated[Number, Dimension.NUMBER, Accepted("a positive number", above_zero)]
    normal_force: _Force
    stiffness: _Stiffness = default(0.0)

    @classmethod
    @checked
    def pendulum(
        cls, friction: float | str, normal_force: float | str, radius: float | str
    ) -> Slider:
        """Friction pendulum, whose stiffness is normal_force / radius.

        Parameters
        ----------
        friction, normal_force : float
            As of the class.
        radius : float
            Of its concave surface (m), positive.

        Raises
        ------
        InputError
            Where a number is none, or the radius is zero.
        """
        force = number("normal_force", normal_force, Dimension.FORCE)
        length = number("radius", radius, Dimension.LENGTH)
        if not length > 0.0:
            raise InputError(f"radius: found {radius!r}; accepted: a positive length (m)")
        return cls(friction, force, force / length)

    @property
    def strength(self) -> float:
        """Friction force of a slip (N)."""
        return self.friction * self.normal_force

    @property
    def numbers(self) -> dict[str, float]:
        """What a table of a case shows of it (SI)."""
        found = {"K_s": self.stiffness, "Q": self.strength}
        found |= {"friction": self.friction, "N": self.normal_force}
        if self.stiffness > 0.0:
            length = self.normal_force / self.stiffness
            found["T_slip"] = 2.0 * math.pi * math.sqrt(length / STANDARD_GRAVITY)
        return found

    def tangents(self, elongation: float) -> tuple[float, float]:
        """Stiffness (N/m) beside its friction: what sticks has none, what slips has this one."""
        return self.stiffness, self.stiffness

    def z_at(self, elongation: float) -> float:
        """The z of a start: its sign is on the branches of the law."""
        return 1.0

    def going_on(self, elongation: float, state: Mapping[str, float]) -> Self:
        """The same law: forces tell whether a slider sticks."""
        return self

    def drawn(self) -> tuple[list[float], list[float]]:
        """Elongations (m) and forces (N) of a slip there and back."""
        x = self.strength / self.stiffness if self.stiffness > 0.0 else 1.0
        corners = ((0.0, 0.0), (0.0, 1.0), (x, 1.0), (x, -1.0), (-x, -1.0), (-x, 1.0), (0.0, 1.0))
        force = [self.stiffness * at + self.strength * z for at, z in corners]
        return [at for at, _ in corners], force


Law = Linear | BilinearElastic | Series | BoucWen | DegradingBoucWen | Backfill | Slider
"""What a spring may have."""


def law_keys(law: Law) -> dict[str, object]:
    """A law by the keys of a case file (SI)."""
    if isinstance(law, Series):
        return {"law": law.word.value, "parts": [law_keys(part) for part in law.parts]}
    return {"law": law.word.value} | asdict(law)


def storey_keys(spring: Spring) -> dict[str, object]:
    """What a spring is beside its law, by the keys of a case file (SI)."""
    given = {"height": spring.height, "weight": spring.weight, "frame": spring.frame}
    return {key: value for key, value in given.items() if value is not None}


@converting
class Spring(Joining):
    """A law between two bodies, points between bodies, or one and the ground.

    Parameters
    ----------
    name : str
        Unique among the springs of the scene.
    between : tuple of str or Point
        Names of the first and the second end; one may be ``"ground"``. Or points between bodies;
        a mapping of names to weights, ``{"B2": 0.4, "B3": 0.6}``, is one.
    law : Law
        Force as a function of the elongation (and, for Bouc-Wen, its history).
    height : float, optional
        Of the storey that it is (m): its drift ratio is elongation over height.
    weight : float, optional
        P, that its columns carry (N): with it and the height h the spring pulls with
        ``F - (P/h) x`` (P-Delta; linear and Bouc-Wen springs).
    frame : str, optional
        Name of the frame that it is a coupling of (`eventpound.frame`): it counts as any other
        spring, but tables and histories leave it out.

    Examples
    --------
    >>> piers = Spring("piers", ("ground", "deck"), Linear("12 MN/m"))
    >>> piers.between
    ('ground', 'deck')
    """

    name: str
    between: Given[tuple[End, End], Sequence[GivenEnd]]
    law: Law
    height: Annotated[OptionalNumber, Dimension.LENGTH, _LONG] = default(None)
    weight: Annotated[OptionalNumber, Dimension.FORCE, _PULL] = default(None)
    frame: str | None = None

    def __post_init__(self) -> None:
        read_ends(self, "between")
        read_fields(self)

    @property
    def sides(self) -> tuple[End, End]:
        """Its first and its second end."""
        return self.between

    @property
    def geometric_stiffness(self) -> float:
        """P/h (N/m), by which P-Delta softens it; 0 without a weight."""
        return 0.0 if self.weight is None else self.weight / (self.height or math.nan)

    @property
    def acting(self) -> Law:
        """The law of its force: its own, softened by P-Delta."""
        law = self.law
        if self.weight is None or not isinstance(law, Linear | BoucWen):
            return law
        return replace(law, stiffness=law.stiffness - self.geometric_stiffness)
