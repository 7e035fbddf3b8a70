"""Ricker wavelets: the second and third derivative of a Gaussian.

With tau = t - center (s), a_p in m/s^2 and T_p in s, for all t:

    symmetric       a = a_p (1 - 2 x^2) exp(-x^2),               x = pi tau / T_p
    antisymmetric   a = (a_p / B) (x^2 - 3) x exp(-x^2 / 2),     x = 2 pi tau / (sqrt(3) T_p)

B = sqrt(6) sqrt(3 - sqrt(6)) exp(-(3 - sqrt(6)) / 2) = 1.3801 is the peak of
|(x^2 - 3) x exp(-x^2 / 2)|, which lies where x^4 - 6 x^2 + 3 = 0. Both
spectra have their maximum at 2 pi / T_p. Ground velocity V and displacement D
that vanish at t = -inf are

    symmetric       V = a_p tau exp(-x^2),                D = -a_p T_p^2 / (2 pi^2) exp(-x^2)
    antisymmetric   V = (a_p l / B) (1 - x^2) exp(-x^2/2), D = (a_p l^2 / B) x exp(-x^2/2)

with l = sqrt(3) T_p / (2 pi). Nothing is cut off at `start`, so there is no
jump; but ground velocity and displacement are counted from there:
v = V(t) - V(start), d = D(t) - D(start) - V(start) (t - start).

Sources: N. Ricker, Bulletin of the Seismological Society of America 33 (1943),
197-228; M. F. Vassiliou and N. Makris, Bulletin of the Seismological Society
of America 101(2) (2011), 596-618.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Annotated, ClassVar

import numpy as np

from eventpound.basics.given import OptionalNumber, converting_base, default
from eventpound.motion.base import Family, Piece
from eventpound.motion.parametric import Parametric, require_finite
from eventpound.numerics.arrays import Floats
from eventpound.units import Dimension

_PEAK = math.sqrt(6.0 * (3.0 - math.sqrt(6.0))) * math.exp(-0.5 * (3.0 - math.sqrt(6.0)))


@converting_base()
class _Wavelet(Parametric, ABC):
    """A cubic times a Gaussian, for all times.

    Parameters
    ----------
    amplitude, period, reverse, start
        As for `Parametric`.
    center : float, optional
        Time of the middle of the wavelet (s); None: `LEAD` periods after `start`.
    """

    center: Annotated[OptionalNumber, Dimension.TIME, require_finite] = default(None)

    LEAD: ClassVar[float]
    """Periods from `start` to the default center."""
    TAIL: ClassVar[float]
    """Periods after the center beyond which |a| < 1e-15 a_p."""

    @property
    def middle(self) -> float:
        """The center, given or by default (s)."""
        return self.start + self.LEAD * self.period if self.center is None else self.center

    @property
    def end(self) -> float:
        """Time after which |a| stays below 1e-15 a_p (s); the piece itself has no end."""
        return self.middle + self.TAIL * self.period

    @property
    @abstractmethod
    def decay(self) -> float:
        """The rate q in exp(-q tau^2) (1/s^2)."""

    @abstractmethod
    def cubic(self) -> tuple[float, float, float, float]:
        """c_0 ... c_3 of the polynomial in tau (m/s^2 ... m/s^5)."""

    @abstractmethod
    def integrals(self, tau: Floats) -> tuple[Floats, Floats]:
        """V and D (m/s, m) at tau (s), shape of `tau`."""

    def pieces(self) -> list[Piece]:
        """One piece, from -inf to inf."""
        numbers = np.array([self.middle, self.decay, *self.cubic()])
        return [Piece(-math.inf, math.inf, Family.GAUSSIAN, numbers)]

    def acceleration(self, t: Floats) -> Floats:
        """Ground acceleration, shape of `t` (m/s^2)."""
        tau = np.asarray(t, dtype=float) - self.middle
        c_0, c_1, c_2, c_3 = self.cubic()
        return (c_0 + tau * (c_1 + tau * (c_2 + tau * c_3))) * np.exp(-self.decay * tau**2)

    def velocity(self, t: Floats) -> Floats:
        """Ground velocity counted from `start`, shape of `t` (m/s)."""
        v, _ = self.integrals(np.asarray(t, dtype=float) - self.middle)
        v_start, _ = self.integrals(np.asarray(self.start - self.middle))
        return v - v_start

    def displacement(self, t: Floats) -> Floats:
        """Ground displacement counted from `start`, shape of `t` (m)."""
        t = np.asarray(t, dtype=float)
        _, d = self.integrals(t - self.middle)
        v_start, d_start = self.integrals(np.asarray(self.start - self.middle))
        return d - d_start - v_start * (t - self.start)


@converting_base()
class Ricker(_Wavelet):
    """Symmetric Ricker wavelet, a_p at its center.

    The default center is `start` + T_p; there, at the start, the acceleration
    is (1 - 2 pi^2) exp(-pi^2) a_p = -9.7e-4 a_p.

    Parameters
    ----------
    amplitude, period, reverse, start
        As for `Parametric`.
    center : float, optional
        Time of the peak (s).

    Raises
    ------
    InputError
        Also for a `center` that is not finite.
    """

    LEAD: ClassVar[float] = 1.0
    TAIL: ClassVar[float] = 2.0

    kind: ClassVar[str] = "ricker"
    """The word a case names it by."""

    @property
    def decay(self) -> float:
        """The rate q = pi^2 / T_p^2 (1/s^2)."""
        return (math.pi / self.period) ** 2

    def cubic(self) -> tuple[float, float, float, float]:
        """a_p (1 - 2 q tau^2)."""
        return (self.signed_amplitude, 0.0, -2.0 * self.decay * self.signed_amplitude, 0.0)

    def integrals(self, tau: Floats) -> tuple[Floats, Floats]:
        """V = a_p tau exp(-q tau^2), D = -a_p / (2 q) exp(-q tau^2)."""
        gaussian = self.signed_amplitude * np.exp(-self.decay * tau**2)
        return tau * gaussian, -0.5 / self.decay * gaussian


@converting_base()
class AntisymmetricRicker(_Wavelet):
    """Antisymmetric Ricker wavelet, its first large peak positive.

    The peaks a_p and -a_p lie sqrt(3 - sqrt(6)) l = 0.2045 T_p before and
    after the center. It is wider than the symmetric one, so the default center
    is `start` + 3/2 T_p; there, at the start, the acceleration is -3.9e-5 a_p.

    Parameters
    ----------
    amplitude, period, reverse, start
        As for `Parametric`.
    center : float, optional
        Time at which the wavelet changes sign in its middle (s).

    Raises
    ------
    InputError
        Also for a `center` that is not finite.
    """

    LEAD: ClassVar[float] = 1.5
    TAIL: ClassVar[float] = 2.5

    kind: ClassVar[str] = "antisymmetric-ricker"
    """The word a case names it by."""

    @property
    def width(self) -> float:
        """The length l = sqrt(3) T_p / (2 pi) (s)."""
        return math.sqrt(3.0) / self.omega

    @property
    def decay(self) -> float:
        """The rate q = 1 / (2 l^2) (1/s^2)."""
        return 0.5 / self.width**2

    def cubic(self) -> tuple[float, float, float, float]:
        """a_p / B (x^3 - 3 x), x = tau / l."""
        a = self.signed_amplitude / _PEAK
        return (0.0, -3.0 * a / self.width, 0.0, a / self.width**3)

    def integrals(self, tau: Floats) -> tuple[Floats, Floats]:
        """V = a_p l / B (1 - x^2) exp(-x^2/2), D = a_p l^2 / B x exp(-x^2/2)."""
        x = tau / self.width
        gaussian = self.signed_amplitude * self.width / _PEAK * np.exp(-0.5 * x**2)
        return (1.0 - x**2) * gaussian, self.width * x * gaussian
