"""The Bouc–Wen law with time eliminated: z as a function of the elongation alone.

Eq. 3 of the founding paper is rate-independent. While x' keeps its sign σ,

    dz/dx = (1/u_y) [1 - (γ σ sgn z + β) |z|^n],

so with the bound ``b = (β + γ)^(-1/n)``, ``y = σ z / b`` and
``ξ = ξ_r + σ (x - x_r) / (u_y b)`` every loading and unloading is a part of one
curve ``y = Φ(ξ)``:

    Φ' = 1 - Φ^n  (Φ > 0),    Φ' = 1 - ρ |Φ|^n  (Φ < 0),    Φ(0) = 0,
    ρ = (β - γ) / (β + γ).

For small ξ, ``Φ = ξ G(ξ^n)`` with one analytic G; beyond, Φ is tabulated by
local Taylor expansions. The nearest singularity of Φ is π/n away from the real
axis (``∫_0^∞ dy / (1 - y^n)`` along its rays), which sets the width of a cell.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from eventpound.mechanics.link_law import BETA, EXPONENT, GAMMA, YIELD, has_backbone, z_bound
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import in_python, scalar_kernel
from eventpound.numerics.power_series import integer_power, power_coefficient
from eventpound.tolerances import BESIDE_ONE, BEYOND_TABLE, FEW_TERMS, ITERATED, OF_BACKBONE, STEEP

TERMS = 14
"""Coefficients of a cell: half a cell is 1/16 of the distance to a singularity."""
NEAR_TERMS = 24
"""Coefficients of G."""
NEAR = 0.15
"""Largest |ρ| ξ^n at which G is used; its radius of convergence exceeds 1."""
CELLS_PER_RADIUS = 8.0
_ROOM = (256, 4096, 100_000)
"""Cells for which there is room, more where these do not do; the last are all there can be."""
TABLES_KEPT = 64
"""Backbones kept between runs."""
_EXPONENT, _RHO, _BOUND, _NEAR_UP, _SCALE_UP, _CELLS_UP, _END_UP = 0, 1, 2, 3, 4, 5, 6
_NEAR_DOWN, _SCALE_DOWN, _CELLS_DOWN = 7, 8, 9
_WIDTH_UP, _WIDTH_DOWN = 10, 11
_HEADER = 12
_NO_BACKBONE = ((YIELD, np.inf), (EXPONENT, 1.0), (BETA, 1.0), (GAMMA, 0.0))
"""Constants with which the z of a law that is not solved here stands still."""


class Hysteresis(NamedTuple):
    """Hysteretic links (H,): their backbones and the borders between its parts, in ξ.

    `core`: |ξ| up to which Φ is a line both ways. `down`: ξ < 0 down to which
    it is a line. `saturated`: ξ from which Φ is 1. `scale`: ``u_y b`` (m).

    `followed` (F,): numbers h of those whose law is another, and has no backbone. Their `scale`
    and `core` are inf and their `bound` is 1: by ξ their z stands still.
    """

    link: Ints
    tables: Floats
    at: Ints
    core: Floats
    down: Floats
    saturated: Floats
    scale: Floats
    bound: Floats
    followed: Ints


def _near_series(n: float, g: Floats, h: Floats) -> None:
    """Coefficients of G into `g`: ``(1 + n k) g_k = -h_{k-1}`` with H = G^n."""
    power = in_python(power_coefficient)
    g[0] = 1.0
    for k in range(NEAR_TERMS):
        if k > 0:
            g[k] = -h[k - 1] / (1.0 + n * k)
        h[k] = power(g, h, n, k)


@scalar_kernel
def _horner(coefficients: Floats, first: int, count: int, x: float) -> float:
    """A polynomial of an even number of coefficients.

    Even and odd powers by themselves: half as long a chain of sums to wait for.
    """
    square = x * x
    even, odd = coefficients[first + count - 2], coefficients[first + count - 1]
    for k in range(count - 4, -1, -2):
        even = even * square + coefficients[first + k]
        odd = odd * square + coefficients[first + k + 1]
    return even + odd * x


@scalar_kernel
def _fill_cells(
    n: float, kappa: float, y: float, width: float, last: float, table: Floats, power: Floats
) -> int:
    """Taylor expansions of ``y' = 1 - κ y^n`` about the middles of cells, until y passes `last`.

    Written to `table`, shape (cells, TERMS). Returns how many there are, 0 where there is no
    room for all.
    """
    half = 0.5 * width
    for i in range(table.shape[0]):
        c = table[i]
        # The value in the middle from an expansion about the cell's start.
        _expand(n, kappa, y, c, power)
        _expand(n, kappa, _horner(c, 0, TERMS, half), c, power)
        # The slope 1 - y^n is n (1 - y) near one: below this Φ is one to rounding.
        before, y = y, _horner(c, 0, TERMS, half)
        if y >= last or y <= before or 1.0 - kappa * y**n <= OF_BACKBONE * n:
            return i + 1
    return 0


@scalar_kernel
def _expand(n: float, kappa: float, y: float, c: Floats, power: Floats) -> None:
    c[0] = y
    for k in range(TERMS - 1):
        power[k] = power_coefficient(c, power, n, k)
        c[k + 1] = ((1.0 if k == 0 else 0.0) - kappa * power[k]) / (k + 1)


def _cells(n: float, kappa: float, y: float, width: float, last: float) -> Floats:
    """The cells of a branch that starts at y, shape (cells, TERMS)."""
    for room in _ROOM:
        table = np.zeros((room, TERMS))
        count = _fill_cells(n, kappa, y, width, last, table, np.zeros(TERMS))
        if count > 0:
            break
    return table[: count or room]


def backbone_table(n: float, beta: float, gamma: float) -> Floats:
    """Everything `backbone` needs of one law, as one flat array.

    Parameters
    ----------
    n, beta, gamma : float
        Constants of the law, ``n >= 1``, ``β + γ > 0``.
    """
    horner = in_python(_horner)
    rho = (beta - gamma) / (beta + gamma)
    g = np.zeros(NEAR_TERMS)
    _near_series(n, g, np.zeros(NEAR_TERMS))
    near_up = NEAR ** (1.0 / n)
    y = near_up * horner(g, 0, NEAR_TERMS, NEAR)
    radius = np.pi / n
    if n != int(n):
        # |y|^n has a branch point at zero.
        radius = min(radius, near_up)
    width = radius / CELLS_PER_RADIUS
    up = _cells(n, 1.0, y, width, 1.0)
    near_down, scale_down = np.inf, 1.0
    down = np.empty((0, TERMS))
    if rho != 0.0:
        near_down = min((NEAR / abs(rho)) ** (1.0 / n), 1.0 + BEYOND_TABLE)
        y = near_down * horner(g, 0, NEAR_TERMS, rho * near_down**n)
        width_down = min(width, 1.0 / (n * (1.0 + abs(rho))) / CELLS_PER_RADIUS)
        scale_down = 1.0 / width_down
        if y < 1.0 + BEYOND_TABLE:
            down = _cells(n, rho, y, width_down, 1.0 + BEYOND_TABLE)
    header = np.array(
        [
            n,
            rho,
            (beta + gamma) ** (-1.0 / n),
            near_up,
            1.0 / width,
            float(len(up)),
            near_up + width * len(up),
            near_down,
            scale_down,
            float(len(down)),
            width,
            1.0 / scale_down,
        ]
    )
    return np.concatenate((header, g, up.ravel(), down.ravel()))


@scalar_kernel
def backbone(table: Floats, at: int, xi: float) -> float:
    """``y = Φ(ξ)``.

    Parameters
    ----------
    table : ndarray
        Tables of one or more laws, one after the other.
    at : int
        Where the table of this law starts.
    xi : float
        ξ; beyond the table Φ is 1.
    """
    if xi >= 0.0:
        if xi >= table[at + _END_UP]:
            return 1.0
        near = table[at + _NEAR_UP]
        if xi <= near:
            w = integer_power(xi, table[at + _EXPONENT])
            return xi * _near_value(table, at, w)
        cells = table[at + _CELLS_UP]
        scale, width = table[at + _SCALE_UP], table[at + _WIDTH_UP]
        return _cell_value(table, at, xi - near, scale, width, 0, cells)
    rho = table[at + _RHO]
    # β = γ, as the founding paper has it: unloading is elastic.
    if rho == 0.0:
        return xi
    near = table[at + _NEAR_DOWN]
    if -xi <= near:
        # Φ = ξ G(w) solves Φ' = 1 - w Gⁿ for either sign, with w = ρ |ξ|^n below zero.
        w = rho * integer_power(-xi, table[at + _EXPONENT])
        return xi * _near_value(table, at, w)
    skip, cells = int(table[at + _CELLS_UP]), table[at + _CELLS_DOWN]
    scale, width = table[at + _SCALE_DOWN], table[at + _WIDTH_DOWN]
    return -_cell_value(table, at, -xi - near, scale, width, skip, cells)


@scalar_kernel
def _near_value(table: Floats, at: int, w: float) -> float:
    """G(w), with as many terms as it needs."""
    if abs(w) < BESIDE_ONE:
        return 1.0
    # An even number, for `_horner`.
    count = 6 if abs(w) < FEW_TERMS else NEAR_TERMS
    return _horner(table, at + _HEADER, count, w)


@scalar_kernel
def _cell_value(
    table: Floats, at: int, x: float, scale: float, width: float, skip: int, cells: float
) -> float:
    # At the end of the last cell rounding would ask for one more.
    i = min(int(x * scale), int(cells) - 1)
    first = at + _HEADER + NEAR_TERMS + (skip + i) * TERMS
    return _horner(table, first, TERMS, x - (i + 0.5) * width)


@scalar_kernel
def shape_of(table: Floats, at: int) -> tuple[float, float]:
    """N and ρ of a law."""
    return table[at + _EXPONENT], table[at + _RHO]


@scalar_kernel
def backbone_inverse(table: Floats, at: int, y: float) -> float:
    """ξ with ``Φ(ξ) = y``, for ``-1 <= y <= 1``; the end of the table where y is 1.

    Bisection on the cells, then Newton's method with ``Φ' = 1 - κ |Φ|^n``.
    """
    n, rho = table[at + _EXPONENT], table[at + _RHO]
    kappa = 1.0 if y > 0.0 else rho
    if kappa == 0.0 or y == 0.0:
        return y
    size = abs(y)
    # Where Φ is flat y tells no ξ, and Newton's step would be a quotient of roundings.
    if kappa * integer_power(size, n) >= 1.0 - STEEP:
        return table[at + _END_UP] if y > 0.0 else -np.inf
    low, high = 0.0, table[at + _END_UP]
    if y < 0.0:
        high = table[at + _NEAR_DOWN]
        high = (
            min(high, 2.0)
            if table[at + _CELLS_DOWN] == 0.0
            else (high + table[at + _CELLS_DOWN] / table[at + _SCALE_DOWN])
        )
    sign = 1.0 if y > 0.0 else -1.0
    # Φ is ξ to first order.
    xi = min(size, high)
    for _ in range(100):
        value = abs(backbone(table, at, sign * xi))
        if value < size:
            low = xi
        else:
            high = xi
        slope = 1.0 - kappa * integer_power(value, n)
        step = (size - value) / slope if slope > 0.0 else np.inf
        following = xi + step
        # Near the bound a step over a small slope leads far out of the bracket.
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - xi) <= ITERATED * xi:
            return sign * following
        xi = following
    return sign * xi


def hysteresis_of(memory: Floats, link: Ints, small: Floats | float) -> Hysteresis:
    """Backbones of the hysteretic links of a scene, or with a leading axis of many.

    Parameters
    ----------
    memory : ndarray, shape (..., L, constants)
        Of the links.
    link : ndarray of int, shape (H,)
        The hysteretic links.
    small : float or ndarray, shape (...)
        The difference of Φ that does not count.
    """
    memory = memory.take(link, axis=-2)
    other = ~has_backbone(memory)
    if other.any():
        for column, value in _NO_BACKBONE:
            memory[..., column][other] = value
    n, beta, gamma = (memory[..., i] for i in (EXPONENT, BETA, GAMMA))
    table, places = _tables_of(n, beta, gamma)
    share = np.asarray(small)[..., None] + np.zeros(n.shape)
    core, down = backbone_borders(n, beta, gamma, share)
    core[other] = np.inf
    bound, saturated = z_bound(memory), np.empty(n.shape)
    _saturations(table, places.reshape(-1), share.reshape(-1), saturated.reshape(-1))
    return Hysteresis(
        link,
        table,
        places,
        core,
        down,
        saturated,
        memory[..., YIELD] * bound,
        bound,
        np.flatnonzero(other[(0,) * (other.ndim - 1)]),
    )


def _tables_of(n: Floats, beta: Floats, gamma: Floats) -> tuple[Floats, Ints]:
    """Backbones of all laws that differ, one after the other, and where that of each begins."""
    if n.size <= 1:
        tables = [_table_of(n.item(), beta.item(), gamma.item())] if n.size else [np.empty(0)]
        return tables[0], np.zeros(n.shape, np.int64)
    rows = np.column_stack((n.ravel(), beta.ravel(), gamma.ravel()))
    laws, which = rows[:1], np.zeros(rows.shape[0], np.int64)
    if not (rows == laws).all():
        laws, which = np.unique(rows, axis=0, return_inverse=True)
    tables = [_table_of(*law) for law in laws.tolist()]
    starts = np.cumsum([0, *(each.size for each in tables)])
    return np.concatenate(tables), starts[which.reshape(n.shape)].astype(np.int64)


@lru_cache(TABLES_KEPT)
def _table_of(n: float, beta: float, gamma: float) -> Floats:
    """The backbone of a law, which the runs of a suite have in common; not to be written to."""
    return backbone_table(n, beta, gamma)


@scalar_kernel
def _saturations(table: Floats, at: Ints, small: Floats, out: Floats) -> None:
    """Where Φ comes within a small difference of 1, into `out`; seldom different in a row."""
    for i in range(out.size):
        if i > 0 and at[i] == at[i - 1] and small[i] == small[i - 1]:
            out[i] = out[i - 1]
        else:
            out[i] = backbone_inverse(table, at[i], 1.0 - small[i])


def backbone_borders(
    exponent: Floats, beta: Floats, gamma: Floats, small: Floats
) -> tuple[Floats, Floats]:
    """Borders of the parts of backbones.

    Parameters
    ----------
    exponent, beta, gamma, small : ndarray
        Constants of the laws and the difference from a line that does not count, of one shape.

    Returns
    -------
    tuple of ndarray
        `core` and `down` as in `Hysteresis`.
    """
    rho = (beta - gamma) / (beta + gamma)
    up = ((exponent + 1.0) * small) ** (1.0 / (exponent + 1.0))
    with np.errstate(divide="ignore"):
        down = ((exponent + 1.0) * small / np.abs(rho)) ** (1.0 / (exponent + 1.0))
    return np.minimum(up, down), -down
