"""Where springs, sliders and contacts that only push hold forces: the least of a convex potential.

    Σ_s B_sᵀ F_s(B_s u) = p + Wᵀ λ,   0 <= g + W u ⊥ λ >= 0

A slider is such a row, too: g + W u is its slip, -Q <= λ <= Q, and λ = Q or -Q against a slip.

A proximal method of multipliers (R. T. Rockafellar, Math. Oper. Res. 1, 1976) turns it into
problems without constraints, in which each contact is a spring that pushes and a small stiffness
draws each body to where it was: redundant contacts, rows without room and bodies that nothing
holds make none of them singular. Newton's method with a line search solves these. All stiffnesses
of the method are parts of those of the springs at a body, so that nothing depends on units, and a
soft body beside a stiff one is no rounding of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import brentq, lsq_linear, nnls

from eventpound.numerics.arrays import Bools, Floats
from eventpound.tolerances import INSIDE

PUSHING, HARDEST = 1e3, 1e11
"""Stiffness of a contact at first and at most, in parts of that of its bodies."""
DRAWING = 10.0 ** -np.arange(2.0, 12.0)
"""Stiffness of each body to where it was, in parts of its own, from one multiplier step to the
next; the last is kept. Each step leaves of the error what this is of the softest motion."""
MOST_MULTIPLIER_STEPS, MOST_NEWTON_STEPS = 60, 400
SOLVED = 1e-3
"""Part of a multiplier step by which Newton's method may miss it."""
CLOSE = 1e-9
"""Part of the lengths below which steps that no longer halve are rounding."""
CERTAIN = 1e-9
"""Part of the largest below which what should vanish does so: rounding is far less, and what
makes a difference far more."""
SLOW = 0.1
"""Part of its gap, from one multiplier step to the next, to which a contact should close."""
ROUNDING = float(np.finfo(float).eps)
SHUT = 1e-12
"""Part of the lengths within which a gap is zero."""


@dataclass(frozen=True)
class Potential:
    """N bodies on S springs, with K contacts and sliders.

    Parameters
    ----------
    springs, contacts : ndarray, shape (S, N), (K, N)
        B and W: what displacements make of elongations and of gaps.
    moved, gap : ndarray, shape (S,), (K,)
        Elongations and gaps at u = 0 (m).
    load : ndarray, shape (N,)
        p (N).
    law : callable
        Forces (N) and slopes (N/m) of the springs at their elongations, all of shape (S,).
    stiffness : ndarray, shape (S,)
        The largest of each spring (N/m).
    far, slack : ndarray, shape (2, S)
        Forces far in compression and far in extension (N), perhaps infinite; elongations between
        which there is none (m).
    length : float
        The largest of the lengths given (m).
    least, most : ndarray, shape (K,)
        Between which its force is (N): 0 and infinity of a contact, -Q and Q of a slider.
    """

    springs: Floats
    contacts: Floats
    moved: Floats
    gap: Floats
    load: Floats
    law: Callable[[Floats], tuple[Floats, Floats]]
    stiffness: Floats
    far: Floats
    slack: Floats
    length: float
    least: Floats
    most: Floats

    def elongations(self, u: Floats) -> Floats:
        """Of the springs (m), shape (S,)."""
        return self.moved + self.springs @ u

    def gaps(self, u: Floats) -> Floats:
        """Openings of the contacts (m), shape (K,)."""
        return self.gap + self.contacts @ u

    @property
    def slides(self) -> Bools:
        """Which contacts are sliders, shape (K,)."""
        return np.isfinite(self.most)

    def largest(self, u: Floats) -> float:
        """The largest of all lengths (m), and of what forces do to springs alone."""
        extended = np.abs(self.load / self.body_stiffness).max()
        return max(self.length, float(np.abs(u).max()), float(extended))

    @cached_property
    def body_stiffness(self) -> Floats:
        """Of the springs at each body, and some at the bodies without any, shape (N,) (N/m)."""
        own = self.springs.T**2 @ self.stiffness
        other = own.max() or (np.abs(self.load).max() or 1.0) / (self.length or 1.0)
        return np.where(own > 0.0, own, other)

    def pushing(self, part: float) -> Floats:
        """Stiffness of contacts as a part of that of their bodies in series (N/m), shape (K,)."""
        return part / (self.contacts**2 @ (1.0 / self.body_stiffness))

    def runs_away(self, step: Floats) -> bool:
        """Whether the potential falls along a direction without end."""
        size = np.abs(step).max()
        x = self.springs @ step
        x[np.abs(x) <= CERTAIN * size] = 0.0
        y = self.contacts @ step
        y[np.abs(y) <= CERTAIN * size] = 0.0
        held = np.where(x < 0.0, *self.far)[x != 0.0] @ x[x != 0.0]
        held -= np.where(y < 0.0, self.most, self.least)[y != 0.0] @ y[y != 0.0]
        if not np.isfinite(held):
            return False
        return bool(self.load @ step - held > CERTAIN * np.abs(self.load * step).sum())


class NoEquilibriumError(Exception):
    """None was found: bodies that nothing holds, contacts that overlap wherever the bodies are."""

    def __init__(self, loose: Sequence[int] = (), overlapping: Sequence[int] = ()) -> None:
        super().__init__(loose, overlapping)
        self.loose, self.overlapping = loose, overlapping


def equilibrium(potential: Potential, start: Floats) -> Floats:
    """Displacements (N,) of the equilibrium that is nearest to `start` (N,) (m).

    Raises
    ------
    NoEquilibriumError
        Where forces move a body without end, or contacts leave no room.
    """
    u = _some_equilibrium(potential, start)
    overlaps = (potential.gaps(u) < -SHUT * potential.largest(u)) & ~potential.slides
    overlapping = np.flatnonzero(overlaps)
    if overlapping.size:
        raise NoEquilibriumError(overlapping=overlapping.tolist())
    return _closed(potential, _nearest(potential, u, start))


def _some_equilibrium(potential: Potential, start: Floats) -> Floats:
    """An equilibrium, by multiplier steps."""
    u, pressing, pushing = start, np.zeros(potential.gap.size), potential.pushing(PUSHING)
    moved, missed = np.inf, np.full(pressing.size, np.inf)
    for i in range(MOST_MULTIPLIER_STEPS):
        drawing = DRAWING[min(i, DRAWING.size - 1)] * potential.body_stiffness
        task = _Step(potential, u, pressing, drawing, pushing)
        following = task.solved()
        step = following - u
        if potential.runs_away(step):
            raise NoEquilibriumError(loose=[int(np.argmax(np.abs(step)))])
        pressed = task.pressing(following)
        before, moved = moved, float(np.abs(step).max())
        earlier, missed = missed, np.abs(pressed - pressing) / pushing
        u, pressing, largest = following, pressed, potential.largest(following)
        if moved <= CLOSE * largest and not ROUNDING * largest < moved < 0.5 * before:
            return u
        # Where the forces of a long row come too slowly, its contacts are too soft.
        slow = (missed > SLOW * earlier) & (missed > SHUT * largest)
        pushing = np.where(slow, np.minimum(pushing / SLOW, potential.pushing(HARDEST)), pushing)
    raise NoEquilibriumError


@dataclass(frozen=True)
class _Step:
    """A multiplier step from places (N,) and forces of contacts (K,).

    drawing (N,), pushing (K,): stiffness of bodies to where they were, and of contacts.
    """

    potential: Potential
    centre: Floats
    pressed: Floats
    drawing: Floats
    pushing: Floats

    def pressing(self, u: Floats) -> Floats:
        """Forces of the contacts as springs that push."""
        of = self.potential
        return np.clip(self.pressed - self.pushing * of.gaps(u), of.least, of.most)

    def unbalanced(self, u: Floats) -> Floats:
        """Gradient of what is to be least (N), shape (N,)."""
        of = self.potential
        force = of.law(of.elongations(u))[0]
        inner = force @ of.springs - self.pressing(u) @ of.contacts
        return inner - of.load + self.drawing * (u - self.centre)

    def solved(self) -> Floats:
        """Where it is least."""
        u, of, short = self.centre, self.potential, 0
        for _ in range(MOST_NEWTON_STEPS):
            step = self._newton_step(u)
            whole, nothing = float(np.abs(step).max()), ROUNDING * of.largest(u)
            # No less than what moves a body at all: a contact that it touches is then felt.
            part = max(self._part(u, step), min(nothing / whole, 1.0) if whole > 0.0 else 1.0)
            u = u + part * step
            little = max(SOLVED * np.abs(u - self.centre).max(), 4.0 * nothing)
            # A short part of a long step meets a contact or a kink, each of them once.
            short = short + 1 if part * whole <= little else 0
            if whole <= little or short > of.gap.size + of.moved.size:
                break
        return u

    def _newton_step(self, u: Floats) -> Floats:
        """A step; forces of contacts are unknown in it, so that a hard one is no rounding."""
        of = self.potential
        slope = of.law(of.elongations(u))[1]
        pressing = self.pressing(u)
        pushed = (pressing > of.least) & (pressing < of.most)
        unit, size = of.body_stiffness**-0.5, of.pushing(1.0)[pushed]
        B, W = of.springs * unit, of.contacts[pushed] * unit * np.sqrt(size)[:, None]
        K = (B.T * slope) @ B + np.diag(self.drawing * unit**2)
        system = np.block([[K, -W.T], [W, np.diag(size / self.pushing[pushed])]])
        wanted = np.append(-unit * self.unbalanced(u), np.zeros(size.size))
        return unit * np.linalg.solve(system, wanted)[: u.size]

    def _part(self, u: Floats, step: Floats) -> float:
        """Where along a step what is to be least is so."""

        def slope(part: float) -> float:
            return float(self.unbalanced(u + part * step) @ step)

        first, last = slope(0.0), slope(1.0)
        if first >= 0.0 or last <= 0.1 * -first:
            return 1.0
        return float(brentq(slope, 0.0, 1.0, xtol=1e-300, rtol=1e-3, disp=False))


def _nearest(potential: Potential, u: Floats, start: Floats) -> Floats:
    """The equilibrium that is nearest to `start` in the sum of squares, from any one u.

    Forces of springs are the same in all equilibria, so their elongations are, too, but of those
    that are slack; and contacts are shut that are pressed by any forces in balance with them.
    """
    force = potential.law(potential.elongations(u))[0]
    gaps, slides, W = potential.gaps(u), potential.slides, potential.contacts
    shut = gaps <= SHUT * potential.largest(u)
    slipped = slides & (np.abs(gaps) > SHUT * potential.largest(u))
    pressing = np.where(slipped, np.where(gaps < 0.0, potential.most, potential.least), 0.0)
    rest = force @ potential.springs - potential.load - pressing @ W
    held = np.where(slides, ~slipped, shut)
    if (held & slides).any():
        limits = potential.least[held], potential.most[held]
        pressing[held] = lsq_linear(W[held].T, rest, limits, tol=1e-14).x
    elif held.any():
        pressing[held] = nnls(W[held].T, rest)[0]
    largest = max(np.abs(v).max(initial=0.0) for v in (force, pressing, potential.load))
    low, high = potential.slack
    slack = (low < high) & (np.abs(force) <= CERTAIN * largest)
    pressed = (pressing - potential.least > CERTAIN * largest) & (
        potential.most - pressing > CERTAIN * largest
    )
    Z = null_space(np.vstack((potential.springs[~slack], W[pressed])), CERTAIN)
    if Z.size == 0:
        return u
    u = u + Z @ (Z.T @ (start - u))
    B = potential.springs[slack]
    x = potential.elongations(u)[slack]
    # A slider at its limit may slip on, and not back.
    way = np.where(slides & (pressing > 0.0), -1.0, 1.0)[~pressed]
    rows = np.vstack((way[:, None] * W[~pressed], B, -B))
    room = np.concatenate((way * potential.gaps(u)[~pressed], x - low[slack], high[slack] - x))
    bounded = np.isfinite(room)
    return np.asarray(u + Z @ _least_distance(rows[bounded] @ Z, -room[bounded]))


def _least_distance(A: Floats, b: Floats) -> Floats:
    """The least x with ``A x >= b``, of a system that has solutions.

    The problem LDP of C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974,
    chapter 23: the residual of a non-negative least-squares problem.
    """
    size = np.abs(b).max(initial=0.0)
    if not (b > INSIDE * size).any():
        return np.zeros(A.shape[1])
    system = np.vstack((A.T, b / size))
    wanted = np.append(np.zeros(A.shape[1]), 1.0)
    residual = system @ nnls(system, wanted)[0] - wanted
    return np.asarray(residual[:-1] / -residual[-1] * size)


def _closed(potential: Potential, u: Floats) -> Floats:
    """The same with shut contacts shut to rounding, and displacements of less than that zero."""
    largest = potential.largest(u)
    for _ in range(3):
        gap = potential.gaps(u)
        shut = np.abs(gap) <= SHUT * largest
        u = u - np.linalg.lstsq(potential.contacts[shut], gap[shut], CERTAIN)[0]
    return np.where(np.abs(u) <= ROUNDING * largest, 0.0, u)
