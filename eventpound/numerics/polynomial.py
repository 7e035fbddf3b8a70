"""First positive root of a polynomial whose scale may be anything.

With the Bernstein coefficients on ``[0, l]``

    b_i = Σ_k C(i, k) / C(p, k) c_k l^k,    Σ c_k x^k = Σ b_i B_i(x / l),

a polynomial has at most as many roots inside as they change sign (Descartes'
rule in Bernstein form: G. Farin, Curves and Surfaces for CAGD, section 4), so
stretches without a change are passed over and the others divided.

Errors are told in the rounding of a value, ``EPS Σ |c_k| x^k``, at whatever scale of x and of c:

* where a root is found, the polynomial is zero to within two of these units;
* before it, or up to the end where none is found, it is nowhere below zero by more than that: of
  two crossings only those may be passed over between which it dips no deeper.

So the root itself errs by the value's error over the slope there: by rounding where it is simple,
by the square root of it where it is double.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import BESIDE_ONE

LARGEST_DEGREE = 40
INVERSE_BINOMIAL = np.array(
    [
        [1.0 / math.comb(p, k) if k <= p else 0.0 for k in range(LARGEST_DEGREE + 1)]
        for p in range(LARGEST_DEGREE + 1)
    ]
)
NEARLY_ALL = 0.25
"""Part of the interval from which on the leading quadratic sets no scale of its own."""
WORK_ROWS = 49
"""Rows of the scratch array: one for each halving of a stretch, and one."""
MOST_CURVATURE = 0.25
"""β of `falling_root` from which on it halves the bracket."""
NARROWEST = 2.0**-48
"""Part of the interval below which a stretch with a positive end counts as clear: a dip
inside would be shallower than rounding."""


@scalar_kernel
def value_and_slope(c: Floats, x: float) -> tuple[float, float]:
    """Value and derivative of ``Σ c_k x^k`` by Horner's rule."""
    value, slope = c[c.size - 1], 0.0
    for k in range(c.size - 2, -1, -1):
        slope = slope * x + value
        value = value * x + c[k]
    return value, slope


@scalar_kernel
def _quadratic_root(c0: float, c1: float, c2: float) -> float:
    """Smallest positive root of ``c0 + c1 x + c2 x²`` with ``c0 > 0``, or inf."""
    discriminant = c1 * c1 - 4.0 * c0 * c2
    if discriminant < 0.0:
        return np.inf
    root = np.sqrt(discriminant)
    # Either form adds numbers of one sign, where the other would cancel.
    if c1 < 0.0:
        return 2.0 * c0 / (root - c1)
    return -(c1 + root) / (2.0 * c2) if c2 < 0.0 else np.inf


@scalar_kernel
def _bernstein(c: Floats, start: int, size: int, limit: float, b: Floats) -> None:
    """Bernstein coefficients on ``[0, limit]`` of ``Σ c_{start+k} x^k`` into `b`."""
    degree = size - start - 1
    power = 1.0
    b[0] = c[start]
    for k in range(1, degree + 1):
        power *= limit
        b[k] = c[start + k] * (power * INVERSE_BINOMIAL[degree, k])
    # Pascal's triangle in place gives the sums over C(i, k), without a table of it.
    for k in range(1, degree + 1):
        for i in range(degree, k - 1, -1):
            b[i] += b[i - 1]


@scalar_kernel
def _halve(b: Floats, left: Floats, size: int) -> None:
    """De Casteljau's division: the left half goes to `left`, the right one stays in b."""
    for k in range(size):
        left[k] = b[0]
        for i in range(size - 1 - k):
            b[i] = 0.5 * (b[i] + b[i + 1])


@scalar_kernel
def _first_bracket(work: Floats, size: int) -> tuple[float, float, float]:
    """First part of [0, 1] at whose end a polynomial has just become negative, or infs.

    Its Bernstein coefficients stand in the first row of `work`, whose other
    rows take the parts still to be looked at; the last column holds their widths. Returned are
    the ends of the part, and where the chord of the values there is zero.
    """
    widths = work[:, work.shape[1] - 1]
    widths[0] = 1.0
    top, start = 0, 0.0
    while top >= 0:
        part, width = work[top], widths[top]
        changes = 0
        for i in range(size - 1):
            changes += (part[i] < 0.0) != (part[i + 1] < 0.0)
        deepest = top == work.shape[0] - 1 or width <= NARROWEST
        last = part[size - 1]
        if last < 0.0 and (changes == 1 or deepest):
            # A start below zero is so by rounding: the chord begins at zero.
            return start, start + width, start + width * max(part[0], 0.0) / (part[0] - last)
        if changes == 0 or deepest:
            start += width
            top -= 1
            continue
        # The left half lies on top, so that parts come from the left to the right.
        widths[top] = widths[top + 1] = 0.5 * width
        _halve(part, work[top + 1], size)
        top += 1
    return np.inf, np.inf, np.inf


@scalar_kernel
def falling_root(c: Floats, start: int, size: int, low: float, high: float, guess: float) -> float:
    """Root of ``Σ c_{start+k} x^k`` between points above and below zero: Halley's, in the bracket.

    Near a root a step leaves an error like the cube of the one before. So what is left after two
    steps in a row, s and then d, is of the order of ``d (d/s)³``, and of ``d β²`` by the
    curvature, ``β = f f'' / (2 f'²)``; where both are rounding, the root stands. Where β is
    large, as between two roots that all but meet, a step would lead to the extreme between them.
    """
    x, before = guess, high - low
    for _ in range(1100):
        value, slope, bend = c[size - 1], 0.0, 0.0
        for k in range(size - 2, start - 1, -1):
            bend = bend * x + slope
            slope = slope * x + value
            value = value * x + c[k]
        if value < 0.0:
            high = x
        else:
            low = x
        beta = (value / slope) * (bend / slope) if slope < 0.0 else MOST_CURVATURE
        # `low` is not inside the bracket, which is halved then.
        following = x - value / (slope * (1.0 - beta)) if abs(beta) < MOST_CURVATURE else low
        if not low < following < high:
            following = 0.5 * (low + high)
            if value == 0.0 or not low < following < high:
                return x if value == 0.0 else following
            # What halving leaves tells nothing of the order of convergence.
            x, before = following, high - low
            continue
        step = abs(following - x)
        if step * max((step / before) ** 3, beta * beta) <= BESIDE_ONE * x:
            return following
        x, before = following, step
    return high


@scalar_kernel
def only_root(c: Floats, size: int, limit: float) -> float:
    """Root in (0, limit] of ``Σ c_k x^k``, which is above zero at 0 and has at most one; or inf."""
    end = c[size - 1]
    for k in range(size - 2, -1, -1):
        end = end * limit + c[k]
    if end > 0.0:
        return np.inf
    # Where the quadratic with the value and slope at the start, and the value at the end, is zero.
    bend = (end - c[0] - c[1] * limit) / (limit * limit)
    x = 2.0 * c[0] / (np.sqrt(c[1] * c[1] - 4.0 * bend * c[0]) - c[1])
    return falling_root(c, 0, size, 0.0, limit, x if 0.0 < x < limit else 0.5 * limit)


@kernel
def root_work(size: int) -> Floats:
    """Scratch array for the roots of polynomials of up to `size` coefficients."""
    return np.empty((WORK_ROWS, size + 1))


@scalar_kernel
def first_root(c: Floats, size: int, limit: float, work: Floats) -> float:
    """Smallest x in (0, limit] at which a polynomial falls below zero.

    Roots at zero itself are divided out first, so a gap that has just opened
    is followed to its next closing however soon that is.

    Parameters
    ----------
    c : ndarray, shape (size,) or longer
        Coefficients of ``Σ c_k x^k``, the first that differs from zero positive.
    size : int
        Number of coefficients, at most `LARGEST_DEGREE` + 1.
    limit : float
        End of the search, positive.
    work : ndarray
        Of `root_work` for `size` or more; overwritten.

    Returns
    -------
    float
        The root, or inf. It is looked for first within twice that of the
        leading quadratic, which sets the scale, then in the whole interval.
    """
    start = 0
    while start < size and c[start] == 0.0:
        start += 1
    if size - start < 2:
        return np.inf
    near = 2.0 * _quadratic_root(c[start], c[start + 1], c[start + 2] if size - start > 2 else 0.0)
    for turn in range(2):
        # Nearly the whole interval is searched just as well at once.
        if turn == 0 and near > NEARLY_ALL * limit:
            continue
        end = near if turn == 0 else limit
        _bernstein(c, start, size, end, work[0])
        low, high, guess = _first_bracket(work, size - start)
        if high < np.inf:
            return falling_root(c, start, size, end * low, end * high, end * guess)
    return np.inf
