"""How far two runs are apart: distances of their graphs, numbers, events."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from eventpound.score.levels import ALWAYS, EVENTS, ROUNDING, Floats
from eventpound.score.pairing import Paired, Weights, pair_events


@dataclass(frozen=True, slots=True)
class MotionScales:
    """What differences of a motion are divided by; N bodies, H hysteretic springs.

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
    """Distances of two motions, in parts of their scales.

    Parameters
    ----------
    graph : float
        Hausdorff distance of the completed graphs.
    graph_time : float
        Where it is attained (s).
    sup : float
        Largest difference at one time.
    """

    graph: float
    graph_time: float
    sup: float


def distance(first: Any, second: Any, scales: MotionScales) -> Distance:
    """Distances of two motions over the stretch of time that both cover.

    The completed graph of a body's motion is the curve of its points (t/T, u/U, v/V), with those
    before and after a jump of v joined by a line; that of a hysteretic spring is (t/T, z/Z). The
    graph distance is the largest, over bodies and springs, of the Hausdorff distances of these
    curves A and B,

        d = max( sup_{p in A} inf_{q in B} |p - q|,  sup_{q in B} inf_{p in A} |p - q| ),

    with the suprema over the rows. A jump of any size that comes δ later is worth δ/T; the sup
    norm of the difference calls it the whole jump. Bodies are taken one by one, since two impacts
    that swap places within δ would otherwise be far apart. Alt and Godau (1995) for distances of
    polygonal curves; Moreau (1978) for completed graphs of motions with jumps of velocity.

    Parameters
    ----------
    first, second : Motion
        Or anything with its t, u, v, z, at least one row each; columns with a NaN, as velocities
        that a program did not write, are left out.
    scales : MotionScales
        What differences are divided by.
    """
    end = min(first.t[-1], second.t[-1])
    a, b = (
        [x[: int(np.searchsorted(m.t, end, side="right"))] for x in (m.t, m.u, m.v, m.z)]
        for m in (first, second)
    )
    bodies, springs = range(scales.u.size), range(scales.z.size)
    curves = [([(1, scales.u[i]), (2, scales.v[i])], i) for i in bodies]
    curves += [([(3, scales.z[i])], i) for i in springs]
    graph, at, sup = 0.0, float(a[0][0]), 0.0
    for parts, i in curves:
        columns = [(a[k][:, i] / size, b[k][:, i] / size) for k, size in parts]
        known = [pair for pair in columns if not np.isnan(np.concatenate(pair)).any()]
        left = np.column_stack([a[0] / scales.time, *(pair[0] for pair in known)])
        right = np.column_stack([b[0] / scales.time, *(pair[1] for pair in known)])
        for one, other in ((left, right), (right, left)):
            far, vertex = furthest_vertex(one, other)
            if far > graph:
                graph, at = far, float(one[vertex, 0] * scales.time)
        sup = max(sup, _largest_difference(left, right))
    return Distance(graph, at, sup)


def _largest_difference(a: Floats, b: Floats) -> float:
    """Sup norm over both sides of every row of either curve."""
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


def furthest_vertex(points: Floats, curve: Floats) -> tuple[float, int]:
    """Largest distance of the vertices of a polyline from another, and the first that has it.

        sup_i  min_k  min_{0 <= s <= 1} | p_i - q_k - s (q_(k+1) - q_k) |

    The distance from the segment at the same first coordinate is an upper bound, and no segment
    further along than it comes nearer; so the vertices are taken from the largest bound on, until
    no bound exceeds what was found.

    Parameters
    ----------
    points, curve : ndarray, shape (n, d), (m, d)
        Vertices, n, m >= 1; the first coordinate never decreases in either.
    """
    beside = np.searchsorted(curve[:, 0], points[:, 0], side="right") - 1
    near = _from_segments(points.T, curve, np.maximum(beside, 0))
    order = np.argsort(-near, kind="stable")
    worst, vertex = -1.0, 0
    for n in range(0, order.size, 64):
        rows = order[n : n + 64]
        if near[rows[0]] < worst:
            break
        # Each vertex with the segments of its own that may be nearer than its bound.
        low, high = (points[rows, 0] + side * near[rows] for side in (-1.0, 1.0))
        start = np.maximum(np.searchsorted(curve[:, 0], low) - 1, 0)
        count = np.maximum(np.searchsorted(curve[:, 0], high, side="right") - start, 1)
        begins = np.cumsum(count) - count
        segments = np.arange(count.sum()) + np.repeat(start - begins, count)
        apart = _from_segments(points[np.repeat(rows, count)].T, curve, segments)
        far = np.minimum.reduceat(apart, begins)
        first = int(rows[far == far.max()].min())
        if far.max() > worst or (far.max() == worst and first < vertex):
            worst, vertex = float(far.max()), first
    return worst, vertex


def _from_segments(points: Floats, curve: Floats, k: Floats) -> Floats:
    """Distances of points, shape (d, ...), from segments k; the last one is its vertex."""
    start, step = curve[k].T, (curve[np.minimum(k + 1, curve.shape[0] - 1)] - curve[k]).T
    along = length = total = np.zeros(1)
    for p, q, h in zip(points, start, step, strict=True):
        along, length = along + (p - q) * h, length + h * h
    s = np.clip(along / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
    for p, q, h in zip(points, start, step, strict=True):
        total = total + (p - q - s * h) ** 2
    return np.sqrt(total)


@dataclass(frozen=True, slots=True)
class ScaledValue:
    """A number of a run.

    Parameters
    ----------
    name : str
        As in ``summary.json``, ``peaks.deck1.max``.
    value : float
        In its unit.
    scale : float
        What its error is divided by and its digits are counted from, in its unit.
    unit : str
        SI; empty for a pure number.
    bound : float
        How far the value itself may be off, in its unit; NaN where nobody knows.
    amplification : float
        Change, in parts of the scale, for a relative change of the inputs.
    """

    name: str
    value: float
    scale: float
    unit: str = ""
    bound: float = math.nan
    amplification: float = 0.0


@dataclass(frozen=True, slots=True)
class Deviation:
    """A quantity of the reference beside its value in a run."""

    quantity: ScaledValue
    value: float

    @property
    def error(self) -> float:
        """Distance of the two in parts of the scale; NaN where there is no value."""
        return abs(self.value - self.quantity.value) / self.quantity.scale

    @property
    def floor(self) -> float:
        """What the reference leaves open and rounding does to a well-made program, likewise."""
        quantity = self.quantity
        return quantity.bound / quantity.scale + ROUNDING * quantity.amplification


@dataclass(frozen=True)
class Truth:
    """What a run is held against.

    Parameters
    ----------
    quantities : sequence of ScaledValue
        Its numbers.
    events : sequence of Event
        In order of time.
    unit : float
        Of shifts and lengths of rests (s), see `pair_events`.
    covered : tuple of float
        Stretch of time (s).
    scales : MotionScales or None
        What differences of the motions are divided by, where they are compared.
    weights : Weights or None
        Which events are paired and count, where not those of `pair_events`.
    of_events : tuple of str
        Attributes of events that are quantities, ``events.<row>.<attribute>``.
    """

    quantities: Sequence[ScaledValue]
    events: Sequence[Any]
    unit: float
    covered: tuple[float, float] = ALWAYS
    scales: MotionScales | None = None
    weights: Weights | None = None
    of_events: tuple[str, ...] = ()


@dataclass(frozen=True)
class Difference:
    """How far a run is from another.

    Parameters
    ----------
    quantities : tuple of Deviation
        Those that both have.
    events : Paired
        Of the kinds that the run reports.
    kinds : tuple of str
        These kinds.
    distance : Distance
        Of the motions; NaN where they were not given.
    """

    quantities: tuple[Deviation, ...]
    events: Paired
    kinds: tuple[str, ...]
    distance: Distance

    @property
    def impacts(self) -> Paired:
        """Impacts of both."""
        return self.events.of("impact")

    @property
    def rests(self) -> Paired | None:
        """Beginnings and ends of rests; None where the run does not say."""
        return self.events.of("rest", "detachment") if "rest" in self.kinds else None

    def largest(self, part: str) -> float:
        """The error of `worst`; NaN where none is known."""
        worst = self.worst(part)
        return math.nan if worst is None else worst.error

    def worst(self, part: str) -> Deviation | None:
        """The largest error of ``"peaks"``, ``"final"`` or ``"history"``, times left out."""
        known = [
            q for q in self.quantities
            if q.quantity.name.startswith(part) and ".t_" not in q.quantity.name
            and not math.isnan(q.error)
        ]  # fmt: skip
        return max(known, key=lambda q: q.error, default=None)


def difference(
    truth: Truth,
    values: Mapping[str, float],
    events: Sequence[Any],
    kinds: Sequence[str] = ("impact", *EVENTS),
    *,
    end: float = math.inf,
    motions: tuple[Any, Any] | None = None,
) -> Difference:
    """How far a run is from what it is held against.

    Parameters
    ----------
    truth : Truth
        The reference.
    values : mapping of str to float
        Numbers of the run by name; NaN for what it does not know.
    events : sequence of Event
        Its events, in order of time.
    kinds : sequence of str
        What of them is paired.
    end : float
        Where the run ends (s), if that is earlier.
    motions : tuple of Motion, optional
        The motion of the reference and that of the run.
    """
    scales = truth.scales
    covered = truth.covered[0], min(truth.covered[1], end)
    speed = 0.0 if scales is None else float(scales.v.max())
    paired = pair_events(
        truth.events, events, truth.unit, kinds,
        speed=speed, covered=covered, weights=truth.weights,
    )  # fmt: skip
    row = {id(event): i for i, event in enumerate(truth.events)}
    known = {
        **values,
        **{
            f"events.{row[id(p.reference)]}.{key}": getattr(p.found, key)
            for p in paired.pairs
            if not math.isnan(p.shift)
            for key in truth.of_events
        },
    }
    return Difference(
        tuple(Deviation(q, known[q.name]) for q in truth.quantities if q.name in known),
        paired,
        tuple(kinds),
        distance(*motions, scales)
        if motions is not None and scales is not None
        else Distance(math.nan, math.nan, math.nan),
    )
