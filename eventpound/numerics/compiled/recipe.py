"""How a kernel is optimised, with all its parts."""

from __future__ import annotations

from typing import NamedTuple


class Recipe(NamedTuple):
    """How a kernel is optimised, with all its parts.

    Attributes
    ----------
    level : int
        LLVM's level of optimisation.
    forced : bool
        Parts marked as inlined are compiled into whoever calls them. Otherwise LLVM
        chooses, which takes half the time for large kernels.
    """

    level: int
    forced: bool


ONCE_AN_EVENT = Recipe(level=1, forced=False)
"""For what Python calls seldom: two thirds of the time to compile, a little slower."""
EVERY_STEP = Recipe(level=2, forced=False)
"""For large kernels: LLVM chooses what is compiled into what."""
SMALL = Recipe(level=3, forced=True)
"""For loops of a few thousand instructions, into which their parts are compiled."""
