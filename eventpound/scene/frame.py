"""A frame given by its matrices, condensed to lumped masses: its bodies, springs and dashpots.

A symmetric K with lumped masses is that of springs: -K_ij between i and j, and sum_j K_ij between
i and what the frame stands on, of either sign. So is C one of dashpots. What rounding leaves of a
sum or an entry, in parts of the entries it is of, is nothing: a frame that nothing holds stays so.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise
from typing import Any, NamedTuple

import numpy as np

from eventpound.basics.given import checked
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.body import Body
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.ends import direction_of
from eventpound.scene.spring import GROUND, Linear, Spring
from eventpound.scene.stability import motion_of_links, words_of_moves
from eventpound.units import Dimension, quantity

MOST_BODIES = 200
"""Of a frame: a full matrix makes a spring between every two of them."""
SYMMETRIC = 1e-9
"""Part of sqrt(K_ii K_jj) by which K_ij and K_ji may differ; of a mass off its diagonal, too."""
NOTHING = 1e-12
"""Part of the entries of a row that is rounding of their sum, or of one of them."""


class Frame(NamedTuple):
    """Parts of a frame, for a `Scene`."""

    bodies: tuple[Body, ...]
    springs: tuple[Spring, ...]
    dashpots: tuple[Dashpot, ...]


@checked
def frame(
    name: str,
    stiffness: Any,
    mass: Any,
    damping: Any = None,
    *,
    names: Sequence[str] | None = None,
    levels: Sequence[float | str] | None = None,
    on: str = GROUND,
) -> Frame:
    """A frame of another program by its matrices, condensed to degrees of freedom along the line.

    Parameters
    ----------
    name : str
        Of the frame.
    stiffness : array, shape (N, N)
        K (N/m): symmetric to rounding, positive semidefinite.
    mass : array, shape (N,) or (N, N)
        Lumped masses (kg), all positive; a matrix has to be diagonal.
    damping : array, shape (N, N), optional
        C (N s/m), as K. Ratios instead are given by `rayleigh` or `modal_damping`.
    names : sequence of str, optional
        Of the degrees of freedom, which are bodies; by default the name and a number from 1.
    levels : sequence of float, optional
        Heights of the degrees of freedom above what it stands on (m), rising: each is a floor
        then, and what is between two a storey with its drift.
    on : str
        What it stands on: the ground, a support, or a body such as a slab.

    Returns
    -------
    Frame
        ``bodies``, ``springs`` and ``dashpots``, for `Scene`.

    Raises
    ------
    InputError
        Naming the argument, and of a matrix the entry or the motion that is wrong.
    """
    ends = [] if names is None else list(names)
    K = _numbers("stiffness", stiffness)
    ends = ends or [f"{name}{i}" for i in range(1, len(K) + 1)]
    if len(ends) != len(K) or len(set(ends)) < len(ends) or not 0 < len(ends) <= MOST_BODIES:
        raise InputError(
            f"names: found {len(set(ends))} for {len(K)} rows of stiffness; accepted: a name of "
            f"its own for each, up to {MOST_BODIES}; condense a larger frame"
        )
    _check_matrix("stiffness", K, ends)
    heights = {} if levels is None else _storeys(levels, [on, *ends])
    masses = zip(ends, _lumped(mass, ends), strict=True)
    bodies = tuple(Body(end, m, structure=name) for end, m in masses)
    # A storey without a coupling is measured by a spring that does not resist.
    links = dict(_links(K, ends, on))
    links |= {pair: 0.0 for pair in heights if pair not in links}
    springs = tuple(
        Spring("-".join(pair), pair, Linear(k), heights.get(pair), frame=name)
        for pair, k in links.items()
    )
    if damping is None:
        return Frame(bodies, springs, ())
    C = _numbers("damping", damping)
    _check_matrix("damping", C, ends)
    return Frame(bodies, springs, tuple(Dashpot(pair, c) for pair, c in _links(C, ends, on)))


def _storeys(levels: Sequence[float | str], ends: Sequence[str]) -> dict[tuple[str, str], float]:
    """Heights of the storeys (m), by their ends."""
    given = [0.0, *(quantity(level, Dimension.LENGTH) for level in levels)]
    rises = [high - low for low, high in pairwise(given)]
    if len(given) != len(ends) or not min(rises) > 0.0:
        raise InputError(
            f"levels: found {', '.join(f'{level:g}' for level in given[1:])}; accepted: "
            f"{len(ends) - 1} heights above what it stands on (m), each above the one before"
        )
    return dict(zip(pairwise(ends), rises, strict=True))


def _numbers(key: str, given: Any) -> Floats:
    """An array of finite numbers with one or two axes."""
    try:
        found = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        found = np.array(math.nan)
    if found.ndim not in (1, 2) or found.size == 0:
        raise InputError(f"{key}: found no array of numbers; accepted: rows of equal length")
    if not np.isfinite(found).all():
        at = tuple((np.argwhere(~np.isfinite(found))[0] + 1).tolist())
        raise InputError(f"{key}: found a number at {at} that is not finite; accepted: finite ones")
    return found


def _check_matrix(key: str, matrix: Floats, ends: Sequence[str]) -> None:
    """Refuse what is not square, not symmetric or not positive semidefinite."""
    n = len(ends)
    if matrix.shape != (n, n):
        raise InputError(f"{key}: found an array {matrix.shape}; accepted: ({n}, {n})")
    diagonal = matrix.diagonal()
    if diagonal.min() < 0.0:
        i = int(np.argmin(diagonal))
        raise InputError(
            f"{key}: found {diagonal[i]:.6g} at ({ends[i]}, {ends[i]}); accepted: a diagonal that "
            "is not negative"
        )
    root = np.sqrt(diagonal)
    size = np.maximum(np.outer(root, root), SYMMETRIC * root.max() ** 2)
    apart = np.abs(matrix - matrix.T) - SYMMETRIC * size
    if apart.max() > 0.0:
        i, j = divmod(int(np.argmax(apart)), n)
        raise InputError(
            f"{key}: found {matrix[i, j]:.10g} at ({ends[i]}, {ends[j]}) and {matrix[j, i]:.10g} "
            f"at ({ends[j]}, {ends[i]}); accepted: a matrix that is symmetric to rounding (where "
            "this is rounding, give (K + K')/2)"
        )
    links = [(direction_of(pair), k) for pair, k in _links(matrix, ends, GROUND)]
    moves = motion_of_links(ends, links)
    if moves is not None:
        raise InputError(
            f"{key}: found a matrix that is not positive semidefinite: "
            f"{words_of_moves(ends, moves)}; "
            "accepted: one that no motion makes negative (rounded numbers? give all digits)"
        )


def _lumped(mass: Any, ends: Sequence[str]) -> list[float]:
    """Masses (kg), from a list or a diagonal matrix."""
    found, n = _numbers("mass", mass), len(ends)
    if found.shape == (n, n) and n > 1:
        size = SYMMETRIC * np.abs(found.diagonal()).max()
        others = np.abs(found - np.diag(found.diagonal()))
        if others.max() > size:
            i, j = divmod(int(np.argmax(others)), n)
            raise InputError(
                f"mass: found {found[i, j]:.6g} kg between {ends[i]} and {ends[j]}; accepted: "
                "lumped masses: a list, or a diagonal matrix. Condense the model to degrees of "
                "freedom with lumped masses in its own program, or lump the sum of each row"
            )
        found = found.diagonal()
    if found.size != n:
        raise InputError(f"mass: found an array {found.shape}; accepted: ({n},) or ({n}, {n})")
    if found.min() <= 0.0:
        i = int(np.argmin(found))
        raise InputError(
            f"mass: found {found.ravel()[i]:.6g} kg at {ends[i]}; accepted: positive masses. "
            "Condense statically what has none: K_cc - K_cm K_mm^-1 K_mc"
        )
    return [float(m) for m in found.ravel()]


def _links(matrix: Floats, ends: Sequence[str], on: str) -> Iterator[tuple[tuple[str, str], float]]:
    """Ends and numbers of the links whose matrix it is, those to what it stands on first."""
    even = 0.5 * (matrix + matrix.T)
    sizes = np.abs(even).sum(axis=1)
    for end, row, size in zip(ends, even.tolist(), sizes.tolist(), strict=True):
        total = math.fsum(row)
        if abs(total) > NOTHING * size:
            yield (on, end), total
    for i, j in combinations(range(len(ends)), 2):
        if abs(even[i, j]) > NOTHING * min(sizes[i], sizes[j]):
            yield (ends[i], ends[j]), -float(even[i, j])
