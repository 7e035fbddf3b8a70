"""heyoka: a Taylor series with events, compiled for the problem; one run, or eight side by side."""

from collections.abc import Callable
from typing import Any

import heyoka as hy
import numpy as np

from eventpound.solvers.base import Task
from tests.benchmarks.answers import Answer
from tests.benchmarks.peers.rules import NEAR, YIELDED, Modes, Row

QUIET = 1e-9
"""Time (s) after a zero of v or z without another; both begin there, and it finds none itself."""


def _twentieth(z: Any) -> Any:
    # Its own power of a number is not one at z = 0.
    fourth = z * z * (z * z)
    return fourth * fourth * (fourth * fourth) * fourth


class Heyoka:
    """A program for one problem.

    Parameters
    ----------
    task : Task
        The problem.
    rests : bool
        Whether a body may stay at its barrier.
    lanes : int
        Runs side by side, of the same numbers here; 0 for one by itself.
    """

    def __init__(self, task: Task, rests: bool, lanes: int = 0) -> None:
        self.row, self.lanes = Row(task), lanes
        system, events = _equations(self.row, rests, lanes > 0, self._happens)
        size = 3 * len(self.row.m)
        state, pars = np.zeros(size), np.zeros(size + (1 if self.row.omega else 3))
        if lanes:
            state, pars = (np.repeat(x[:, None], lanes, axis=1) for x in (state, pars))
        make = hy.taylor_adaptive_batch if lanes else hy.taylor_adaptive
        self.ta = make(system, state, pars=pars, tol=task.rtol, t_events=events)

    def run(self) -> Answer:
        """Run it; the answer of the last lane."""
        ta, row = self.ta, self.row
        if self.lanes:
            ta.set_time(0.0)
        else:
            ta.time = 0.0
        ta.state[:] = 0.0
        ta.reset_cooldowns()
        self.modes = [Modes(row) for _ in range(self.lanes or 1)]
        self.state, self.pars = (
            [each[:, lane] for lane in range(self.lanes)] if self.lanes else [each]
            for each in (ta.state, ta.pars)
        )
        self.stretch = row.stretches[0]
        for modes, y in zip(self.modes, self.state, strict=True):
            modes.begin(0.0, y, self.stretch)
        for lane in range(len(self.modes)):
            self._put(lane)
        motion = ta.pars[3 * len(row.m) :]
        for self.stretch in row.stretches:
            motion.T[:] = self._motion()
            ta.propagate_until(self.stretch.end)
        return self.modes[-1].answer(self.state[-1])

    def _motion(self) -> tuple[float, ...]:
        of = self.stretch
        return (of.A,) if self.row.omega else (of.start, of.a, of.b)

    def _put(self, lane: int) -> None:
        of = self.modes[lane]
        self.pars[lane][: 3 * len(of.free)] = (*of.loading, *of.flowing, *of.free)

    def _happens(self, event: int, ta: Any, lane: int) -> bool:
        t = ta.time[lane] if self.lanes else ta.time
        self.modes[lane].happens(event, t, self.state[lane], self.stretch)
        self._put(lane)
        return True


def _equations(
    row: Row, rests: bool, several: bool, happens: Callable[[int, Any, int], bool]
) -> tuple[Any, Any]:
    """The system, and the events in the order of `rules`."""
    n = len(row.m)
    u, v, z = (hy.make_vars(*(f"{x}{i}" for i in range(n))) for x in "uvz")
    u, v, z = ([x] if n == 1 else x for x in (u, v, z))
    loading, flowing, free = ([hy.par[part * n + i] for i in range(n)] for part in range(3))
    start, a, b = (hy.par[3 * n + i] for i in range(3))
    a_g = a + b * (hy.time - start)
    if row.omega:
        # A pulse has its amplitude there, and nothing else.
        a_g = start * hy.cos(row.omega * hy.time + row.phase)
    pull = [-(row.k[i] * u[i] + row.Q[i] * z[i]) / row.m[i] - a_g for i in range(n)]
    held = free if rests else [1.0] * n
    system = [(u[i], held[i] * v[i]) for i in range(n)]
    system += [(v[i], held[i] * pull[i]) for i in range(n)]
    system += [
        (z[i], flowing[i] * v[i] / row.u_y[i] * (1.0 - loading[i] * _twentieth(z[i])))
        for i in range(n)
    ]
    way = hy.event_direction
    wanted: list[tuple[Any, Any, float]] = []
    for i in range(n):
        wanted += [(x, way.any, QUIET) for x in (v[i], z[i])]
        wanted += [(z[i] * z[i] - x**2, way.positive, -1.0) for x in (NEAR, YIELDED)]
    for (left, right), gap in zip(row.ends, row.gaps, strict=True):
        opening = gap + (u[right] if right >= 0 else 0.0) - u[left]
        # Its own time without events would hide the next impact.
        wanted.append((opening, way.negative, 0.0))
    if rests:
        wanted.append((pull[0] * (1.0 - free[0]) + free[0], way.negative, 0.0))
    event = hy.t_event_batch if several else hy.t_event
    events = [
        event(
            each,
            # Called with the program, the direction and, of several, the lane.
            callback=lambda ta, _, lane=0, number=number: happens(number, ta, lane),
            direction=direction,
            cooldown=quiet,
        )
        for number, (each, direction, quiet) in enumerate(wanted)
    ]
    return system, events
