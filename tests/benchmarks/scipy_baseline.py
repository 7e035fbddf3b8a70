"""SciPy's `solve_ivp`, or CVODE from Python, on a scene, with events and restarts, as users do.

Every gap g is a terminal event for its closing; at one, Newton's law

    Lambda = -(1 + eps) g' / (1/m_left + 1/m_right)

changes the velocities of its two bodies (1/m of a barrier is zero) and
`solve_ivp` starts again. Velocity zeros of each body are events too, for its
extremes. The run is split where the ground motion jumps, not at the samples of
a record. There is no logic for resting contacts and accumulating impacts, nor a
guard against missed ones: such code carries on, or never ends, so that impacts
and time are bounded here and what happened is reported.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import compress
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from sksundae.cvode import CVODE

from eventpound.numerics.arrays import Floats
from eventpound.scene import BARRIER, BoucWen, Contact, Scene
from eventpound.solvers.base import Task
from tests.benchmarks.answers import Answer, Impact
from tests.benchmarks.scipy_equations import Rates, ground, rates

SUNDIALS = "SUNDIALS"
"""The method that is CVODE, not one of SciPy's."""
MOST_STEPS = 100_000
MOST_IMPACTS = 2000
"""Restarts after which a run counts as one that does not end."""


class _GivenUpError(Exception):
    """The run does not get to its end."""


@dataclass(frozen=True)
class BaselineRun:
    """What a run of the baseline returned.

    Parameters
    ----------
    answer : Answer
        Extremes, final state and impacts, up to where it got.
    trouble : str
        Why it did not reach the end; empty where it did.
    penetration : float
        Deepest overlap of a contact at the end of a step (m), silent in such code.
    """

    answer: Answer
    trouble: str
    penetration: float


class _Gap:
    """One contact: its gap as an event function, and Newton's law."""

    def __init__(self, scene: Scene, contact: Contact) -> None:
        place = {body.name: i for i, body in enumerate(scene.bodies)}
        self.left = -1 if contact.left == BARRIER else place[contact.left]
        self.right = -1 if contact.right == BARRIER else place[contact.right]
        self.gap, self.restitution = contact.gap, contact.restitution
        self.count = len(place)
        self.inverse_mass = [
            0.0 if i < 0 else 1.0 / scene.bodies[i].mass for i in (self.left, self.right)
        ]

    def value(self, y: Floats) -> Any:
        """The gap (m): a number for one state, an array for the columns of many."""
        gap: Any = self.gap
        if self.right >= 0:
            gap = gap + y[self.right]
        return gap - y[self.left] if self.left >= 0 else gap

    def event(self, check: Callable[[], None]) -> Callable[[float, Floats], float]:
        """Terminal event for a gap that closes."""

        def closing(t: float, y: Floats) -> float:
            check()
            return float(self.value(y))

        closing.terminal, closing.direction = True, -1.0
        return closing

    def strike(self, y: Floats) -> float:
        """Apply Newton's law to a state; return the closing speed (m/s)."""
        v = y[self.count : 2 * self.count]
        speed = (v[self.left] if self.left >= 0 else 0.0) - (
            v[self.right] if self.right >= 0 else 0.0
        )
        impulse = (1.0 + self.restitution) * speed / sum(self.inverse_mass)
        if self.left >= 0:
            v[self.left] -= impulse * self.inverse_mass[0]
        if self.right >= 0:
            v[self.right] += impulse * self.inverse_mass[1]
        return float(speed)


def _turning(i: int, check: Callable[[], None]) -> Callable[[float, Floats], float]:
    """Event for a zero of entry i of the state, a velocity."""

    def velocity(t: float, y: Floats) -> float:
        check()
        return float(y[i])

    return velocity


def _initial(scene: Scene) -> Floats:
    z = [spring.law.initial_z for spring in scene.springs if isinstance(spring.law, BoucWen)]
    u = [body.displacement for body in scene.bodies]
    v = [body.velocity for body in scene.bodies]
    return np.array([*u, *v, *z], dtype=float)


def tolerances(scene: Scene, rtol: float) -> Floats:
    """Absolute tolerances of a state: rtol times L, L/T and 1, L and T of the ground motion."""
    count = len(scene.bodies)
    scales = scene.motion.scales()
    length, omega = (scales.length, scales.omega_g) if scales else (1.0, 1.0)
    z = len(_initial(scene)) - 2 * count
    return rtol * np.array([length] * count + [length * omega] * count + [1.0] * z)


def _cvode(
    equation: Rates, span: tuple[float, float], y: Floats, events: Sequence[Any], **options: Any
) -> SimpleNamespace:
    """The same as `solve_ivp` by CVODE of scikit-sundae."""

    def rates_into(t: float, y: Floats, into: Floats) -> None:
        into[:] = equation(t, y)

    def events_into(t: float, y: Floats, into: Floats) -> None:
        into[:] = [event(t, y) for event in events]

    ends = [getattr(event, "terminal", False) for event in events]
    rules: Any = events_into
    rules.terminal, rules.direction = ends, [int(getattr(e, "direction", 0.0)) for e in events]
    solver = CVODE(
        rates_into,
        eventsfn=events_into,
        num_events=len(events),
        max_num_steps=MOST_STEPS,
        **options,
    )
    sol = solver.solve(span, y)
    happened = np.zeros((0, len(events))) if sol.i_events is None else sol.i_events
    found = [np.flatnonzero(column) for column in happened.T]
    return SimpleNamespace(
        t=sol.t,
        y=sol.y.T,
        t_events=[sol.t_events[rows] if len(rows) else [] for rows in found],
        y_events=[sol.y_events[rows] if len(rows) else [] for rows in found],
        status=int(any(map(len, compress(found, ends)))) if sol.success else -1,
    )


class _Run:
    """One run under way."""

    def __init__(self, task: Task, method: str, seconds: float) -> None:
        scene = task.scene
        self.task, self.method = task, method
        self.atol = tolerances(scene, task.rtol)
        self.count = len(scene.bodies)
        self.gaps = [_Gap(scene, contact) for contact in scene.contacts]
        self.events = [gap.event(self._check) for gap in self.gaps]
        self.events += [_turning(self.count + i, self._check) for i in range(self.count)]
        self.seconds, self.deadline = seconds, time.process_time() + seconds
        self.t, self.y = task.start, _initial(scene)
        self.impacts: list[Impact] = []
        self.lowest = self.highest = self.y[: self.count].copy()
        self.penetration = 0.0

    def _check(self) -> None:
        if time.process_time() > self.deadline:
            raise _GivenUpError(f"did not end within {self.seconds:g} s")

    def go(self) -> BaselineRun:
        """Run to the end or to where it is given up."""
        trouble = ""
        try:
            for piece in self.task.scene.motion.pieces():
                equation = rates(self.task.scene, ground(piece))
                while self.t < min(piece.end, self.task.end):
                    self._stretch(equation, min(piece.end, self.task.end))
        except _GivenUpError as reason:
            trouble = str(reason)
        u = self.y[: self.count]
        return BaselineRun(
            Answer(self.lowest, self.highest, u, tuple(self.impacts)), trouble, self.penetration
        )

    def _stretch(self, equation: Rates, stop: float) -> None:
        """Integrate up to `stop` or the next impact."""
        options = {"rtol": self.task.rtol, "atol": self.atol}
        integrate = partial(solve_ivp, method=self.method)
        if self.method == SUNDIALS:
            integrate = _cvode
        try:
            sol = integrate(equation, (self.t, stop), self.y, events=self.events, **options)
        except ValueError as error:
            # The root finder's, where an event function is not what it was at the step's end.
            raise _GivenUpError(f"solve_ivp raised {error}") from error
        self._account(sol)
        if sol.status < 0:
            raise _GivenUpError("solve_ivp gave up")
        if len(self.impacts) >= MOST_IMPACTS:
            raise _GivenUpError(f"did not end within {MOST_IMPACTS} impacts")

    def _account(self, sol: Any) -> None:
        """Take what `solve_ivp` returned, and an impact where it ended at one."""
        self._seen(sol.y[: self.count])
        for states in sol.y_events[len(self.gaps) :]:
            if len(states):
                self._seen(np.array(states).T[: self.count])
        self.t, self.y = float(sol.t[-1]), sol.y[:, -1].copy()
        for contact, gap in enumerate(self.gaps):
            self.penetration = max(self.penetration, -float(np.min(gap.value(sol.y))))
            if sol.status == 1 and len(sol.t_events[contact]):
                self.impacts.append(Impact(self.t, contact, gap.strike(self.y)))

    def _seen(self, u: Floats) -> None:
        """Take displacements, shape (N, many), into the extremes."""
        self.lowest = np.minimum(self.lowest, u.min(axis=1))
        self.highest = np.maximum(self.highest, u.max(axis=1))


def solve(task: Task, method: str, seconds: float) -> BaselineRun:
    """Run a task.

    Parameters
    ----------
    task : Task
        The scene, the stretch of time, and the relative tolerance; absolute ones
        are rtol times the scene's scales.
    method : str
        ``"LSODA"``, ``"DOP853"`` or `SUNDIALS`.
    seconds : float
        Processor time after which the run is given up (s).
    """
    return _Run(task, method, seconds).go()
