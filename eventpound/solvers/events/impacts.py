"""Impacts of one instant in the event loop, and what is listed of them.

The rules by which a cascade ends are those of `eventpound.solvers.events.cascade`.
Impacts too slow to be listed are held back until their contact comes to rest,
whose one row of an accumulation they become, or the cascade is over.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.impact import impact_law, impact_of_one
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python
from eventpound.solvers.base import Event, EventKind
from eventpound.solvers.events.cascade import (
    FADED,
    LISTED_SPEED,
    WINDOW,
    endless_message,
    is_endless,
    is_plastic,
)
from eventpound.solvers.events.modes import Duty, duties

if TYPE_CHECKING:
    from eventpound.solvers.events.loop import EventLoop


class Impacts:
    """The impacts of a run.

    Parameters
    ----------
    loop : EventLoop
        The run, whose state they change.

    Attributes
    ----------
    fastest : float
        Fastest closing speed so far (m/s).
    in_a_row : int
        Impact problems of the present cascade.
    """

    def __init__(self, loop: EventLoop) -> None:
        self.loop = loop
        self.fastest = 0.0
        self.in_a_row = 0
        self._unlisted: list[Event] = []

    def settle(self, collapsed: bool) -> None:
        """Impact problems of this instant, until no closed contact approaches.

        They are plastic where intervals have `collapsed`.
        """
        loop = self.loop
        state, model = loop.state, loop.model
        fastest, here, lost_here, passed_on = 0.0, 0, 0.0, 0.0
        while state.gap.size > 0 and (duties(state.closed, state.gap_rate) == Duty.IMPACT).any():
            approach = -float(state.gap_rate[state.closed].min())
            self.fastest = max(self.fastest, approach)
            fastest = max(fastest, approach)
            if approach <= FADED * fastest:
                # A row squeezed without play: what is left is rounding of the first speeds.
                faded = np.abs(state.gap_rate) <= 10.0 * FADED * fastest
                state.gap_rate[state.closed & faded] = 0.0
                return
            if in_python(is_endless)(here, lost_here, passed_on):
                message = endless_message(loop.recorder.events, loop.task.scene.contacts)
                raise ComputationError(message, state.t)
            if here % WINDOW == 0:
                lost_here = passed_on = 0.0
            here += 1
            self.in_a_row += 1
            plastic = collapsed or in_python(is_plastic)(
                approach, self.fastest, loop.scales.speed, self.in_a_row, here
            )
            restitution = np.zeros(model.contacts) if plastic else model.restitution
            before = state.gap_rate.copy()
            impulse, involved, lost = self._impact(restitution)
            if plastic:
                state.gap_rate[involved & (impulse > 0.0)] = 0.0
            lost_here += lost
            passed_on -= float(impulse @ before)
            self._record(before, impulse, involved, lost, plastic=plastic)

    def _impact(self, restitution: Floats) -> tuple[Floats, Bools, float]:
        """One problem: impulses (K,), who took part (K,), and the energy lost (J)."""
        state, model = self.loop.state, self.loop.model
        closed = state.closed
        if closed.sum() == 1:
            j = int(closed.argmax())
            impulse = np.zeros(closed.size)
            impulse[j], lost = impact_of_one(
                j, model.mass, model.left, model.right, restitution[j], state.gap_rate, state.v
            )
            return impulse, closed, lost
        impulse, involved, lost, solved = impact_law(
            model.mass, model.left, model.right, restitution, closed, state.gap_rate, state.v
        )
        if not solved:
            raise ComputationError("an impact problem has no solution", state.t)
        return impulse, involved, lost

    def _record(
        self, before: Floats, impulse: Floats, involved: Bools, lost: float, *, plastic: bool
    ) -> None:
        """One row for each contact that took an impulse.

        The last of a cascade, `plastic` against its law, stands for all that would follow.
        """
        loop, state = self.loop, self.loop.state
        group = loop.recorder.new_group()
        speed = -float(before[involved].min())
        last = plastic & (before < 0.0) & (loop.model.restitution > 0.0)
        for j in np.flatnonzero(involved & (impulse > 0.0)):
            event = Event(
                state.t,
                EventKind.ACCUMULATION if last[j] else EventKind.IMPACT,
                group,
                int(j),
                float(before[j]),
                float(state.gap_rate[j]),
                float(impulse[j]),
                lost,
            )
            lost = 0.0
            if speed >= LISTED_SPEED * self.fastest:
                loop.recorder.event(event)
            else:
                self._unlisted.append(event)

    def list_rest(self) -> None:
        """End a cascade: what is held back becomes accumulations, or is listed after all."""
        recorder = self.loop.recorder
        for contact in np.flatnonzero(self.loop.state.resting):
            self.gather(int(contact))
        for event in self._unlisted:
            recorder.event(event)
        self._unlisted = []

    def gather(self, contact: int) -> None:
        """Write what is held back of a contact that rests as one accumulation."""
        mine = [e for e in self._unlisted if e.contact == contact]
        if not mine:
            return
        self._unlisted = [e for e in self._unlisted if e.contact != contact]
        self.loop.recorder.event(
            Event(
                mine[-1].t,
                EventKind.ACCUMULATION,
                mine[-1].group,
                contact,
                mine[-1].gap_velocity_before,
                0.0,
                sum(e.impulse for e in mine),
                sum(e.energy_lost for e in mine),
                len(mine),
            )
        )
