"""What an instant demands of a scene with contacts at points between bodies.

The table at the head of `eventpound.contact.modes` holds; the impact law and the
acceleration problem over dense columns of W are run by Python, so that scenes without such
contacts have nothing more to compile. An instant takes some milliseconds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.contact.impacts import DONE, close_collapsed, impacts_until_none
from eventpound.contact.instant import begin_instant, end_instant, take_rests, touching_of
from eventpound.contact.rest import (
    LEFT_OVER,
    Touching,
    decide_by_orders,
    round_as_the_scene,
    system_of,
)
from eventpound.contact.state import Instant
from eventpound.mechanics.clusters import form_clusters
from eventpound.mechanics.descriptor import contact_rows
from eventpound.mechanics.impact import rates_after
from eventpound.mechanics.model import Model
from eventpound.mechanics.points import independent, on_clusters, projection_of
from eventpound.mechanics.reduced import Forcing, Reduced
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import in_python
from eventpound.numerics.lcp import solve_dense
from eventpound.tolerances import (
    CANCELLED,
    DEPENDENT,
    QUIET,
    ZERO_SINGULAR_VALUE,
)


def settle_at_points(at: Instant, model: Model) -> int:
    """Impacts of an instant of a scene with contacts at points; ends as `settle_impacts`."""
    rows = contact_rows(model)
    in_python(begin_instant)(at)
    ended = _settle_closed(rows, at)
    # No force has vanished that presses bodies which an impact has moved.
    moved = np.abs(rows) @ (at.v != at.before) > 0.0
    at.released[moved] = at.vanished[moved] = False
    return int(in_python(end_instant)(ended, at))


def decide_at_points(z: Floats, forcing: Forcing, at: Instant, model: Model) -> int:
    """Who rests after the impacts of an instant; as `decide_rests`."""
    touching = in_python(touching_of)(z, forcing, at)
    at_points = np.isin(np.arange(model.contacts), model.points)
    given = contact_rows(model), at_points
    found = in_python(decide_by_orders)(_pressed, _opening_of, _left_over, _solve, given, touching)
    return int(in_python(take_rests)(*found, at))


def _settle_closed(rows: Floats, at: Instant) -> int:
    """Put closed contacts on their constraints, and impacts until none approaches.

    `rows` (K, N): directions of the gaps, Wᵀ.
    """
    in_python(close_collapsed)(at)
    shut = at.gap == 0.0
    if not shut.any():
        return DONE
    _put_on(rows[shut], at.opening[shut], at.mass, at.u)
    ended = int(in_python(impacts_until_none)(impact_over, rows, shut, at))
    still = shut & (at.gap_rate == 0.0)
    if ended == DONE and still.any():
        _put_on(rows[still], np.zeros(int(still.sum())), at.mass, at.v)
    return ended


def _put_on(rows: Floats, opening: Floats, mass: Floats, x: Floats) -> None:
    """Move bodies the least, weighted by mass, so that ``opening + Wᵀ x`` vanishes."""
    away = opening + rows @ x
    root = np.sqrt(mass)
    x -= np.linalg.lstsq(rows / root, away, ZERO_SINGULAR_VALUE)[0] / root


def impact_over(
    rows: Floats, restitution: Floats, closed: Bools, at: Instant
) -> tuple[Floats, Bools, float, bool]:
    """Newton's law over the closed contacts; as `eventpound.mechanics.impact.impact_law`.

    `rows` (K, N): directions of the gaps, Wᵀ.
    """
    gap_rate, mass = at.gap_rate, at.mass
    impulse, involved = np.zeros(gap_rate.size), closed & (gap_rate <= 0.0)
    W, before, eps = rows[involved], gap_rate[involved], restitution[involved]
    noise = QUIET * float(np.max(-before))
    x, w, solved = solve_dense(W / mass @ W.T, (1.0 + eps) * before, noise)
    impulse[involved] = x
    change = W.T @ x / mass
    at.v[:] += change
    rounding = CANCELLED * (np.abs(gap_rate) + np.abs(rows) @ np.abs(change))
    gap_rate += rows @ change
    members = np.flatnonzero(involved)
    rates = in_python(rates_after)
    lost = rates(members, before, eps, noise, x, w, rounding, closed, gap_rate)
    return impulse, involved, lost, bool(solved)


class _AtPoints(NamedTuple):
    """What moves with contacts pressed; the first four as in `Pairs`.

    rows (K, C): directions of the gaps in the coordinates of the clusters. together (K, C):
    clusters that have to do with a contact by way of undecided and pressed ones.
    """

    system: Reduced
    y: Floats
    rough: Bools
    leaves: Bools
    rows: Floats
    together: Bools


def _pressed(
    given: tuple[Floats, Bools], touching: Touching, pressed: Bools, undecided: Bools
) -> _AtPoints:
    """What moves with these pressed."""
    rows, at_points = given
    mass, ordinary = touching.mass, pressed & ~at_points
    left, right, gap = touching.left, touching.right, touching.gap
    clusters = in_python(form_clusters)(left, right, gap, ordinary, ordinary, mass)
    system, y = in_python(system_of)(touching, clusters)
    D, total = on_clusters(rows, clusters.of_body, mass, clusters.count)
    constraints = D[pressed & at_points]
    chosen = independent(constraints, total, np.ones(constraints.shape[0], np.bool_))
    left_of, joined = D, np.eye(total.size, dtype=np.bool_)
    if chosen.any():
        P = projection_of(constraints[chosen], total)
        system = system._replace(projection=P)
        left_of, joined = D @ P, joined | (P != 0.0)
    # In the metric of the masses, as the constraints are told apart.
    size = np.linalg.norm(left_of / np.sqrt(total), axis=1)
    leaves = size > DEPENDENT * np.linalg.norm(rows / np.sqrt(mass), axis=1)
    rough = joined @ in_python(round_as_the_scene)(system, touching.forcing)
    together = _together(D != 0.0, joined, undecided & leaves)
    return _AtPoints(system, y, rough, leaves, D, together)


def _together(touched: Bools, joined: Bools, undecided: Bools) -> Bools:
    """Of `_AtPoints`, from which clusters contacts touch (K, C), and which depend on each other."""
    linked = joined | (touched[undecided].T.astype(int) @ touched[undecided].astype(int) > 0)
    for _ in range(max(1, int(np.ceil(np.log2(max(2, linked.shape[0])))))):
        linked = linked | (linked.astype(int) @ linked.astype(int) > 0)
    return np.asarray(touched.astype(int) @ linked.astype(int) > 0)


def _opening_of(
    now: _AtPoints, acceleration: Floats, noise: Floats, opening: Floats, level: Floats
) -> None:
    opening[:] = now.rows @ acceleration
    level[:] = np.max(np.where(now.together, noise, 0.0), axis=1, initial=0.0)


def _left_over(now: _AtPoints, acceleration: Floats, touching: Touching) -> Floats:
    left = np.where(touching.released, LEFT_OVER * np.abs(now.rows @ acceleration), 0.0)
    return np.max(np.where(now.together, left[:, None], 0.0), axis=0, initial=0.0)


def _solve(
    now: _AtPoints, members: Ints, opening: Floats, level: float
) -> tuple[Floats, Floats, bool]:
    D, P = now.rows[members], now.system.projection
    free = D / now.system.mass if P.size == 0 else (P @ (D / now.system.mass).T).T
    return solve_dense(D @ free.T, opening, level)
