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

from eventpound.mechanics.backbone import integer_power
from eventpound.motion.base import Family
from eventpound.motion.forcing import ground_acceleration, ground_taylor, next_sample, sample_time
from eventpound.motion.parametric import ZERO_OF_PHASE
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.run import Piece
from eventpound.solvers.fast.search import stays_above
from eventpound.solvers.fast.single.body import ROOM, Body, tangent
from eventpound.tolerances import CUBIC, ITERATED, RETRIED, SAME_SAMPLE

INVERSE = np.array([0.0] + [1.0 / k for k in range(1, ROOM)])
"""1/k."""
INVERSE_PAIRS = np.array([1.0 / ((k + 1) * (k + 2)) for k in range(ROOM)])
"""1/((k + 1)(k + 2))."""
NUMBER = np.arange(float(ROOM))
"""k, which would have to be converted."""
SAFETY = 0.95
"""Part of the length at which the last terms reach the tolerance."""


@compiled
def linear_series(stiffness: float, most: int, body: Body) -> tuple[int, bool]:
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
        if last <= of_u and NUMBER[order] * last <= of_v:
            good = True
            break
    body.x[order + 1] = body.x[order + 2] = 0.0
    return order, good


@compiled_apart
def curved_series(kappa: float, most: int, body: Body) -> int:
    """The same on a curved part, where ``z' = ξ' (1 - κ P)``, ``P = |z|^n``; z is ``σ y``.

    P comes from ``n z' P = z P'``. Each term is written out, for k is a constant.
    Returned is p, negative where the step is not good.
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
        or _term(6, kappa, over, lift, most, body)
        or _term(7, kappa, over, lift, most, body)
        or _term(8, kappa, over, lift, most, body)
        or _term(9, kappa, over, lift, most, body)
        or _term(10, kappa, over, lift, most, body)
        or _term(11, kappa, over, lift, most, body)
        or _term(12, kappa, over, lift, most, body)
        or _term(13, kappa, over, lift, most, body)
        or _term(14, kappa, over, lift, most, body)
        or _term(15, kappa, over, lift, most, body)
        or _term(16, kappa, over, lift, most, body)
        or _term(17, kappa, over, lift, most, body)
        or _term(18, kappa, over, lift, most, body)
        or _term(19, kappa, over, lift, most, body)
        or _term(20, kappa, over, lift, most, body)
        or _term(21, kappa, over, lift, most, body)
    )
    body.x[abs(order) + 1] = body.x[abs(order) + 2] = 0.0
    return order


@compiled
def _term(k: int, kappa: float, over: float, lift: float, most: int, body: Body) -> int:
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
        - body.ground[k + 1] * (body.odd if k & 1 == 0 else body.even)
        - body.strength * z
    ) * INVERSE_PAIRS[k + 1]
    body.x[k + 3] = x
    body.speed[k + 1] = body.per_scale * (k + 2) * body.x[k + 2]
    reach = body.reach * body.step
    last = abs(x) * reach
    worse = max(last, body.term)
    body.reach, body.term = reach, last
    if worse <= body.of_u and (k + 3) * worse <= body.of_v * body.step:
        return k + 3
    return -(k + 3) if k + 3 >= most else 0


@compiled
def shorter(order: int, body: Body) -> float:
    """Length at which the last two terms are within the tolerance (s), at most that of the step."""
    h = body.step
    power = h
    for _ in range(order - 2):
        power *= h
    most = max(1.0 / body.of_u, order / (body.of_v * h))
    before, last = abs(body.x[order - 1]) * power, abs(body.x[order]) * power * h
    # The larger in size decides; one that decides by its lower power only errs by little more.
    error, k = (before, order - 2) if before > last else (last, order - 1)
    error *= most
    if error <= 1.0:
        return h
    return h * SAFETY * math.exp(-math.log(error) * INVERSE[k]) if error < np.inf else RETRIED * h


@compiled
def motion(tau: float, order: int, body: Body) -> tuple[float, float, float]:
    """Change of displacement (m), velocity (m/s) and relative acceleration (m/s²) after tau (s)."""
    change, rate, bend = body.x[order], 0.0, 0.0
    for k in range(order - 1, 0, -1):
        bend = bend * tau + rate
        rate = rate * tau + change
        change = change * tau + body.x[k]
    bend = bend * tau + rate
    rate = rate * tau + change
    return change * tau, rate, 2.0 * bend


@compiled
def swing(tau: float, body: Body) -> tuple[float, float]:
    """Change of displacement (m) and velocity (m/s) after tau (s) of a body that swings freely."""
    k = tangent(body)
    omega = math.sqrt(k)
    y, r = -body.a / k, body.v / omega
    half, sine = math.sin(0.5 * omega * tau), math.sin(omega * tau)
    square = 2.0 * half * half
    return r * sine - y * square, omega * (r * (1.0 - square) - y * sine)


_ZERO, _SINUSOIDS, _SAMPLES = int(Family.ZERO), int(Family.SINUSOIDS), int(Family.SAMPLES)


@compiled_apart
def know_piece(i: int, piece: Piece, body: Body) -> None:
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
            g[k + 2] = -square * g[k] * INVERSE_PAIRS[k]
        cosine, sine = math.cos(coefficients[3]), math.sin(coefficients[3])
        body.cosine = cosine if abs(cosine) >= ZERO_OF_PHASE else 0.0
        body.sine = sine if abs(sine) >= ZERO_OF_PHASE else 0.0


@compiled
def pair_at(t: float, piece: Piece, body: Body) -> tuple[float, float]:
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


@compiled_apart
def expand_ground(t: float, order: int, piece: Piece, g: Floats) -> float:
    """Fill g at t (s) for the other motions, for which even and odd are 1; the acceleration."""
    ground_taylor(piece, t, order, g)
    return float(g[0])


@compiled_apart
def other_acceleration(t: float, piece: Piece) -> float:
    """Acceleration of the other motions (m/s²)."""
    return float(ground_acceleration(piece, t))


@compiled
def sample_after(t: float, piece_end: float, piece: Piece) -> tuple[float, int]:
    """Next sample of a record after t (s), or the end of the piece; the sample before."""
    coefficients, samples = piece.coefficients, piece.samples
    stop = next_sample(coefficients, t, piece_end)
    origin, dt = coefficients[0], coefficients[1]
    segment = math.floor((stop - origin) / dt - 0.5)
    if stop == piece_end:
        segment = math.floor((t - origin) / dt + SAME_SAMPLE)
    return stop, min(max(segment, 0), samples.size - 2)


MOST_ITERATIONS = 200
"""Newton steps of a root; a few do but where two roots all but meet."""
BEYOND_GUESS = 1.25
"""How much later than a first guess a root is sure to have been passed."""


@compiled_apart
def first_zero(degree: int, bend: float, h: float, body: Body) -> float:
    """First zero in (0, h] of the polynomial in `work`, positive at zero, or inf.

    With a lower bound `bend` of the second derivative on [0, h],
    ``c_0 + c' s + bend s²/2`` lies below the polynomial, so its root is never
    past the zero wanted, to which it converges quadratically.
    """
    s, value, slope = 0.0, body.work[0], body.work[1]
    for _ in range(MOST_ITERATIONS):
        square = slope * slope - 2.0 * bend * value
        if square < 0.0:
            return np.inf
        root = math.sqrt(square)
        if slope < 0.0:
            change = 2.0 * value / (root - slope)
        elif bend < 0.0:
            change = -(slope + root) / bend
        else:
            return np.inf
        s += change
        if not s < h:
            s = h
        elif change <= ITERATED * s:
            return s
        value, slope = body.work[degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope = slope * s + value
            value = value * s + body.work[k]
        if value <= 0.0:
            return s
        if s == h:
            return np.inf
    return s


@compiled_apart
def only_zero(degree: int, h: float, body: Body) -> float:
    """The zero in (0, h] of the polynomial in `work`, which falls throughout, or inf."""
    square = body.work[1] * body.work[1] - 4.0 * body.work[0] * body.work[2]
    s = 2.0 * body.work[0] / (math.sqrt(square) - body.work[1]) if square > 0.0 else h
    return _polished(min(s, h), degree, h, body)


@compiled
def _polished(s: float, degree: int, h: float, body: Body) -> float:
    """The same from a first guess s, where it falls at its only zero.

    Roots of the osculating parabolas, which converge cubically, kept in the bracket.
    """
    low, high = 0.0, h
    for _ in range(MOST_ITERATIONS):
        value, slope, bend = body.work[degree], 0.0, 0.0
        for k in range(degree - 1, -1, -1):
            bend = bend * s + slope
            slope = slope * s + value
            value = value * s + body.work[k]
        if value > 0.0:
            if s == h:
                return np.inf
            low = s
        else:
            high = s
        square = slope * slope - 4.0 * value * bend
        change = 2.0 * value / (math.sqrt(square) - slope) if square > 0.0 else np.inf
        following = s + change
        if following >= h and high == h and value > 0.0:
            following = h
        elif not low < following < high:
            if value == 0.0 or not low < 0.5 * (low + high) < high:
                return s
            following = 0.5 * (low + high)
        elif abs(change) <= CUBIC * s:
            return following
        s = following
    return s


@compiled
def first_turn(order: int, first: int, h: float, body: Body) -> float:
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
    return _located_turn(sign, degree, first, h, body)


@compiled_apart
def _located_turn(sign: float, degree: int, first: int, h: float, body: Body) -> float:
    for k in range(degree, -1, -1):
        body.work[k] = sign * NUMBER[first + k] * body.x[first + k]
    h = _nearer(degree, h, body)
    swing, curve = 0.0, 0.0
    for k in range(degree, 2, -1):
        term = NUMBER[k] * abs(body.work[k])
        swing = swing * h + term
        curve = curve * h + NUMBER[k - 1] * term
    slope, bend = body.work[1], 2.0 * body.work[2]
    if max(slope, slope + bend * h) + swing * h * h < 0.0:
        return only_zero(degree, h, body)
    return first_zero(degree, bend - curve * h, h, body)


@compiled
def _nearer(degree: int, h: float, body: Body) -> float:
    """A time up to h (s) before which the polynomial in `work` has a zero, or h.

    Bounds over a shorter time are better ones.
    """
    square = body.work[1] * body.work[1] - 4.0 * body.work[0] * body.work[2]
    if square <= 0.0 or body.work[1] >= math.sqrt(square):
        return h
    s = BEYOND_GUESS * 2.0 * body.work[0] / (math.sqrt(square) - body.work[1])
    if not s < h:
        return h
    value = body.work[degree]
    for k in range(degree - 1, -1, -1):
        value = value * s + body.work[k]
    return s if value < 0.0 else h


@compiled
def first_reached(distance: float, sign: float, order: int, h: float, body: Body) -> float:
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
    return _located_reach(start, sign, degree, first, h, body)


@compiled_apart
def _located_reach(
    start: float, sign: float, degree: int, first: int, h: float, body: Body
) -> float:
    curve = 0.0
    for k in range(degree, 0, -1):
        c = -sign * body.x[first + k]
        body.work[k] = c
        if k > 2:
            curve = curve * h + NUMBER[k] * NUMBER[k - 1] * abs(c)
    body.work[0] = start
    return first_zero(degree, 2.0 * body.work[2] - curve * h, h, body)


@compiled_apart
def crossing(distance: float, sign: float, order: int, h: float, body: Body) -> float:
    """The same where the motion goes one way throughout, and further than that within h."""
    body.work[0] = distance
    for k in range(1, order + 1):
        body.work[k] = -sign * body.x[k]
    return min(_polished(h, order, h, body), h)
