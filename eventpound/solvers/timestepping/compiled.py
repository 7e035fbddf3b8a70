"""How the parts of a step are compiled."""

from __future__ import annotations

from eventpound.numerics.compiled import F, compile_with
from eventpound.numerics.compiled.recipe import SMALL


def step_kernel(function: F) -> F:
    """Compile a part of every step, which makes no arrays, into whoever calls it.

    A call copies the groups of arrays it is given, which costs more than the part.
    """
    return compile_with(function, counted=False, inlined=True)


def step_loop(function: F) -> F:
    """Compile a loop over steps with its parts in it."""
    return compile_with(function, counted=False, recipe=SMALL)
