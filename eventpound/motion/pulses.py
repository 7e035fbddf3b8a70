"""Pulses of one sinusoid: sine, cosine and the type-C_n pulse of Makris and Chang.

With omega_p = 2 pi / T_p (rad/s), s = t - start (s) and a_p in m/s^2:

    sine      a = a_p sin(omega_p s),            0 <= s <= T_p
    cosine    a = a_p cos(omega_p s),            0 <= s <= T_p
    type-C_n  a = a_p cos(omega_p s + phi),      0 <= s <= (n + 1/2 - phi/pi) T_p

The phase phi of type-C_n makes the ground end at rest where it started:

    cos[(2n+1) pi - phi] + [(2n+1) pi - 2 phi] sin(phi) - cos(phi) = 0

Source: N. Makris and S.-P. Chang, Effect of viscous, viscoplastic and friction
damping on the response of seismic isolated structures, Earthquake Engineering
and Structural Dynamics 29 (2000), 85-107.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, ClassVar

from eventpound.basics.given import Given, converting_base, default
from eventpound.errors import InputError
from eventpound.motion.parametric import Sinusoid, SinusoidMotion
from eventpound.units import Dimension

MOST_CYCLES = 1_000_000
"""Of a type-C_n pulse; more has no phase that a double could hold beside omega_p s."""


@converting_base()
class Sine(SinusoidMotion):
    """One period of a sine; leaves the ground displaced by a_p T_p^2 / (2 pi).

    Its numbers are those of `Parametric`.
    """

    kind: ClassVar[str] = "sine"
    """The word a case names it by."""

    @property
    def duration(self) -> float:
        """T_p (s)."""
        return self.period


@converting_base()
class Cosine(SinusoidMotion):
    """One period of a cosine; jumps to a_p at its start and from a_p at its end.

    Its numbers are those of `Parametric`.

    Examples
    --------
    >>> pulse = Cosine("2 m/s^2", "0.8 s")
    >>> float(pulse.acceleration(0.0)), float(pulse.acceleration(0.9))
    (2.0, 0.0)
    """

    kind: ClassVar[str] = "cosine"
    """The word a case names it by."""

    @property
    def duration(self) -> float:
        """T_p (s)."""
        return self.period

    def sinusoids(self) -> tuple[Sinusoid, ...]:
        """One cosine without phase."""
        return (Sinusoid(self.signed_amplitude, self.omega, 0.0),)


@converting_base()
class TypeC(SinusoidMotion):
    """Pulse of type C_n: n cycles of velocity, and the ground ends where it began.

    Parameters
    ----------
    amplitude, period, reverse, start
        As for `Parametric`.
    cycles : int
        n, from 1 to 1 000 000.

    Raises
    ------
    InputError
        Also for any other `cycles`.
    """

    cycles: Annotated[Given[int, int | str], Dimension.NUMBER] = default(1)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1 <= self.cycles <= MOST_CYCLES or self.cycles != math.floor(self.cycles):
            raise InputError(
                f"excitation 'type-c': cycles = {self.cycles!r}; a whole number from 1 to "
                f"{MOST_CYCLES} is needed"
            )

    kind: ClassVar[str] = "type-c"
    """The word a case names it by."""

    @property
    def phase(self) -> float:
        """The phase phi (rad)."""
        return type_c_phase(int(self.cycles))

    @property
    def duration(self) -> float:
        """(n + 1/2 - phi/pi) T_p (s)."""
        return (self.cycles + 0.5 - self.phase / math.pi) * self.period

    def sinusoids(self) -> tuple[Sinusoid, ...]:
        """One cosine with the phase phi."""
        return (Sinusoid(self.signed_amplitude, self.omega, self.phase),)


@lru_cache
def type_c_phase(n: int) -> float:
    """Phase of a type-C_n pulse, to rounding.

    With cos[(2n+1) pi - phi] = -cos(phi) the condition is
    [(2n+1) pi - 2 phi] tan(phi) = 2, solved here as the contraction
    phi = arctan(2 / [(2n+1) pi - 2 phi]).

    Parameters
    ----------
    n : int
        Cycles, at least 1.

    Returns
    -------
    float
        phi (rad), between 0 and pi/4; 0.0697 pi for n = 1, 0.0410 pi for n = 2.
    """
    phi = 0.0
    # Each step multiplies the error by less than 0.06 (its derivative is
    # 4 / ([(2n+1) pi - 2 phi]^2 + 4), largest for n = 1): 16 steps reach 1e-19.
    for _ in range(16):
        phi = math.atan(2.0 / ((2 * n + 1) * math.pi - 2.0 * phi))
    return phi
