"""Floor spectra: the largest responses of oscillators that stand on a body which may be struck.

For an oscillator of period T = 2 pi/w and damping ratio xi on a body of absolute displacement
U = u + u_g, so light that the body does not feel it, with q its elongation,

    q'' + 2 xi w q' + w^2 q = -U'',       q = q' = 0 at the start

    SD = max |q|    PSV = w SD    PSA = w^2 SD    SA = max |w^2 q + 2 xi w q'|

SA is the absolute acceleration of the oscillator. An impact of the body is an impulse on the
oscillator: where U' jumps, q' jumps by as much the other way, and q goes on. Nothing stands in
for the impact, so nothing of its force has to be resolved in time.

Between two rows U is the quintic of U, U', U'' at both, and what an oscillator makes of it is
summed as its Taylor series to rounding. The quintic meets U and U' at the rows, so what it errs
by, e = O(h^6), acts through two integrations by parts as w^2 e: the error of q is O(h^6) of the
motion, not the O(h^4) of the accelerations. Rows are doubled until no number changes by more
than `between.AGREEMENT`.

Source of SD, PSV, PSA: A. K. Chopra, Dynamics of Structures, chapter 6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eventpound.motion.oscillators import spectrum_columns
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import loop_kernel, scalar_kernel
from eventpound.quantities.between import Between, quintic_parts

if TYPE_CHECKING:
    import pandas as pd

_TERMS, _FEW_TERMS, _SHORT = 22, 12, 0.1
"""Of a series over at most 1/w, whose last is below 1/21! = 2e-20 of the first; and over at most
a tenth of that, 0.1^11/11! = 3e-19."""
_HALVINGS = 40
"""Of a bracket of a turning point, whose value errs by the square of what is left."""
_INSTANT = 1e-6
"""Part of 1/w below which the ends of a cell say all about it."""


def floor_table(
    rows: Between, bodies: Sequence[int], periods: Floats, ratios: Sequence[float]
) -> pd.DataFrame:
    """Floor spectra of some bodies.

    Parameters
    ----------
    rows : Between
        Their motion.
    bodies : sequence of int
        Which.
    periods : ndarray, shape (k,)
        T (s).
    ratios : sequence of float
        xi, each below 1.

    Returns
    -------
    DataFrame
        Columns body, damping, period (s), SD (m), PSV (m/s), PSA (m/s^2), PSA_g (g) and
        SA (m/s^2).
    """
    import pandas as pd

    names = [body.name for body in rows.scene.bodies]
    parts = []
    for body in bodies:
        for ratio in ratios:
            largest = _largest_responses(rows, body, periods, ratio)
            table = pd.DataFrame(spectrum_columns(periods, largest[:, 0]))
            table.insert(0, "damping", ratio)
            table.insert(0, "body", names[body])
            parts.append(table.assign(SA=largest[:, 1]))
    return pd.concat(parts, ignore_index=True)


def _largest_responses(rows: Between, body: int, periods: Floats, ratio: float) -> Floats:
    """Largest |q| (m) and |q'' + U''| (m/s^2) of oscillators on a body, shape (k, 2)."""
    motion = rows.scene.motion
    u = rows.u[:, body] + motion.displacement(rows.t)
    v = rows.v[:, body] + motion.velocity(rows.t)
    a = rows.a[:, body] + motion.acceleration(rows.t)
    h = np.diff(rows.t)
    c3, c4, c5 = quintic_parts(u, v, a, h)
    # h^2 U'' = sum_k push_k x^k over a cell, 0 <= x <= 1: no quotient of small numbers.
    push = np.stack([h**2 * a[:-1], 6.0 * c3, 12.0 * c4, 20.0 * c5], axis=1)
    found = np.zeros((periods.size, 2))
    _swing(h, push, np.diff(v), 2.0 * math.pi / periods, ratio, found)
    return found


@loop_kernel
def _swing(
    h: Floats, push: Floats, jump: Floats, omega: Floats, ratio: float, found: Floats
) -> None:
    """Follow oscillators over all cells; the largest |q| and |w^2 q + 2 xi w q'| into `found`."""
    room, f = np.empty((2, _TERMS)), np.empty(4)
    for j in range(omega.size):
        w = omega[j]
        place = rate = 0.0
        for i in range(h.size):
            if h[i] == 0.0:
                rate -= jump[i]
                found[j, 1] = max(found[j, 1], abs(w * w * place + 2.0 * ratio * w * rate))
                continue
            parts = max(1, math.ceil(w * h[i]))
            step = h[i] / parts
            terms = _FEW_TERMS if w * step <= _SHORT else _TERMS
            q, force = room[0, :terms], room[1, : terms - 1]
            inside = w * step > _INSTANT
            for part in range(parts):
                _pushed(push[i], part, parts, f)
                _series(place, rate * step, w * step, ratio, f, q)
                place, rate = _value(q, 1.0), _slope(q, 1.0) / step
                for k in range(terms - 1):
                    # w^2 q + 2 xi w q', whose terms are those of q and of its slope.
                    force[k] = w * w * q[k] + 2.0 * ratio * w / step * (k + 1) * q[k + 1]
                found[j, 0] = _largest(q, inside, found[j, 0])
                found[j, 1] = _largest(force, inside, found[j, 1])


@scalar_kernel
def _pushed(push: Floats, part: int, parts: int, f: Floats) -> None:
    """``h^2 U''`` over one of equal parts of a cell, with the length of the part for h, into f."""
    x, y = part / parts, 1.0 / parts
    f[0] = y**2 * (push[0] + x * (push[1] + x * (push[2] + x * push[3])))
    f[1] = y**3 * (push[1] + x * (2.0 * push[2] + x * 3.0 * push[3]))
    f[2] = y**4 * (push[2] + x * 3.0 * push[3])
    f[3] = y**5 * push[3]


@scalar_kernel
def _series(place: float, rate: float, wh: float, ratio: float, f: Floats, q: Floats) -> None:
    """Taylor coefficients of ``q'' + 2 xi (w h) q' + (w h)^2 q = -f`` from q and q' into q."""
    q[0], q[1] = place, rate
    for k in range(q.size - 2):
        pushed = f[k] if k < f.size else 0.0
        held = 2.0 * ratio * wh * (k + 1) * q[k + 1] + wh * wh * q[k]
        q[k + 2] = -(held + pushed) / ((k + 1) * (k + 2))


@scalar_kernel
def _value(c: Floats, x: float) -> float:
    value = 0.0
    for k in range(c.size - 1, -1, -1):
        value = value * x + c[k]
    return value


@scalar_kernel
def _slope(c: Floats, x: float) -> float:
    value = 0.0
    for k in range(c.size - 1, 0, -1):
        value = value * x + k * c[k]
    return value


@scalar_kernel
def _bend(c: Floats, x: float) -> float:
    value = 0.0
    for k in range(c.size - 1, 1, -1):
        value = value * x + k * (k - 1) * c[k]
    return value


@scalar_kernel
def _largest(c: Floats, inside: bool, known: float) -> float:
    """Largest size of a polynomial on 0 <= x <= 1, where it is larger than what is known.

    Its curvature changes its sign at most once there.
    """
    most = 0.0
    for k in range(c.size):
        most += abs(c[k])
    if most <= known:
        return known
    largest = max(known, abs(c[0]), abs(_value(c, 1.0)))
    if not inside:
        return largest
    # Either side of where it bends the other way its slope is monotone, and has one root at most.
    middle = 1.0
    if _bend(c, 0.0) * _bend(c, 1.0) < 0.0:
        middle = _root(c, 0.0, 1.0, True)
    for low, high in ((0.0, middle), (middle, 1.0)):
        if _slope(c, low) * _slope(c, high) < 0.0:
            largest = max(largest, abs(_value(c, _root(c, low, high, False))))
    return largest


@scalar_kernel
def _root(c: Floats, low: float, high: float, of_bend: bool) -> float:
    """Where the slope, or the curvature, of a polynomial changes its sign between two points."""
    rising = (_bend(c, low) if of_bend else _slope(c, low)) < 0.0
    for _ in range(_HALVINGS):
        x = 0.5 * (low + high)
        if ((_bend(c, x) if of_bend else _slope(c, x)) < 0.0) == rising:
            low = x
        else:
            high = x
    return 0.5 * (low + high)
