"""How the kernels of the fast stepper are compiled; see `eventpound.numerics.compiled`."""

from __future__ import annotations

from eventpound.numerics.compiled import F, compile_with
from eventpound.numerics.compiled.recipe import EVERY_STEP, SMALL


def compiled(function: F) -> F:
    """Compile a part of every step, which makes no arrays, into whoever calls it.

    It does without counted references and without a call, which would copy the
    groups of arrays it is given: together nine tenths of a step.
    """
    return compile_with(function, counted=False, inlined=True, fused=True)


def compiled_noinline(function: F) -> F:
    """Compile what few steps need, which makes no arrays either, as a function of its own."""
    return compile_with(function, counted=False, fused=True, recipe=EVERY_STEP)


def compiled_deferred(function: F) -> F:
    """As `compiled_noinline`, for what only some scenes need: compiled when one comes there."""
    return compile_with(function, counted=False, fused=True, recipe=EVERY_STEP, deferred=True)


def compiled_in_parallel(function: F) -> F:
    """As `compiled_noinline`, for what every run comes to: on another core where there is one."""
    recipe = EVERY_STEP
    return compile_with(
        function, counted=False, fused=True, recipe=recipe, deferred=True, ahead=True
    )


def compiled_deferred_loop(function: F) -> F:
    """As `compiled_deferred`, small enough to take all its parts into itself."""
    return compile_with(function, counted=False, fused=True, recipe=SMALL, deferred=True)


def compiled_with_arrays(function: F) -> F:
    """Compile a kernel that may make arrays: what happens at events only."""
    return compile_with(function, counted=True, fused=True)


def compiled_loop(function: F) -> F:
    """Compile the loop of a kernel small enough to take all its parts into itself."""
    return compile_with(function, counted=False, fused=True, recipe=SMALL._replace(sealed=True))


def compiled_whole(function: F) -> F:
    """Compile what a run by itself and a run among many call, for them to agree to the last bit."""
    recipe = EVERY_STEP._replace(sealed=True)
    return compile_with(function, counted=False, fused=True, recipe=recipe)
