"""What is called as work goes on: a run tells the time it has reached, all else what is done."""

from __future__ import annotations

from collections.abc import Callable

Reached = Callable[[float], None]
"""Called with the time that a run has reached (s)."""
Counted = Callable[[int, int], None]
"""Called with how many are done, and of how many; at first with what was there before."""
