"""What a solver is given, what it gives back, and the duties of whoever writes one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from eventpound.contact.event import ENDS_OF_REST as ENDS_OF_REST
from eventpound.contact.event import FRICTION_KINDS as FRICTION_KINDS
from eventpound.contact.event import Event as Event
from eventpound.contact.event import EventKind as EventKind
from eventpound.errors import ComputationError
from eventpound.numerics.arrays import Floats
from eventpound.scene.parameters import Place
from eventpound.scene.scene import Scene


@dataclass(frozen=True, slots=True)
class Task:
    """One run: a scene, a stretch of time, a tolerance.

    Parameters
    ----------
    scene : Scene
        What moves.
    start, end : float
        The run (s), ``end > start``.
    rtol : float
        Relative tolerance.
    atol : mapping, optional
        Absolute tolerance of ``"displacement"`` (m), ``"velocity"`` (m/s) and
        ``"z"``; what is missing is rtol times the scene's own scale.
    output_times : ndarray, shape (n,)
        Increasing times (s) at which the history is wanted.
    energy : bool
        Keep the energy ledger.
    settings : mapping
        Keys of the solver's own.
    progress : callable, optional
        Called now and then with the time reached (s). A ComputationError that it raises
        stops the run, which gives it what was computed.
    max_steps : int, optional
        Steps after which a run that is not at its end stops with a ComputationError
        (`steps_used_up`). Only solvers that say `counts_steps` are given it.
    """

    scene: Scene
    start: float
    end: float
    rtol: float
    atol: Mapping[str, float] = field(default_factory=dict)
    output_times: Floats = field(default_factory=lambda: np.empty(0))
    energy: bool = False
    settings: Mapping[str, object] = field(default_factory=dict)
    progress: Callable[[float], None] | None = None
    max_steps: int | None = None


def steps_used_up(most: int, t: float) -> ComputationError:
    """What a run ends with that is not at its end after so many steps, at the time t (s)."""
    return ComputationError(
        f"the limit of {most} steps is reached; raise it (--max-steps), or give a larger rtol or "
        "time_step, or a shorter duration",
        t,
    )


@dataclass(frozen=True, slots=True)
class History:
    """State at the output times and at every event (before and after).

    N bodies, S springs, H of them hysteretic, K contacts.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time (s), not decreasing.
    ground : ndarray, shape (n,)
        Ground acceleration (m/s^2).
    u, v, a : ndarray, shape (n, N)
        Displacement (m) and velocity (m/s) relative to the ground, absolute
        acceleration (m/s^2).
    z : ndarray, shape (n, H)
        Hysteretic variables.
    force : ndarray, shape (n, S)
        Spring forces (N).
    gap, contact_force : ndarray, shape (n, K)
        Gaps (m) and forces of resting contacts (N).
    """

    t: Floats
    ground: Floats
    u: Floats
    v: Floats
    a: Floats
    z: Floats
    force: Floats
    gap: Floats
    contact_force: Floats


@dataclass(frozen=True, slots=True)
class Extremes:
    """Largest and smallest value of some quantities and when first attained.

    Parameters
    ----------
    maximum, minimum : ndarray, shape (k,)
        The values.
    time_of_maximum, time_of_minimum : ndarray, shape (k,)
        Times of their first attainment (s).
    """

    maximum: Floats
    time_of_maximum: Floats
    minimum: Floats
    time_of_minimum: Floats

    def at(self, place: Any) -> Extremes:
        """Extremes at some places of the arrays, as an index of them says."""
        return Extremes(*(getattr(self, name)[place] for name in self.__slots__))

    def put(self, place: Any, found: Extremes) -> None:
        """Overwrite those at some places of the arrays."""
        for name in self.__slots__:
            getattr(self, name)[place] = getattr(found, name)


@dataclass(frozen=True, slots=True)
class Work:
    """What a run cost.

    Parameters
    ----------
    rhs, jacobian : int
        Evaluations of the right-hand side and of its Jacobian.
    steps, restarts : int
        Accepted steps, and starts of the integrator after the first.
    seconds : float
        Wall time, without that of compilation.
    compilation : float
        Wall time in which kernels were loaded or, at a first run, compiled (s).
    """

    rhs: int = 0
    jacobian: int = 0
    steps: int = 0
    restarts: int = 0
    seconds: float = 0.0
    compilation: float = 0.0


@dataclass(frozen=True, slots=True)
class Energy:
    """The energy ledger (J).

    ``initial + input + Σ supports = kinetic + elastic + hysteretic + viscous + impact + friction``

    Parameters
    ----------
    initial, input : float
        Energy at the start, and what the ground motion and forces put in.
    kinetic, elastic : float
        Stored at the end; elastic holds the springs' ``k x`` parts.
    hysteretic, viscous : float
        Work done on the ``Q z`` parts and in the dashpots.
    impact : float
        Kinetic energy lost in impacts.
    closure : float
        Difference of the two sides divided by the largest term, or by the
        scene's own energy m L²/T² where that is larger.
    supports : tuple of float
        What each support put in, ``∫ R s' dt`` with the impulses of its contacts; of every support
        of the scene, zero of those that move with the ground.
    friction : float
        Work of friction where bodies touch, that in impacts apart.
    """

    initial: float
    input: float
    kinetic: float
    elastic: float
    hysteretic: float
    viscous: float
    impact: float
    closure: float
    supports: tuple[float, ...] = ()
    friction: float = 0.0


@dataclass(frozen=True, slots=True)
class Drift:
    """How far resting contacts left their constraints, at the end of any step.

    Parameters
    ----------
    gap, gap_rate : float
        Largest size of a gap over the scene's length L, and of its rate over L/T.
    """

    gap: float
    gap_rate: float


@dataclass(frozen=True, slots=True)
class SupportHistory:
    """Where the supports of a scene are, relative to the ground, row by row of its history.

    Parameters
    ----------
    s, sv : ndarray, shape (n, number of supports)
        Displacement (m) and velocity (m/s), exact.
    force : ndarray, shape (n, number of supports)
        Sum of the forces of springs, dashpots and contacts on it, positive to the right (N);
        impulses are none.
    """

    s: Floats
    sv: Floats
    force: Floats


@dataclass(frozen=True, slots=True)
class LawRecording:
    """What contacts with a law of their own did, shape (K,); zero under Newton's law.

    Parameters
    ----------
    smallest_force : ndarray
        Smallest force, not above zero (N).
    longest_contact : ndarray
        Longest time in contact (s).
    """

    smallest_force: Floats
    longest_contact: Floats


@dataclass(frozen=True, eq=False)
class FrictionRecording:
    """What friction did at each contact, shape (K,) each.

    Parameters
    ----------
    path : ndarray
        Way slid while closed (m).
    work : ndarray
        Energy that it took, in impacts too (J).
    impulse, tangential : ndarray
        Largest normal and tangential impulse of an impact (N s).
    """

    path: Floats
    work: Floats
    impulse: Floats
    tangential: Floats


class Stick(NamedTuple):
    """When a slider begins to stick, or no longer does.

    t: time (s). spring: position in ``scene.springs``. begins: whether it sticks from then on.
    """

    t: float
    spring: int
    begins: bool


@dataclass(frozen=True, slots=True)
class Recording:
    """Everything a solver returns.

    Parameters
    ----------
    success : bool
        False where the run ended before its time; then what was computed up
        to there is in the other fields.
    message : str
        One sentence.
    t, u, v, z : float and ndarray
        Final time (s) and state.
    history : History
        Samples at the output times and events.
    events : tuple of Event
        In order of time.
    displacement, elongation, acceleration : Extremes
        Of the bodies (N,), the springs (S,) and of the absolute acceleration
        of the bodies between impacts (N,); located, not sampled.
    base_shear : Extremes
        Of the sum of the forces of springs and dashpots to the ground (1,).
    smallest_gap : ndarray, shape (K,)
        Smallest value of each gap (m).
    resting_time, max_force : ndarray, shape (K,)
        Time each contact rested (s), largest force while resting (N).
    unique_forces : ndarray of bool, shape (K,)
        False for a contact whose force was, at some time, not unique.
    work : Work
        Cost.
    energy : Energy, optional
        Where the ledger was asked for.
    drift : Drift, optional
        Where the solver keeps resting contacts closed by equations; None
        where their bodies share a coordinate and no gap can open.
    supports : SupportHistory, optional
        Where the scene has supports.
    laws : LawRecording, optional
        Where contacts have laws of their own.
    integrated : float, optional
        Time for which the integrator of the solver carried the motion (s), a local series after
        events the rest of it; None where the solver has one way only.
    largest_gap : ndarray, shape (K,), optional
        Largest value of each gap (m).
    sticks : tuple of Stick
        Of sliders, in order of time.
    slides : tuple of Event
        Where contacts with friction begin to stick or to slip, in order of time.
    unique_z : ndarray of bool, shape (H,), optional
        False for the z of a slider whose friction was, at some time, not unique; None where the
        scene has no sliders.
    friction : FrictionRecording, optional
        Where contacts have friction.
    """

    success: bool
    message: str
    t: float
    u: Floats
    v: Floats
    z: Floats
    history: History
    events: tuple[Event, ...]
    displacement: Extremes
    elongation: Extremes
    acceleration: Extremes
    base_shear: Extremes
    smallest_gap: Floats
    resting_time: Floats
    max_force: Floats
    unique_forces: np.ndarray
    work: Work
    energy: Energy | None = None
    drift: Drift | None = None
    supports: SupportHistory | None = None
    laws: LawRecording | None = None
    integrated: float | None = None
    largest_gap: Floats | None = None
    sticks: tuple[Stick, ...] = ()
    slides: tuple[Event, ...] = ()
    unique_z: np.ndarray | None = None
    friction: FrictionRecording | None = None

    def of_bodies(self, own: slice) -> Recording:
        """The same of some of its bodies."""
        h = self.history
        return replace(
            self,
            u=self.u[own],
            v=self.v[own],
            history=replace(h, u=h.u[:, own], v=h.v[:, own], a=h.a[:, own]),
            displacement=self.displacement.at(own),
            acceleration=self.acceleration.at(own),
        )


class ReadyTask(Protocol):
    """A task that is run with other numbers than those of its scene, again and again."""

    def run(self, values: Mapping[Place, float], task: Task) -> Callable[[], Recording]:
        """Run it.

        Parameters
        ----------
        values : mapping
            New numbers (SI), but for those of the motion. They are checked.
        task : Task
            The same task with the times, and the motion of the scene, of this run.

        Returns
        -------
        callable
            Makes the recording, which `solve` would return, when it is asked for. A failure
            is raised at once.
        """
        ...


class Solver(Protocol):
    """Duties of a solver.

    1. `name`: the word a case and the command line call it by.
    2. `summary`: one line for ``eventpound solvers``.
    3. `settings`: the keys of ``[solver]`` it understands, each with a line.
    4. `solve(task)`: carry the scene from start to end and return a
       `Recording`; a failure is a `ComputationError` that keeps what was
       computed, never a wrong answer.

    A solver that heeds `Task.max_steps` says so by an attribute ``counts_steps = True``;
    any other is never given one. One that takes scenes with supports and forces says so by
    ``takes_supports = True``, with forces alone by ``takes_forces = True``; one that takes
    friction at contacts by ``takes_friction = True``, by other laws of impact than Newton's by
    ``impact_laws``, a collection of `eventpound.scene.contact_law.IMPACT_LAWS`.
    One that knows laws of contacts besides Newton's names them in
    an attribute ``contact_laws``, a collection of `eventpound.scene.contact_law.ContactLaw` kinds;
    scenes with others are refused. One that takes ends at points between bodies, with more
    than two bodies in a column of W, says so by ``takes_points = True``. One that knows spring laws
    whose memory has branches or a second number (`eventpound.scene.spring.Hysteretic`) has their
    words in an attribute ``memories``. One that keeps `Recording.sticks`, and in the history the
    state before and after the end of each branch, says so by ``lists_springs = True``.
    One that can do once what many runs of a scene have in common has a function ``ready(task)``,
    which returns a `ReadyTask`, or None for a scene of which it cannot.
    """

    @property
    def name(self) -> str:
        """Duty 1."""
        ...

    @property
    def summary(self) -> str:
        """Duty 2."""
        ...

    @property
    def settings(self) -> Mapping[str, str]:
        """Duty 3."""
        ...

    def solve(self, task: Task) -> Recording:
        """Duty 4."""
        ...
