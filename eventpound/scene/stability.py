"""Whether a scene with negative stiffnesses stands: its stiffness at rest is positive semidefinite.

P-Delta takes P/h of the stiffness of a storey, the couplings of a condensed frame may be negative,
and so may a linear spring beside others: what counts is that all springs of a structure together,
each by its tangent at rest (`eventpound.scene.at_rest`), never drive a motion. The matrix is
scaled by the sizes of the stiffnesses at its bodies, so that nothing depends on units or masses.
After yield they may: such a run is computed as long as it goes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.scene.at_rest import at_rest, stiffness_of
from eventpound.scene.ends import Direction
from eventpound.scene.grounded import grounded
from eventpound.scene.periods import joined
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Linear, Spring
from eventpound.scene.structures import joined_groups
from eventpound.tolerances import EPS

TOLD = 0.1
"""Part of the largest displacement of a motion below which a body is not named."""


class Unstable(NamedTuple):
    """A motion that nothing resists: which spring drives it most, and what moves."""

    spring: int
    moves: str


def may_soften(scene: Scene) -> bool:
    """Whether it has a spring whose stiffness may be negative."""
    return any(s.weight is not None or _is_negative(s) for s in scene.springs)


def _is_negative(spring: Spring) -> bool:
    return isinstance(spring.law, Linear) and spring.law.stiffness < 0.0


def unstable(scene: Scene, start: float = 0.0) -> Unstable | None:
    """What gives way at rest as a run starts at a time (s); None where everything resists.

    A scene without a negative stiffness is not looked at. It is checked but for this.
    """
    if not may_soften(scene):
        return None
    springs = grounded(at_rest(scene, start)).springs
    stiffness = [stiffness_of(spring) for spring in springs]
    for group in joined_groups([b.name for b in scene.bodies], [s.ends for s in springs]):
        own = [i for i, spring in enumerate(springs) if not {*group}.isdisjoint(spring.ends)]
        if all(stiffness[i] >= 0.0 for i in own):
            continue
        links = [(springs[i].direction, stiffness[i]) for i in own]
        moves = motion_of_links(group, links)
        if moves is not None:
            u = dict(zip(group, moves.tolist(), strict=True))
            work = [_work(u, *link) for link in links]
            return Unstable(own[int(np.argmin(work))], words_of_moves(group, moves))
    return None


def motion_of_links(
    bodies: Sequence[str], links: Sequence[tuple[Direction, float]]
) -> Floats | None:
    """A motion, the largest part 1, in which links do negative work; None where none is.

    Parameters
    ----------
    bodies : sequence of str
        Their names.
    links : sequence
        Direction of each link, in bodies and the ground, and its stiffness or coefficient.
    """
    sizes = joined(bodies, [(direction, abs(k)) for direction, k in links]).diagonal()
    return gives_way(joined(bodies, links), sizes)


def words_of_moves(bodies: Sequence[str], moves: Floats) -> str:
    """A motion in words, of the bodies that take much part in it."""
    parts = [(name, u) for name, u in zip(bodies, moves.tolist(), strict=True) if abs(u) >= TOLD]
    return "it gives way as " + ", ".join(f"{name} {u:.2g}" for name, u in parts[:8])


def gives_way(stiffness: Floats, sizes: Floats) -> Floats | None:
    """A motion of bodies, the largest part 1, that does negative work; None where none does.

    Parameters
    ----------
    stiffness : ndarray, shape (N, N)
        K, symmetric (N/m).
    sizes : ndarray, shape (N,)
        Of the stiffnesses at each body (N/m), for scale and rounding.
    """
    unit = 1.0 / np.sqrt(np.where(sizes > 0.0, sizes, 1.0))
    values, vectors = np.linalg.eigh(stiffness * np.outer(unit, unit))
    if values[0] >= -4.0 * values.size * EPS:
        return None
    u = unit * vectors[:, 0]
    return np.asarray(u / u[np.argmax(np.abs(u))])


def _work(u: dict[str, float], direction: Direction, stiffness: float) -> float:
    x = sum(weight * u.get(end, 0.0) for end, weight in direction)
    return stiffness * x * x
