"""How far the vertices of one polyline are from another, both ordered by their first coordinate.

    sup_i  min_k  min_{0 <= s <= 1} | p_i - q_k - s (q_(k+1) - q_k) |

with the Euclidean norm. The first coordinate never decreases, so a segment whose part of
it lies further away than the nearest point found so far need not be looked at.
"""

from __future__ import annotations

import math

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel


@scalar_kernel
def _squared_distance(points: Floats, i: int, curve: Floats, k: int) -> float:
    """Squared distance of point i from segment k (a single vertex where it is the last)."""
    last = k + 1 >= curve.shape[0]
    along = length = 0.0
    if not last:
        for c in range(curve.shape[1]):
            step = curve[k + 1, c] - curve[k, c]
            along += (points[i, c] - curve[k, c]) * step
            length += step * step
    s = min(max(along / length, 0.0), 1.0) if length > 0.0 else 0.0
    total = 0.0
    for c in range(curve.shape[1]):
        step = 0.0 if last else curve[k + 1, c] - curve[k, c]
        apart = points[i, c] - curve[k, c] - s * step
        total += apart * apart
    return total


@scalar_kernel
def _nearest(points: Floats, i: int, curve: Floats, start: int, enough: float) -> float:
    """Distance of point i from the curve, or something not above `enough`."""
    best = math.sqrt(_squared_distance(points, i, curve, start))
    left, right = start - 1, start + 1
    while best > enough:
        going = False
        if left >= 0 and points[i, 0] - curve[left + 1, 0] <= best:
            best = min(best, math.sqrt(_squared_distance(points, i, curve, left)))
            left -= 1
            going = True
        if right < curve.shape[0] and curve[right, 0] - points[i, 0] <= best:
            best = min(best, math.sqrt(_squared_distance(points, i, curve, right)))
            right += 1
            going = True
        if not going:
            break
    return best


@kernel
def furthest_vertex(points: Floats, curve: Floats) -> tuple[float, int]:
    """Largest distance of the vertices of a polyline from another polyline.

    Parameters
    ----------
    points : ndarray, shape (n, d)
        Vertices whose distance is asked for, n >= 1.
    curve : ndarray, shape (m, d)
        Vertices of the other polyline, m >= 1. In both, the first column never
        decreases.

    Returns
    -------
    distance : float
        The largest distance.
    vertex : int
        The first vertex that has it.
    """
    worst, vertex, start = -1.0, 0, 0
    for i in range(points.shape[0]):
        while start + 1 < curve.shape[0] and curve[start + 1, 0] <= points[i, 0]:
            start += 1
        distance = _nearest(points, i, curve, start, worst)
        if distance > worst:
            worst, vertex = distance, i
    return worst, vertex
