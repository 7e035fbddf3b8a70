"""Taylor series of a single body and of the ground under it, and roots of the motion.

``x_{k+2} = (A_k - g_k) / ((k + 1) (k + 2))``: A_k needs ``-K x_k - C (k + 1) x_{k+1}``
alone while z is linear in u or constant, and convolutions on the curved parts of
the backbone. The series ends where two terms in a row are below the tolerance. Its roots tell
where the body turns, and what it reaches before.

The coefficients of the ground are ``g[k] even`` and ``g[k] odd``: for a single sinusoid, a
record between samples and no motion, even and odd are the acceleration and its rate, and g stays
the same for the whole piece.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.forcing import (
    CurrentPiece,
    ground_acceleration,
    ground_taylor,
    next_sample,
    sample_time,
)
from eventpound.motion.parametric import ZERO_OF_PHASE
from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import first_root, only_root
from eventpound.numerics.power_series import integer_power
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.sdof.body import ROOM, SdofBody, tangent
from eventpound.solvers.fast.search import stays_above
from eventpound.tolerances import RETRIED, SAME_SAMPLE

INVERSE = np.array([0.0] + [1.0 / k for k in range(1, ROOM)])
"""1/k."""
INVERSE_PAIRS = np.array([1.0 / ((k + 1) * (k + 2)) for k in range(ROOM)])
"""1/((k + 1)(k + 2))."""
NUMBER = np.arange(float(ROOM))
"""k, which would have to be converted."""
SAFETY = 0.95
"""Part of the length at which the last terms reach the tolerance."""


@compiled
def linear_series(stiffness: float, most: int, body: SdofBody) -> tuple[int, bool]:
    """Coefficients 3 ... p of a linear oscillator; p, and whether the step is good.

    x_1 and x_2 stand. p is even, at most `most`.
    """
    h, damping, even, odd = body.step, body.damping, body.even, body.odd
    of_u, of_v = body.of_u, body.of_v * h
    first, second = body.x[1], body.x[2]
    square = h * h
    power = square
    order, good = 2, False
    for i in range((most - 2) // 2):
        k = 2 * i + 1
        per, per_next = INVERSE_PAIRS[k], INVERSE_PAIRS[k + 1]
        # One product and one sum are waited for from term to term.
        known = body.ground[k] * odd * per
        third = first * (-stiffness * per) - known - second * (damping * NUMBER[k + 1] * per)
        known = body.ground[k + 1] * even * per_next
        fourth = (second * (-stiffness * per_next) - known) - third * (
            damping * NUMBER[k + 2] * per_next
        )
        body.x[k + 2] = third
        body.x[k + 3] = fourth
        first, second = third, fourth
        order = k + 3
        last = power * max(abs(third) * h, abs(fourth) * square)
        power *= square
        # A term x_k h^k of u is k x_k h^(k-1) in v; `of_v` has the h that is missing.
        if last <= of_u and NUMBER[order] * last <= of_v:
            good = True
            break
    # Bounds of roots may read two coefficients beyond the last.
    body.x[order + 1] = body.x[order + 2] = 0.0
    return order, good


@compiled_noinline
def curved_series(kappa: float, most: int, body: SdofBody) -> int:
    """The same on a curved part, where ``z' = ξ' (1 - κ P)``, ``P = |z|^n``; z is ``σ y``.

    P comes from ``n z' P = z P'``. The first terms are written out: k is a constant there, whose
    loops are short, and that is 4 to 7 parts in a hundred of a run. Returned is p, negative where
    the step is not good.
    """
    h, z, n = body.step, body.z, body.exponent
    body.z_terms[0] = z
    body.power[0] = integer_power(abs(z), n)
    body.speed[0] = body.per_scale * body.x[1]
    body.reach, body.term = h * h, np.inf
    over = 1.0 / z
    lift = n * body.power[0] * over
    order = (
        _term(0, kappa, over, lift, most, body)
        or _term(1, kappa, over, lift, most, body)
        or _term(2, kappa, over, lift, most, body)
        or _term(3, kappa, over, lift, most, body)
        or _term(4, kappa, over, lift, most, body)
        or _term(5, kappa, over, lift, most, body)
    )
    k = 6
    while order == 0:
        order = _term(k, kappa, over, lift, most, body)
        k += 1
    body.x[abs(order) + 1] = body.x[abs(order) + 2] = 0.0
    return order


@compiled
def _term(k: int, kappa: float, over: float, lift: float, most: int, body: SdofBody) -> int:
    """P_k, z_{k+1} and x_{k+3}; the order if it is the last one, negative if not small, else 0.

    The newest factors come last in every sum, for they are waited for.
    """
    through = body.speed[k] * body.power[0]
    slope = -kappa * INVERSE[k + 1] * body.speed[0]
    z = (body.speed[0] * INVERSE[k + 1]) * (1.0 - kappa * body.power[0])
    if k > 0:
        low, high, low_z, high_z = 0.0, 0.0, 0.0, 0.0
        for i in range(k // 2, 0, -1):
            low += body.speed[i] * body.power[k - i]
            low_z += (body.weighted[i] - k * body.z_terms[i]) * body.power[k - i]
        for i in range(k // 2 + 1, k):
            high += body.speed[i] * body.power[k - i]
            high_z += (body.weighted[i] - k * body.z_terms[i]) * body.power[k - i]
        body.power[k] = (low_z + high_z) * (over * INVERSE[k]) + lift * body.z_terms[k]
        rest = (body.speed[k] - kappa * (through + (low + high))) * INVERSE[k + 1]
        z = rest + slope * body.power[k]
    body.z_terms[k + 1] = z
    body.weighted[k + 1] = (body.exponent + 1.0) * (k + 1) * z
    x = (
        -body.stiffness * body.x[k + 1]
        - body.damping * (k + 2) * body.x[k + 2]
        # Coefficient k + 1 of the ground is an odd one where k is even.
        - body.ground[k + 1] * (body.odd if k & 1 == 0 else body.even)
        - body.strength * z
    ) * INVERSE_PAIRS[k + 1]
    body.x[k + 3] = x
    body.speed[k + 1] = body.per_scale * (k + 2) * body.x[k + 2]
    # h^(k+3), from the h² that stands at the beginning.
    reach = body.reach * body.step
    last = abs(x) * reach
    worse = max(last, body.term)
    body.reach, body.term = reach, last
    # Two in a row, since one may be zero by chance.
    if worse <= body.of_u and (k + 3) * worse <= body.of_v * body.step:
        return k + 3
    return -(k + 3) if k + 3 >= most else 0


@compiled
def shorter(order: int, body: SdofBody) -> float:
    """Length at which the last two terms are within the tolerance (s), at most that of the step."""
    h = body.step
    power = h
    for _ in range(order - 2):
        power *= h
    # In u, and k times over h as much in v.
    most = max(1.0 / body.of_u, order / (body.of_v * h))
    before, last = abs(body.x[order - 1]) * power, abs(body.x[order]) * power * h
    # The larger in size decides; one that decides by its lower power only errs by little more.
    error, k = (before, order - 2) if before > last else (last, order - 1)
    error *= most
    if error <= 1.0:
        return h
    return h * SAFETY * math.exp(-math.log(error) * INVERSE[k]) if error < np.inf else RETRIED * h


@compiled
def swing(tau: float, body: SdofBody) -> tuple[float, float]:
    """Change of displacement (m) and velocity (m/s) after tau (s) of a body that swings freely."""
    k = tangent(body)
    omega = math.sqrt(k)
    y, r = -body.a / k, body.v / omega
    half, sine = math.sin(0.5 * omega * tau), math.sin(omega * tau)
    # 1 - cos ωτ without cancellation.
    square = 2.0 * half * half
    return r * sine - y * square, omega * (r * (1.0 - square) - y * sine)


_ZERO, _SINUSOIDS, _SAMPLES = int(Family.ZERO), int(Family.SINUSOIDS), int(Family.SAMPLES)


@compiled_noinline
def know_piece(i: int, piece: CurrentPiece, body: SdofBody) -> None:
    """Fill g for a piece where it is the same throughout."""
    family, coefficients = piece.family, piece.coefficients
    body.piece_known = i + 1
    alone = family == _SINUSOIDS and coefficients.size == 4
    body.pair = family in (_ZERO, _SAMPLES) or alone
    if not body.pair:
        return
    g = body.ground
    g[:] = 0.0
    g[0] = g[1] = 1.0
    if family == _SINUSOIDS:
        square = coefficients[2] * coefficients[2]
        for k in range(ROOM - 2):
            # a'' = -w² a.
            g[k + 2] = -square * g[k] * INVERSE_PAIRS[k]
        cosine, sine = math.cos(coefficients[3]), math.sin(coefficients[3])
        # In floating point the cosine of π/2 is 6e-17: a pulse would begin with a jump.
        body.cosine = cosine if abs(cosine) >= ZERO_OF_PHASE else 0.0
        body.sine = sine if abs(sine) >= ZERO_OF_PHASE else 0.0


@compiled
def pair_at(t: float, piece: CurrentPiece, body: SdofBody) -> tuple[float, float]:
    """Acceleration (m/s²) and its rate at t (s), a record's on the line after its `segment`."""
    coefficients, samples, segment = piece.coefficients, piece.samples, body.segment
    if piece.family == _SAMPLES:
        dt = coefficients[1]
        rate = (samples[segment + 1] - samples[segment]) / dt
        return samples[segment] + rate * (t - sample_time(coefficients[0], dt, segment)), rate
    if piece.family == _SINUSOIDS:
        frequency = coefficients[2]
        angle = frequency * (t - coefficients[0])
        c, s = math.cos(angle), math.sin(angle)
        cosine = c * body.cosine - s * body.sine
        sine = s * body.cosine + c * body.sine
        return coefficients[1] * cosine, -coefficients[1] * frequency * sine
    return 0.0, 0.0


@compiled_noinline
def expand_ground(t: float, order: int, piece: CurrentPiece, g: Floats) -> float:
    """Fill g at t (s) for the other motions, for which even and odd are 1; the acceleration."""
    ground_taylor(piece, t, order, g)
    return float(g[0])


@compiled_noinline
def other_acceleration(t: float, piece: CurrentPiece) -> float:
    """Acceleration of the other motions (m/s²)."""
    return float(ground_acceleration(piece, t))


@compiled
def sample_after(t: float, piece_end: float, piece: CurrentPiece) -> tuple[float, int]:
    """Next sample of a record after t (s), or the end of the piece; the sample before."""
    coefficients, samples = piece.coefficients, piece.samples
    stop = next_sample(coefficients, t, piece_end)
    origin, dt = coefficients[0], coefficients[1]
    # Half a step back from a sample lies the middle of its segment, whatever rounding does.
    segment = math.floor((stop - origin) / dt - 0.5)
    # The end of a piece is no sample: the segment is that of the start.
    if stop == piece_end:
        segment = math.floor((t - origin) / dt + SAME_SAMPLE)
    return stop, min(max(segment, 0), samples.size - 2)


@compiled
def first_turn(order: int, first: int, h: float, body: SdofBody, work: Floats) -> float:
    """Time in (0, h] at which the velocity changes its sign, or inf.

    x[first] is the lowest coefficient, from 1 on, that differs from zero.
    """
    sign = 1.0 if body.x[first] > 0.0 else -1.0
    degree = max(order - first, 2)
    rest = 0.0
    for k in range(degree, 2, -1):
        rest = rest * h + NUMBER[first + k] * abs(body.x[first + k])
    slope = sign * NUMBER[first + 1] * body.x[first + 1]
    bend = sign * NUMBER[first + 2] * body.x[first + 2]
    start = sign * NUMBER[first] * body.x[first]
    if stays_above(start, slope, bend, rest * h * h * h, h):
        return np.inf
    return _located_turn(sign, degree, first, h, body, work)


@compiled_noinline
def _located_turn(
    sign: float, degree: int, first: int, h: float, body: SdofBody, work: Floats
) -> float:
    c, swing = body.work[:], 0.0
    for k in range(degree, -1, -1):
        c[k] = sign * NUMBER[first + k] * body.x[first + k]
        if k > 2:
            swing = swing * h + NUMBER[k] * abs(c[k])
    # Its slope stays below zero, so there is one root at most.
    if max(c[1], c[1] + 2.0 * c[2] * h) + swing * h * h < 0.0:
        return only_root(c, degree + 1, h)
    return first_root(c, degree + 1, h, work)


@compiled
def first_reached(
    distance: float, sign: float, order: int, h: float, body: SdofBody, work: Floats
) -> float:
    """Time in (0, h] at which the motion has gone `distance` (m) in the direction `sign`, or inf.

    From a distance of zero, the time at which it is there again.
    """
    first = 0
    if distance == 0.0:
        first = 1
        while first <= order and body.x[first] == 0.0:
            first += 1
        if first > order:
            return np.inf
        # It sets out that way, and so is there.
        if sign * body.x[first] > 0.0:
            return 0.0
    degree = max(order - first, 2)
    rest = 0.0
    for k in range(degree, 2, -1):
        rest = rest * h + abs(body.x[first + k])
    start = distance if first == 0 else -sign * body.x[first]
    slope, bend = -sign * body.x[first + 1], -sign * body.x[first + 2]
    if stays_above(start, slope, bend, rest * h * h * h, h):
        return np.inf
    _put_distance(distance, sign, order, body)
    return first_root(body.work[:], order + 1, h, work)


@compiled
def _put_distance(distance: float, sign: float, order: int, body: SdofBody) -> None:
    """The distance (m) still to go in the direction `sign`, a polynomial, into `work`."""
    body.work[0] = distance
    for k in range(1, order + 1):
        body.work[k] = -sign * body.x[k]


@compiled_noinline
def crossing(distance: float, sign: float, order: int, h: float, body: SdofBody) -> float:
    """The same where the motion goes one way throughout, and further than that within h."""
    _put_distance(distance, sign, order, body)
    return min(only_root(body.work[:], order + 1, h), h)
