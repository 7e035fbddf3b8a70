"""What counts as right, as the same and as nothing: every threshold of a judgement."""

from __future__ import annotations

import math
from typing import Any

LEVELS = {"engineering": 1e-2, "research": 1e-4, "reference": 1e-8}
"""Parts of the scale that may be wrong."""
ROUNDING = 4.0 * 2.0**-52
"""Relative change of the inputs that a well-made program's rounding amounts to."""
SAME_TIME = 1e-9
"""Part of a run within which two times are one."""
START = 1e-6
"""Part of the largest motion by which a history may begin off the initial state."""
UNIT_OF_TIME = 0.05
"""Part of a run that shifts of impacts are measured in; none further apart are paired."""
LISTED, COUNTED = 1e-3, 1e-2
"""Weight above which an event is paired, and above which one without a partner counts."""
EVENTS = {
    "rest": ("rest",),
    "detachment": ("detachment", "separation"),
    "accumulation": ("accumulation",),
}
"""Events beside impacts as they are judged, and the kinds in a list: a rest has one end, however
its contact is opened."""
UNJUDGED = ("cut-impact", "stick", "slip-forward", "slip-backward")
"""Kinds of events that a list may hold and that nobody is judged by."""
ALWAYS = (-math.inf, math.inf)
TINY = 1e-300
"""What is divided by instead of nothing."""
MOST_COSTS = 10**7
"""Pairs of times that are weighed at once; of more a smaller window is taken."""
CREATED = 1e-2
"""Part of the largest energy that may appear from nowhere, and of the largest ground acceleration
that the rows may not show."""
ROUND_GAP, CLOSED = 1e-9, 1e-6
"""Part of the largest rate below which a gap does not close; of the largest displacement by which
a gap at a double row may be off zero."""
KEYS = {
    "problem.json": "problem tests start end moments bodies contacts M C B W springs gaps "
    "restitutions initial motion",
    "answer.json": "quantities event_columns events",
}
"""What the two files of a problem must have."""
SMOOTH = 1e-3
"""Part of the change of a gap's rate by which the gap may leave a parabola; an impact between two
rows leaves it by up to a half."""
IGNORED = ("a_g", "a.", "force.", "gap.", "lambda.")
"""Columns that an answer may have, too."""

Floats = Any
"""An array of doubles."""


class ScoreError(Exception):
    """An answer cannot be judged; the message says why."""
