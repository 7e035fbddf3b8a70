"""The distance of two motions that is not fooled by a jump at a slightly different time.

The completed graph of a body's motion is the curve of its points

    (t / T,  u(t) / U,  v(t) / V)

where the points before and after a jump of v are joined by a straight line; that of a
hysteretic spring is (t / T, z(t) / Z). The graph distance of two motions is the largest,
over bodies and springs, of the Hausdorff distances of these curves,

    d = max( sup_{p in A} inf_{q in B} |p - q|,  sup_{q in B} inf_{p in A} |p - q| ),

with the suprema taken over the rows of the history and the infima over the curve that
joins them. A jump of any size that comes δ later is worth δ/T, as it should be; the
plain sup norm of the difference,

    s = sup_t max( |u_A - u_B| / U,  |v_A - v_B| / V,  |z_A - z_B| / Z ),

calls it the whole jump. Curves are taken one body at a time because two impacts that
swap places within δ would otherwise be far apart: between them the one motion has
v_1 before and v_2 after its jump, the other the reverse.

Alt and Godau (1995) for distances of polygonal curves; Moreau (1978) for completed
graphs of motions with jumps of velocity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.polyline import furthest_vertex
from eventpound.solvers.base import History


@dataclass(frozen=True, slots=True)
class MotionScales:
    """What differences are divided by; N bodies, H hysteretic springs.

    Parameters
    ----------
    time : float
        T (s).
    u, v : ndarray, shape (N,)
        Largest displacement U (m) and speed V (m/s) of each body.
    z : ndarray, shape (H,)
        Bound Z of each hysteretic variable.
    """

    time: float
    u: Floats
    v: Floats
    z: Floats


@dataclass(frozen=True, slots=True)
class Distance:
    """Distances of two motions, as parts of their scales.

    Parameters
    ----------
    graph : float
        Hausdorff distance d of the completed graphs.
    graph_time : float
        Where it is attained (s).
    sup : float
        Largest difference s at one time.
    """

    graph: float
    graph_time: float
    sup: float


def distance(first: History, second: History, scales: MotionScales) -> Distance:
    """Distances of two motions over the stretch of time that both cover.

    Parameters
    ----------
    first, second : History
        At least one row each; columns that are NaN throughout, as velocities that
        another program did not write, are left out.
    scales : MotionScales
        What differences are divided by.
    """
    end = min(first.t[-1], second.t[-1])
    a, b = _until(first, end), _until(second, end)
    graph, at, sup = 0.0, float(first.t[0]), 0.0
    for left, right in _curves(a, b, scales):
        for one, other in ((left, right), (right, left)):
            far, vertex = furthest_vertex(one, other)
            if far > graph:
                graph, at = float(far), float(one[vertex, 0] * scales.time)
        sup = max(sup, _largest_difference(left, right))
    return Distance(graph, at, sup)


def _until(history: History, end: float) -> tuple[Floats, Floats, Floats, Floats]:
    """T, u, v, z of the rows up to `end`."""
    rows = int(np.searchsorted(history.t, end, side="right"))
    return history.t[:rows], history.u[:rows], history.v[:rows], history.z[:rows]


def _curves(
    a: tuple[Floats, ...], b: tuple[Floats, ...], scales: MotionScales
) -> Iterator[tuple[Floats, Floats]]:
    """The completed graphs of each body and spring, with columns that both have."""
    for i in range(scales.u.size):
        parts = [(1, scales.u[i]), (2, scales.v[i])]
        columns = [(a[k][:, i] / size, b[k][:, i] / size) for k, size in parts]
        yield _graphs(a[0], b[0], scales.time, columns)
    for i in range(scales.z.size):
        columns = [(a[3][:, i] / scales.z[i], b[3][:, i] / scales.z[i])]
        yield _graphs(a[0], b[0], scales.time, columns)


def _graphs(
    t_a: Floats, t_b: Floats, time: float, columns: list[tuple[Floats, Floats]]
) -> tuple[Floats, Floats]:
    known = [pair for pair in columns if not (np.isnan(pair[0]).any() or np.isnan(pair[1]).any())]
    return (
        np.column_stack([t_a / time, *(pair[0] for pair in known)]),
        np.column_stack([t_b / time, *(pair[1] for pair in known)]),
    )


def _largest_difference(a: Floats, b: Floats) -> float:
    """Sup norm over both sides of every row of either curve."""
    if a.shape[1] == 1:
        return 0.0
    t = np.union1d(a[:, 0], b[:, 0])
    largest = 0.0
    for before in (True, False):
        for column in range(1, a.shape[1]):
            values = [one_sided(t, curve[:, 0], curve[:, column], before) for curve in (a, b)]
            largest = max(largest, float(np.abs(values[0] - values[1]).max()))
    return largest


def one_sided(t: Floats, times: Floats, values: Floats, before: bool) -> Floats:
    """Values between rows, linear; at a time that has several rows, before or after the jump.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Where (s).
    times, values : ndarray, shape (m,)
        The rows; times never decrease.
    before : bool
        Whether a jump is looked at from before it.

    Returns
    -------
    ndarray, shape (n,)
        Constant beyond the rows.
    """
    following = np.searchsorted(times, t, side="left" if before else "right")
    right = np.clip(following, 0, times.size - 1)
    left = np.clip(following - 1, 0, times.size - 1)
    width = times[right] - times[left]
    part = np.where(width > 0.0, (t - times[left]) / np.where(width > 0.0, width, 1.0), 0.0)
    part = np.clip(part, 0.0, 1.0)
    return np.asarray(values[left] + part * (values[right] - values[left]))
