"""What springs do at instants of their own: a slider sticks or slips, soil is touched or left.

Every such instant is an event of the solver, with the state before and after it in the history, so
that between two of them a spring has one *state*: of a slider the sign of its slip, 0 while it
sticks, of soil the sign of z, which is negative where it is pressed. A spring event is where it
changes. What begins and ends in the same instant is none.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from enum import StrEnum
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eventpound.case.run_options import LISTED
from eventpound.numerics.arrays import Floats, Ints
from eventpound.quantities.values import motion_of_spring
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Hysteretic, LawName
from eventpound.solvers.base import Recording
from eventpound.tolerances import OF_ROWS, SAME_INSTANT

if TYPE_CHECKING:
    import pandas as pd


class SpringEventKind(StrEnum):
    """What a spring began to do."""

    STICK = "stick"
    SLIP = "slip"
    CLOSED = "gap-closed"
    """Soil was touched."""
    OPENED = "gap-opened"
    """Soil was left."""


_KINDS: Mapping[LawName, Mapping[int, SpringEventKind]] = {
    LawName.SLIDER: {-1: SpringEventKind.SLIP, 0: SpringEventKind.STICK, 1: SpringEventKind.SLIP},
    LawName.BACKFILL: {-1: SpringEventKind.CLOSED, 1: SpringEventKind.OPENED},
}
"""By the law and the state that begins."""


class SpringEvent(NamedTuple):
    """A spring begins to do something else.

    Parameters
    ----------
    time_s : float
        When (s).
    spring : str
        Its name.
    kind : SpringEventKind
        What it does from then on.
    direction : int
        Sign of the rate of its elongation; 0 while it sticks.
    elongation_m, force_N : float
        Its elongation (m) and force (N) just after.
    """

    time_s: float
    spring: str
    kind: SpringEventKind
    direction: int
    elongation_m: float
    force_N: float  # noqa: N815  # a unit


def spring_events(
    scene: Scene, recording: Recording, words: Collection[str] = tuple(LISTED)
) -> list[SpringEvent]:
    """Events of springs, in order of time.

    Parameters
    ----------
    scene : Scene
        What moved.
    recording : Recording
        Of a solver that says ``lists_springs``.
    words : collection of str
        Keys of `eventpound.case.run_options.LISTED`.
    """
    laws = {LISTED[word] for word in words}
    found: list[SpringEvent] = []
    for i, spring in enumerate(scene.springs):
        if isinstance(spring.law, Hysteretic) and spring.law.word in laws:
            found += _events_of(i, spring.law.word, scene, recording)
    return sorted(found, key=lambda event: event.time_s)


def _events_of(i: int, law: LawName, scene: Scene, recording: Recording) -> list[SpringEvent]:
    """Those of spring i."""
    h, name = recording.history, scene.springs[i].name
    first, last = _segments(recording)
    x, rate = motion_of_spring(scene, recording, i)
    z = h.z[:, scene.hysteretic_springs.index(name)]
    still = OF_ROWS * np.abs(h.v).max(initial=0.0)
    if law is LawName.SLIDER:
        # What stands still sticks until the run begins.
        begun = [int(np.sign(v)) if abs(v) > still else 0 for v in rate[:1].tolist()]
        states = begun + _slips(i, first, z, recording)
    else:
        sides = _sides(first, last, z, rate, still)
        states = sides[:1] + sides
    found = []
    for row, (before, state) in zip(first.tolist(), pairwise(states), strict=True):
        if state != before:
            at = float(h.t[row]), name, _KINDS[law][state], state
            found.append(SpringEvent(*at, float(x[row]), float(h.force[row, i])))
    return found


def _segments(recording: Recording) -> tuple[Ints, Ints]:
    """First and last rows of the history between two events.

    The end of a run that reached it is one, too: what begins there is told.
    """
    t = recording.history.t
    cuts = np.flatnonzero(t[1:] == t[:-1]) + 1
    first, last = np.append(0, cuts), np.append(cuts, t.size) - 1
    if t.size == 0:
        return first[:0], last[:0]
    lasts = t[last] > t[first] * (1.0 + SAME_INSTANT)
    lasts[-1] |= recording.success
    return first[lasts], last[lasts]


def _slips(i: int, first: Ints, z: Floats, recording: Recording) -> list[int]:
    """State of slider i from each of these rows on."""
    own = [stick for stick in recording.sticks if stick.spring == i]
    latest = np.searchsorted([stick.t for stick in own], recording.history.t[first], "right") - 1
    sticks = [place >= 0 and own[place].begins for place in latest.tolist()]
    signs = np.sign(z[first]).astype(int).tolist()
    return [0 if stuck else sign for stuck, sign in zip(sticks, signs, strict=True)]


def _sides(first: Ints, last: Ints, z: Floats, rate: Floats, still: float) -> list[int]:
    """State of soil in each stretch of rows, as before where it is only touched."""
    found: list[int] = []
    for a, b in zip(first.tolist(), last.tolist(), strict=True):
        largest = z[a + int(np.argmax(np.abs(z[a : b + 1])))]
        # Without a row between its ends the rates there tell.
        told = (largest, OF_ROWS * np.abs(z).max()), (rate[a], still), (-rate[b], still)
        sign = next((int(np.sign(value)) for value, noise in told if abs(value) > noise), 0)
        found.append(sign or (found[-1] if found else 0))
    return found


def spring_event_table(scene: Scene, recording: Recording) -> pd.DataFrame:
    """Events of springs, a row each; units in the columns."""
    import pandas as pd

    found = spring_events(scene, recording)
    table = pd.DataFrame(found, columns=list(SpringEvent._fields))
    # Of an empty table, too.
    numbers = {"time_s": float, "direction": int, "elongation_m": float, "force_N": float}
    kinds = [event.kind.value for event in found]
    return table.assign(kind=kinds).astype(numbers | {"spring": str, "kind": str})
