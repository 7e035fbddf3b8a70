"""Contacts with a law: when they close and open, and what they do meanwhile.

Their elements are links with a kink (`eventpound.mechanics.model.with_elements`), so that the
branch of the link tells whether one is closed. From its closing to its opening the impulse
``∫ F dt`` and the work ``∫ F d' dt`` are gathered, step by step, by Gauss's formula on the dense
output, and are one row of an impact at the end.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.event_rows import IMPACT, EventRow, new_group, write_event
from eventpound.contact.state import Instant, Now
from eventpound.mechanics.model import Model
from eventpound.mechanics.monitored import places_in
from eventpound.mechanics.observables import difference
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import deferred_kernel, scalar_kernel
from eventpound.scene.contact_law import Element
from eventpound.solvers.base import Event, EventKind, LawRecording
from eventpound.solvers.events.dense import DenseStep, observe_at
from eventpound.solvers.events.recorder import extremes_of
from eventpound.solvers.events.run import Laws, Run
from eventpound.tolerances import CLOSING_PLACE

(CLOSED, SINCE, BEFORE, IMPULSE, WORK, LONGEST, DRAG) = range(7)
"""Rows of `Laws.touch`: whether it is closed; since when (s), and the rate of the gap before
(m/s); impulse (N s) and work (J) so far; the longest time in contact (s); the number of its
damping, with the speed of this closing where that counts (SI)."""
TOUCH_ROWS = 7
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
"""Of Gauss's formula, on -1 to 1: exact for polynomials of degree 15, above that of a step."""
_HERTZ_DAMP = int(Element.HERTZ_DAMP)


@scalar_kernel
def closing_drag(p: int, gap: float, rate: float, length: float, laws: Laws) -> float:
    """The number of the damping of a contact that closes as `switch_touch` has it (SI)."""
    if laws.kind[p] != _HERTZ_DAMP:
        return float(laws.damping[p])
    # One that was pressed shut from the start has never closed.
    struck = rate < 0.0 and -gap <= CLOSING_PLACE * length
    return -laws.damping[p] / rate if struck else 0.0


@scalar_kernel
def switch_touch(
    p: int, closed: bool, gap: float, rate: float, length: float, laws: Laws, t: float
) -> bool:
    """Begin or end a time in contact, where one does, and say whether one has ended.

    Parameters
    ----------
    p : int
        Which contact with a law.
    closed : bool
        Whether it is closed now.
    gap, rate : float
        Its gap (m) and the rate of it (m/s).
    length : float
        The scene's own (m).
    laws : Laws
        Of the run.
    t : float
        Present time (s).
    """
    touch = laws.touch
    if closed == (touch[CLOSED, p] != 0.0):
        return False
    touch[CLOSED, p] = 1.0 if closed else 0.0
    if closed:
        touch[SINCE, p], touch[BEFORE, p] = t, rate
        touch[IMPULSE, p], touch[WORK, p] = 0.0, 0.0
        touch[DRAG, p] = closing_drag(p, gap, rate, length, laws)
        return False
    touch[LONGEST, p] = max(touch[LONGEST, p], t - touch[SINCE, p])
    return True


@scalar_kernel
def write_touch(p: int, rate: float, laws: Laws, now: Now, events: Floats) -> None:
    """Write down a time in contact that has ended with this rate of the gap (m/s)."""
    touch, group, contact = laws.touch, new_group(now), laws.contact[p]
    before, impulse, work = touch[BEFORE, p], touch[IMPULSE, p], touch[WORK, p]
    row = EventRow(touch[SINCE, p], IMPACT, group, contact, before, rate, impulse, work, 1)
    write_event(row, now, events)


@scalar_kernel
def add_share(p: int, weight: float, force: float, rate: float, laws: Laws) -> None:
    """Add to impulse and work of a closed element what a node of a quadrature tells.

    `weight` (s), force (N) and rate of the gap (m/s) are those of the node.
    """
    if laws.touch[CLOSED, p] != 0.0:
        laws.touch[IMPULSE, p] += weight * force
        # d' is the negative of the rate of the gap.
        laws.touch[WORK, p] -= weight * force * rate


@deferred_kernel
def switch_elements(laws: Laws, at: Instant) -> None:
    """Begin and end times in contact where the branches of elements have changed."""
    for p in range(laws.contact.size):
        a, j = at.branch.size - laws.contact.size + p, laws.contact[p]
        gap = at.opening[j] + difference(at.u, at.left[j], at.right[j])
        rate = difference(at.v, at.left[j], at.right[j])
        if switch_touch(p, at.branch[a] < 0, gap, rate, at.length, laws, at.now[0].t):
            write_touch(p, rate, laws, at.now[0], at.events)
        at.law.damping[a] = laws.touch[DRAG, p]


@deferred_kernel
def add_shares(end: float, arrays: Run, step: DenseStep) -> None:
    """Add what the closed elements do from the start of a step to `end` (s, local)."""
    laws = arrays.laws
    if not (laws.touch[CLOSED] != 0.0).any():
        return
    half = 0.5 * (end - step.dense.start)
    observed = step.observed
    for i in range(NODES.size):
        observe_at(step.dense.start + half * (1.0 + NODES[i]), step)
        for p in range(laws.contact.size):
            j = laws.contact[p]
            add_share(p, half * WEIGHTS[i], observed.contact_force[0, j], observed.gap[1, j], laws)


_NO_LAWS = Laws(
    np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0), np.zeros((TOUCH_ROWS, 0))
)


def laws_of(model: Model) -> Laws:
    """The contacts with a law of a model with their elements, none of them closed."""
    if model.laws.size == 0:
        return _NO_LAWS
    return Laws(
        model.laws,
        model.elements.kind[model.laws],
        model.elements.damping[model.laws],
        np.zeros((TOUCH_ROWS, model.laws.size)),
    )


def with_unfinished(
    events: list[Event], model: Model, laws: Laws, v: Floats, group: int
) -> list[Event]:
    """Events with a row for every time in contact that the end of a run cuts.

    Parameters
    ----------
    events : list of Event
        The others, in order of time.
    model, laws : Model, Laws
        The scene and its contacts with a law.
    v : ndarray, shape (N,)
        Velocities at the end (m/s).
    group : int
        Number of the first row's problem.
    """
    if laws.contact.size == 0:
        return events
    rates = model.rates(v)
    cut: list[Event] = []
    for p in np.flatnonzero(laws.touch[CLOSED]).tolist():
        j, (_, since, before, impulse, work, *_) = int(laws.contact[p]), laws.touch[:, p].tolist()
        after = float(rates[j])
        cut.append(Event(since, EventKind.CUT, group + len(cut), j, before, after, impulse, work))
    return sorted([*events, *cut], key=lambda event: event.t)


def law_recording(model: Model, laws: Laws, end: float, table: Floats) -> LawRecording | None:
    """What contacts with laws did up to `end` (s); None where there are none.

    `table` holds the extremes (`eventpound.solvers.events.recorder.extremes_of`).
    """
    if laws.contact.size == 0:
        return None
    smallest, longest = np.zeros((2, model.contacts))
    force = extremes_of("contact_force", table, places_in(model)).minimum
    smallest[laws.contact] = np.minimum(force[laws.contact], 0.0)
    present = np.where(laws.touch[CLOSED] != 0.0, end - laws.touch[SINCE], 0.0)
    longest[laws.contact] = np.maximum(laws.touch[LONGEST], present)
    return LawRecording(smallest, longest)
