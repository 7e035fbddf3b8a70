"""How the kernels of the fast stepper are compiled; see `eventpound.numerics.compiled`.

A product and a sum may be one rounding in them. None but those that say so make arrays: without
counted references and calls, which copy groups of arrays, nine tenths of a step are saved.
"""

from __future__ import annotations

from eventpound.numerics.compiled import deferred_kernel, scalar_kernel, step_kernel
from eventpound.numerics.compiled.recipe import EVERY_STEP

compiled = step_kernel.but(fused=True)
"""A part of every step."""
compiled_noinline = scalar_kernel.but(fused=True, recipe=EVERY_STEP)
"""What few steps need, as a function of its own."""
compiled_deferred = deferred_kernel.but(counted=False, fused=True)
"""What only some scenes need, or what is to be the same code whoever calls it."""
