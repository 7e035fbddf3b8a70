"""Settling an instant: impacts, the acceleration problem, and the cascade that may follow.

Cascades whose intervals are too short for the integrator (accumulating
bounces, a light body caught between heavy ones, a chain of plastic contacts)
are followed impact by impact on local series until
`eventpound.solvers.events.cascade` calls them over.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.clusters import close_one, join_bodies, unique_forces
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.base import Piece
from eventpound.motion.forcing import ground_onset
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python
from eventpound.solvers.base import Event
from eventpound.solvers.events.audit import check_contacts
from eventpound.solvers.events.cascade import FLEETING, LAST_INTERVAL
from eventpound.solvers.events.happening import Happening, first_happening
from eventpound.solvers.events.impacts import Impacts
from eventpound.solvers.events.inspection import inspect_step
from eventpound.solvers.events.local import SeriesStep, series_step
from eventpound.solvers.events.modes import Mode, transition
from eventpound.solvers.events.rest import ORDER, decide_rest
from eventpound.solvers.events.segment import copy_observed

if TYPE_CHECKING:
    from eventpound.solvers.events.loop import EventLoop

SPEED_NOISE = 1e-13
"""Elongation rates below this part of L/T have no meaningful sign."""
ON_KINK = 1e-13
"""Part of L by which an elongation may differ from a kink that it is on."""
KNOTS = 3
"""Reversals of links after which short steps end although no event is in sight."""
LONGEST_CASCADE = 200_000
"""Short steps of one cascade after which a run gives up."""


class Settling:
    """Carries a run from an instant with duties to one without.

    Parameters
    ----------
    loop : EventLoop
        The run, whose state is moved on.
    """

    def __init__(self, loop: EventLoop) -> None:
        self.loop = loop
        self._impacts = Impacts(loop)
        self._rested_at = -math.inf

    def settle(self, piece: Piece, stop: float, released: Bools) -> None:
        """Do the duties of the present instant and follow the motion until none is near.

        Parameters
        ----------
        piece : Piece
            The ground motion.
        stop : float
            Do not pass this time (s).
        released : ndarray of bool, shape (K,)
            Contacts whose force has just reached zero.
        """
        loop = self.loop
        interval = loop.scales.time
        happened, knots = True, 0
        self._impacts.in_a_row = 0
        for _ in range(LONGEST_CASCADE):
            if happened:
                collapsed = interval <= LAST_INTERVAL * loop.scales.time
                if collapsed:
                    self._close_collapsed()
                self._put_on_constraint()
                was_resting, before = loop.state.resting.copy(), loop.state.v.copy()
                self._impacts.settle(collapsed)
                # What presses those that an impact has moved is another matter now.
                released = released & ~self._moved(before)
                self._turn_at_kinks()
                self._rest(piece, was_resting, released)
            mode = loop.mode()
            limit = loop.next_stop(piece, loop.state.t, stop) - loop.state.t
            if loop.state.t >= stop:
                break
            loop.go_on(loop.state.t)
            step, happening = self._short_step(mode, piece, limit)
            # What was closed already did not fly.
            interval = happening.tau if happening.tau > 0.0 else interval
            released = happening.released
            happened = bool(happening.closing.any() or released.any() or happening.kinked.any())
            self._move(step, happening, happened)
            knots = 0 if happened else knots + step.knot
            goes_on = happened or mode.clusters.count == 0 or (step.knot and knots <= KNOTS)
            if not goes_on:
                break
        else:
            raise ComputationError(
                f"more than {LONGEST_CASCADE} impacts follow each other without an end",
                loop.state.t,
            )
        self._impacts.list_rest()

    def _moved(self, before: Floats) -> Bools:
        """Contacts (K,) of bodies whose velocity is not what it was before the impacts."""
        state, model = self.loop.state, self.loop.model
        # The last place stands for barriers.
        moved = np.append(state.v != before, False)
        return np.asarray(moved[model.left] | moved[model.right])

    def _put_on_constraint(self) -> None:
        """Make the displacements of closed contacts agree with their gaps of zero."""
        state, model = self.loop.state, self.loop.model
        closed = state.closed
        if not closed.any():
            return
        if closed.sum() == 1 and model.bodies == 1:
            # A single body joins no other: nothing of clusters is compiled for it.
            j = int(closed.argmax())
            state.u = state.u.copy()
            close_one(int(model.left[j]), int(model.right[j]), model.gap[j], model.mass, state.u)
            return
        touching = in_python(join_bodies)(
            model.left, model.right, model.gap, closed, closed, model.bodies
        )
        of_body, offset = touching.of_body, touching.offset
        mass = np.bincount(of_body + 1, model.mass, touching.count + 1)
        moment = np.bincount(of_body + 1, model.mass * (state.u - offset), touching.count + 1)
        mean = np.divide(moment, mass, out=np.zeros_like(mass), where=mass > 0.0)
        mean[0] = 0.0
        state.u = mean[of_body + 1] + offset

    def _close_collapsed(self) -> None:
        """Close every gap that is none beside an interval that is none."""
        state, scales = self.loop.state, self.loop.scales
        none = LAST_INTERVAL * (scales.length + self._impacts.fastest * scales.time)
        state.gap[np.abs(state.gap) <= none] = 0.0

    def _rest(self, piece: Piece, was_resting: Bools, released: Bools) -> None:
        """Acceleration problem; records who came to rest or opened."""
        loop = self.loop
        state, table = loop.state, loop.table
        forcing = loop.forcing(piece)
        mode = table.mode(state.resting & state.closed, state.branch, state.pressed)
        self._choose_branches(mode, forcing)
        resting, pressed = decide_rest(
            state,
            table,
            forcing,
            released,
            SPEED_NOISE * loop.scales.speed,
            loop.scales,
        )
        for contact in np.flatnonzero(resting & ~was_resting):
            self._impacts.gather(int(contact))
        changed = [
            (j, kind)
            for j in range(resting.size)
            if (kind := transition(was_resting[j], resting[j], state.gap_rate[j])) is not None
        ]
        if (resting & ~was_resting).any():
            self._rested_at = state.t
        state.resting, state.pressed = resting, pressed
        if changed:
            group = loop.recorder.new_group()
            for j, kind in changed:
                loop.recorder.event(
                    Event(state.t, kind, group, j, gap_velocity_after=float(state.gap_rate[j]))
                )
        mode = loop.mode()
        if not mode.clusters.tree:
            unique = unique_forces(mode.clusters, loop.model.left, loop.model.right)
            loop.recorder.unique_forces[mode.clusters.resting] &= unique
        state.gap_rate[resting] = 0.0
        if self._is_fleeting(0.0):
            loop.recorder.hold()
        loop.recorder.settled(state.t, loop.observed(mode, forcing, loop.seen[2]))

    def _turn_at_kinks(self) -> None:
        """Put links that are on their kinks on the sides to which they move now."""
        loop, state = self.loop, self.loop.state
        if loop.table.kinked.any():
            near, still = loop.noise.length, SPEED_NOISE * loop.scales.speed
            state.branch = loop.table.turned(state.branch, state.u, state.v, near, still)

    def _choose_branches(self, mode: Mode, forcing: Forcing) -> None:
        """Branch of every kinked link from where it is and where it goes."""
        loop = self.loop
        if not loop.table.kinked.any():
            return
        seen = loop.observed(mode, forcing, loop.seen[2])
        onset = ground_onset(*forcing, ORDER, np.empty(ORDER))
        near = ON_KINK * loop.scales.length
        chosen = loop.table.branches(seen.u, seen.v, seen.a, onset, near)
        unset = loop.state.branch == 0
        loop.state.branch = np.where(unset, chosen, loop.state.branch)

    def _short_step(self, mode: Mode, piece: Piece, limit: float) -> tuple[SeriesStep, Happening]:
        """A step on the series, and what happens at its end, perhaps nothing."""
        loop = self.loop
        forcing = loop.forcing(piece)
        y = mode.pack(loop.state)
        before, after, scratch = loop.seen
        step = series_step(
            loop.state,
            mode,
            forcing,
            limit,
            loop.weights(mode, y),
            SPEED_NOISE * loop.scales.speed,
            loop.scales.acceleration,
            scratch,
        )
        loop.observed(mode, forcing, before)
        copy_observed(step.look(step.end), after)
        found = loop.found
        marks = inspect_step(before, after, step.end, mode.watched, loop.recorder.running, found)
        happening = None
        if marks:
            found.closing[:] = False
            happening = first_happening(step, found, mode.watched, loop.noise)
        if happening is None:
            happening = Happening(
                step.end, step.closing, np.zeros_like(step.closing), np.zeros_like(found.kink)
            )
        loop.state.branch[happening.kinked] *= -1
        if marks:
            loop.recorder.peaks(step, loop.state.t, happening.tau, found)
        return step, happening

    def _move(self, step: SeriesStep, happening: Happening, happened: bool) -> None:
        """Advance the state along the series to what happens."""
        loop, tau = self.loop, happening.tau
        recorder = loop.recorder
        fleeting = happened and self._is_fleeting(tau)
        # Where a mode is none no time passes either.
        t = loop.state.t + (0.0 if fleeting else tau)
        if recorder.due(t):
            recorder.samples(step, loop.state.t, tau)
        seen = step.look(tau)
        if fleeting:
            recorder.forget()
        elif happened:
            recorder.instant(t, seen)
        else:
            recorder.extremes(t, seen)
        check_contacts(t, seen, step.mode.watched, loop.noise, loop.task.scene)
        gap, gap_rate = step.gaps(tau)
        loop.take(step.state(tau)[0], step.mode, t)
        gap[happening.closing] = 0.0
        loop.state.gap, loop.state.gap_rate = gap, gap_rate
        loop.steps += 1
        if loop.task.progress is not None:
            # A cascade may be long: whoever waits may stop it.
            loop.task.progress(loop.state.t)

    def _is_fleeting(self, tau: float) -> bool:
        """Whether a mode that ends after tau (s) is none: a contact has only just come to rest."""
        since = self.loop.state.t - self._rested_at
        return since + tau < FLEETING * self.loop.scales.time
