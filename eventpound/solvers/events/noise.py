"""Sizes below which a quantity has no meaningful sign, as parts of a scene's own scales."""

from __future__ import annotations

from eventpound.numerics.compiled import scalar_kernel

ROUNDING = 1e-11
"""Gap coefficients below this part of the bodies' own are rounding, where lower ones vanish."""
ACCELERATION = 1e-13
"""Accelerations of gaps, as part of L/T². Their derivatives below this part of the same in the
scene's own time, or below what springs and dashpots make of such an acceleration or derivative two
orders or one before. Bodies without links under the tail of a Gaussian pulse are an exception: they
have the ground's acceleration alone, whose sign is known however small it is."""
LENGTH = 1e-13
"""Distances to a kink, as part of L."""
SPEED = 1e-13
"""Elongation rates, as part of L/T."""
FORCE = 1e-12
"""Contact forces, as part of m L/T²."""
SAME_INSTANT = 1e-11
"""Events whose local times differ relatively by less are one."""
TOGETHER = 1e-12
"""Part of T within which closings belong to one instant, away from cascades."""
PENETRATED = 1e-12
"""Part of L by which a gap below zero is an error."""
PULLED = 1e3
"""Multiples of the rounding of a contact force by which one that pulls is an error."""
RELEASED_AT = 1e-9
"""Part of T within which the series of a contact force tells its zero to rounding."""
DRIFTED = 1e-9
"""Part of L, or of the largest displacement, by which a gap with variables of its own may
differ from that of the displacements; rounding and `ROUNDING` leave a hundredth of it."""


@scalar_kernel
def is_none(k: int, coefficient: float, level: float, rate: float, time: float) -> bool:
    """Whether Taylor coefficient k of a gap counts as zero, as those before it but the rate do.

    A gap that opens from rest, with no `rate`, can do nothing else. One that has opened already,
    at a speed that the rounding of an acceleration, `level`, takes away within T, must not be
    closed again by that.
    """
    if rate == 0.0:
        return coefficient <= level
    return k == 2 and -level <= coefficient < 0.0 and rate <= level * time
