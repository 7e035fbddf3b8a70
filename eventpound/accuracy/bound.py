"""An error bound for every quantity, from runs of independent routes and of changed inputs.

With x_r(tight), x_r(loose) the values of route r at its two tolerances, x = x_0(tight)
the value stated, Δ(η) the change for a relative change of the inputs by η, A = Δ(1e-10)/1e-10
and ε the rounding of a double,

    e_r     = max(|x_r(tight) - x_r(loose)|, τ_r A)
    τ_r     = upper quartile of |x_r(tight) - x_r(loose)| / A over all quantities
    d_r     = |x_r(tight) - x|

    truncation   S e_0
    confirmed    2 min d_r over the independent routes
    disagreement 2 max d_r over the routes with d_r > S (e_r + e_0) + rounding,
                 over all routes where their events part
    conditioning 2 Δ(rounding of the inputs)
    rounding     (4 ε + η) scale + Δ(η), η what the state is put off by in all

    bound = max(truncation, confirmed, disagreement) + conditioning + rounding

τ_r is the change of the inputs that would do what the tolerance does; it guards
against two values that agree by chance. Why S = 10: errors that shrink with the
tolerance, as the convergence tests of both solvers show, leave the tight run an
error of a ninth of e_0, so S e_0 is ninety times the error expected, and all but 1 % of
a quantity's usual difference must have been cancelled before the bound fails; even then
`confirmed`, from another formulation, must have failed by the same chance. Its factor 2
covers a route that is no more accurate than the reference. What a change of the inputs
by 1e-10 moves by more than `JUMP` of its scale has no bound.

Rounding collects: each rounding of the state counts in full in η, since the steps of one
oscillation round alike and nothing says that they cancel (page "accuracy" of the docs), and so
does what is taken from cascades at their ends (`eventpound.accuracy.left_out`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from eventpound.accuracy.conditioning import LARGE, Conditioning
from eventpound.numerics.arrays import Floats
from eventpound.tolerances import EPS

SAFETY = 10.0
"""S."""
SMOOTH = 0.75
"""Exponent p of the conditioning below which a change of the inputs acts like a root."""
JUMP = 1e-3
"""Part of its scale by which `LARGE` changes of the inputs may move what is certified."""


class Limit(StrEnum):
    """What makes a bound as large as it is, or refuses it."""

    TOLERANCE = "tolerance"
    DISAGREEMENT = "disagreement"
    CONDITIONING = "conditioning"
    GRAZE = "graze"
    ROUNDING = "rounding"
    RIVALS = "equal extremes"
    ALONE = "one formulation only"
    LOST = "rounding decides whether it happens"
    JUMP = "the inputs' tenth digit decides"
    PARTED = "routes part before it"
    UNMEASURED = "conditioning not measured"


@dataclass(frozen=True)
class Agreement:
    """Values of all quantities by all routes.

    Parameters
    ----------
    tight, loose : ndarray, shape (routes, n)
        Values; NaN where a route has none.
    formulation : sequence of str
        Of each route.
    reference : int
        The route whose tight values are stated.
    touched : bool
        Whether its loose run touches what the tight one does not, or the other way
        round. From there on it is another solution, whose distance says nothing about
        the error of the tight run where all independent routes are nearer; what a touch
        does to the answer is in its conditioning.
    parted : bool
        Whether the routes part somewhere. Then the distance of every route counts.
    """

    tight: Floats
    loose: Floats
    formulation: Sequence[str]
    reference: int
    touched: bool = False
    parted: bool = False

    @property
    def values(self) -> Floats:
        """The values stated, shape (n,)."""
        values: Floats = self.tight[self.reference]
        return values

    @property
    def deviations(self) -> Floats:
        """d_r, shape (routes, n)."""
        return np.asarray(np.abs(self.tight - self.values))

    @property
    def independent(self) -> np.ndarray:
        """Routes of another formulation than the reference, shape (routes,)."""
        ours = self.formulation[self.reference]
        return np.array([formulation != ours for formulation in self.formulation])

    @property
    def confirmed(self) -> Floats:
        """Distance of the nearest independent route, inf where there is none; shape (n,)."""
        apart = _masked(self.deviations, ~self.independent, np.inf)
        return np.asarray(apart.min(axis=0, initial=np.inf))

    def convergence(self, slope: Floats) -> Floats:
        """e_r, shape (routes, n), for the changes A of shape (n,)."""
        own = np.abs(self.tight - self.loose)
        for r in range(own.shape[0]):
            own[r] = np.fmax(own[r], equivalent_change(own[r], slope) * slope)
        return own


def equivalent_change(own: Floats, slope: Floats) -> float:
    """τ_r: the relative change of the inputs that moves quantities as the tolerance does."""
    usable = np.isfinite(own) & np.isfinite(slope) & (slope > 0.0)
    return float(np.quantile(own[usable] / slope[usable], 0.75)) if usable.any() else 0.0


@dataclass(frozen=True)
class ErrorBounds:
    """ErrorBounds of all quantities, shape (n,), in their units.

    Parameters
    ----------
    bound : ndarray
        NaN where there is none.
    limit : list of Limit
        The largest part of each bound.
    """

    bound: Floats
    limit: list[Limit]


def decade(bound: float) -> int:
    """Power of ten at or below a bound: where the uncertain digit stands."""
    return math.floor(math.log10(bound))


def rounding_of_run(conditions: Conditioning, scale: Floats, displaced: float) -> Floats:
    """What rounding and ended cascades of a run add up to at worst, in the quantities' units.

    Parameters
    ----------
    conditions : Conditioning
        What changed inputs do.
    scale : ndarray, shape (n,)
        Of each quantity.
    displaced : float
        By how much the state is put off in all (`left_out.displaced`).

    Returns
    -------
    ndarray, shape (n,)
    """
    grown = np.fmax(conditions.slope * displaced, conditions.of_change(displaced))
    return np.asarray((4.0 * EPS + displaced) * scale + np.nan_to_num(grown))


def bounds_of(
    agreement: Agreement, conditions: Conditioning, scale: Floats, displaced: float
) -> ErrorBounds:
    """ErrorBounds of all quantities.

    Parameters
    ----------
    agreement : Agreement
        What the routes found.
    conditions : Conditioning
        What changed inputs do.
    scale : ndarray, shape (n,)
        Of each quantity.
    displaced : float
        By how much the state of the reference run is put off in all.
    """
    slope = np.nan_to_num(conditions.slope)
    apart, alone = agreement.deviations, ~agreement.independent
    e = agreement.convergence(slope)
    ours = e[agreement.reference]
    rounding = rounding_of_run(conditions, scale, displaced)
    confirmed = agreement.confirmed
    if agreement.touched:
        ours = np.fmin(ours, _masked(apart, alone, 0.0).max(axis=0))
    # Where the reference has no loose value its error is left to the nearest other route.
    unknown = np.isnan(agreement.loose[agreement.reference])
    own = np.where(unknown, np.fmax(confirmed, ours), ours)
    truncation = np.maximum(SAFETY * own, 2.0 * confirmed)
    beyond = apart > SAFETY * (e + np.nan_to_num(ours)) + rounding
    beyond |= agreement.parted & (apart > 0.0)
    disagreement = np.where(beyond, 2.0 * apart, 0.0).max(axis=0)
    conditioning = 2.0 * np.nan_to_num(conditions.of_rounding)
    bound = np.maximum(truncation, disagreement) + conditioning + rounding
    parts = np.vstack((truncation, disagreement, conditioning, rounding))
    names = (Limit.TOLERANCE, Limit.DISAGREEMENT, Limit.CONDITIONING, Limit.ROUNDING)
    limit = [
        Limit.GRAZE if names[k] is Limit.CONDITIONING and p < SMOOTH else names[k]
        for k, p in zip(np.argmax(parts, axis=0), conditions.exponent, strict=True)
    ]
    gone = np.isnan(conditions.large)
    unmeasured = gone & np.isnan(conditions.small)
    jumps = gone | (slope * LARGE > JUMP * scale)
    for refused, reason in (
        (jumps, Limit.JUMP),
        (unmeasured, Limit.UNMEASURED),
        (conditions.lost, Limit.LOST),
        (~np.isfinite(confirmed), Limit.ALONE),
    ):
        bound[refused] = np.nan
        limit = [reason if no else k for no, k in zip(refused, limit, strict=True)]
    return ErrorBounds(bound, limit)


def _masked(values: Floats, without: np.ndarray, instead: float) -> Floats:
    """Rows of values, some and what is NaN replaced."""
    return np.where(np.isnan(values) | without[:, np.newaxis], instead, values)
