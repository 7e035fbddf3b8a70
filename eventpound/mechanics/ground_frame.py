"""A moving frame in which the forcing of a sampled record is smoother.

With ``X = u + s(t)`` and ``s'' = ã``, the equation ``u'' = f/m - a_g`` becomes
``X'' = f/m + (ã - a_g)``. For ã equal to a_g but for a smooth part, the kinks of
the record at its samples no longer stand in X'' but reach it through u and u'
only, two orders smoother. ã is a_g less a straight line in time, chosen so
that s stays near zero: the drift of an uncorrected record is left out of it.
"""

from __future__ import annotations

import numpy as np

from eventpound.motion.base import Piece
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import kernel

NO_FRAME = np.zeros((4, 0))
"""Coordinates relative to the ground."""


def moving_frame(piece: Piece) -> Floats:
    """The frame of a sampled piece.

    Parameters
    ----------
    piece : Piece
        Of the family SAMPLES, n samples.

    Returns
    -------
    ndarray, shape (4, n)
        Times (s), ã (m/s²), s' (m/s) and s (m) at the samples; linear,
        quadratic and cubic between them.
    """
    start, dt = piece.coefficients
    a = piece.samples
    t = dt * np.arange(a.size)
    v = np.concatenate(([0.0], np.cumsum(0.5 * dt * (a[:-1] + a[1:]))))
    d = np.concatenate(([0.0], np.cumsum(dt * v[:-1] + dt * dt * (2.0 * a[:-1] + a[1:]) / 6.0)))
    end = max(t[-1], dt)
    x = t / end
    basis = np.column_stack((x, x**2 / 2.0, x**3 / 6.0))
    c, *_ = np.linalg.lstsq(basis, d, rcond=None)
    trend_a = (c[1] + c[2] * x) / end**2
    trend_v = (c[0] + c[1] * x + c[2] * x**2 / 2.0) / end
    return np.ascontiguousarray(np.vstack((start + t, a - trend_a, v - trend_v, d - basis @ c)))


@kernel
def frame_motion(frame: Floats, t: float) -> tuple[float, float, float]:
    """The position s (m), s' (m/s) and s'' (m/s²) of the frame at one time."""
    times = frame[0]
    dt = times[1] - times[0]
    # Beyond the samples the first and the last cubic go on.
    i = min(max(int((t - times[0]) / dt), 0), times.size - 2)
    h = t - times[i]
    slope = (frame[1, i + 1] - frame[1, i]) / dt
    a = frame[1, i] + slope * h
    v = frame[2, i] + h * (frame[1, i] + h * slope / 2.0)
    s = frame[3, i] + h * (frame[2, i] + h * (frame[1, i] / 2.0 + h * slope / 6.0))
    return s, v, a


@kernel
def to_frame(frame: Floats, t: float, sign: float, iq: Ints, iv: Ints, y: Floats) -> None:
    """Add (sign +1) or take away (-1) the motion of the frame, in place."""
    if frame.shape[1] == 0:
        return
    s, v, _ = frame_motion(frame, t)
    for c in range(iq.size):
        y[iq[c]] += sign * s
        y[iv[c]] += sign * v
