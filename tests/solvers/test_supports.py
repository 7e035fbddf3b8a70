"""Supports that move apart and forces on bodies, against what is known of them otherwise."""

import math
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from eventpound import ComputationError, ContactLaw, InputError, simulate_many
from eventpound.case.defaults import default_duration
from eventpound.motion import Harmonic, NoMotion, Record, Ricker, Sine
from eventpound.motion.constant import Constant, PhasedSine
from eventpound.motion.delayed import travelled
from eventpound.results.run_files import summarise
from eventpound.scene import (
    BARRIER,
    GROUND,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Force,
    Linear,
    Point,
    Scene,
    Spring,
    Support,
)
from eventpound.scene.check import check_scene
from eventpound.scene.pi_terms import pi_terms
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Extremes, Recording, Task
from tests.properties.transforms import scaled
from tests.solvers.scenes import pounding_pair
from tests.solvers.ways import WAYS, directly_and_by

SOLVERS = ("cvode", "ida", "fast")


def run(
    scene: Scene, end: float, solver: str, rtol: float = 1e-12, *, energy: bool = False
) -> Recording:
    times = np.linspace(0.0, end, 301)
    return solver_named(solver).solve(
        Task(scene, 0.0, end, rtol, output_times=times, energy=energy)
    )


def after_sine(t: np.ndarray, a: float, period: float, omega: float) -> np.ndarray:
    """Displacement of an undamped oscillator whose foot a sine pulse moves, in space."""
    w = 2.0 * np.pi / period
    r = w**2 / (omega**2 - w**2)

    def within(s: Any) -> tuple[Any, Any]:
        y = (
            a / w * s
            - a / w**2 * (1.0 + r) * np.sin(w * s)
            + a / (w * omega) * r * np.sin(omega * s)
        )
        v = a / w - a / w * (1.0 + r) * np.cos(w * s) + a / w * r * np.cos(omega * s)
        return y, v

    y_end, v_end = within(period)
    later, rest = t - period, a * period / w
    free = rest + (y_end - rest) * np.cos(omega * later) + v_end / omega * np.sin(omega * later)
    return np.where(t <= 0.0, 0.0, np.where(t <= period, within(t)[0], free))


class DeckBetween(NamedTuple):
    """A deck on springs between the ground and a pier that a sine pulse reaches later, SI units.

    `a`, `period`: of the pulse. `delay`: of the pier. `part` of the stiffness stands on the ground.
    """

    a: float = 3.0
    period: float = 0.5
    delay: float = 0.2
    part: float = 0.4
    omega: float = 2.0 * np.pi / 0.7
    mass: float = 1000.0

    @property
    def motion(self) -> Sine:
        return Sine(self.a, self.period)

    @property
    def stiffness(self) -> float:
        return self.mass * self.omega**2

    def scene(self, *others: Support) -> Scene:
        """With other supports before the pier."""
        k = self.stiffness
        return Scene(
            (Body("deck", self.mass),),
            (
                Spring("near", (GROUND, "deck"), Linear(self.part * k)),
                Spring("far", ("deck", "pier"), Linear((1.0 - self.part) * k)),
            ),
            motion=self.motion,
            supports=(*others, Support("pier", self.delay)),
        )

    def displacement(self, t: np.ndarray) -> np.ndarray:
        """What it is exactly, relative to the ground."""
        near, far = (after_sine(x, self.a, self.period, self.omega) for x in (t, t - self.delay))
        return self.part * near + (1.0 - self.part) * far - self.motion.displacement(t)


@pytest.mark.parametrize(("solver", "allowed"), [("fast", 1e-12), ("cvode", 3e-11), ("ida", 3e-11)])
def test_oscillator_between_two_supports(solver, allowed):
    deck = DeckBetween()
    motion, delay = deck.motion, deck.delay
    recording = run(deck.scene(), 3.0, solver, 1e-14 if solver == "fast" else 1e-13)
    t = recording.history.t
    exact = deck.displacement(t)
    u = recording.history.u[:, 0]
    assert np.abs(u - exact).max() <= allowed * np.abs(exact).max()
    # A sine pulse leaves both supports equally far away.
    s = recording.supports.s[:, 0]
    assert np.allclose(
        s, motion.displacement(t - delay) - motion.displacement(t), rtol=0, atol=1e-16
    )
    assert abs(s[-1]) < 1e-15 < np.abs(s).max()


@pytest.mark.parametrize("solver", SOLVERS)
def test_no_delay_is_no_support(solver):
    def named(end: str) -> str:
        return "pier" if end in (GROUND, BARRIER) else end

    plain = pounding_pair()
    scene = replace(
        plain,
        supports=(Support("pier", 0.0),),
        springs=tuple(replace(s, between=tuple(map(named, s.between))) for s in plain.springs),
        contacts=tuple(
            replace(c, left=named(c.left), right=named(c.right)) for c in plain.contacts
        ),
    )
    one, other = (run(x, 3.0, solver, 1e-9).history for x in (plain, scene))
    for key in ("t", "ground", "u", "v", "a", "z", "force", "gap", "contact_force"):
        assert np.array_equal(getattr(one, key), getattr(other, key)), key


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_delay_of_no_motion_is_no_support(solver):
    """Where nothing moves the supports, a body swings as on the ground; none has an energy."""
    spring, body = Spring("s", ("pier", "a"), Linear(40.0)), Body("a", 1.0, 0.1)
    moved = Scene((body,), (spring,), supports=(Support("pier", 0.3),))
    still = Scene((body,), (replace(spring, between=(GROUND, "a")),))
    one, two = (run(scene, 2.0, solver, 1e-9) for scene in (moved, still))
    assert np.abs(one.history.u - two.history.u).max() <= 1e-8


def pounding_on_two() -> Scene:
    """Two yielding decks, one on the ground, one on a pier that moves otherwise."""
    return Scene(
        (Body("a", 1.2, 0.01, 0.05), Body("b", 3.0, -0.02)),
        (
            Spring("frame a", (GROUND, "a"), BoucWen(20.0, 4.0, 0.03, 20.0)),
            Spring("frame b", ("b", "pier"), BoucWen(90.0, 6.0, 0.02, 2.0, 0.3, 0.7, 0.1)),
        ),
        (Dashpot((GROUND, "a"), 0.3), Dashpot(("a", "b"), 0.1)),
        (
            Contact("left", BARRIER, "a", 0.07, 0.4),
            Contact("joint", "a", "b", 0.04, 0.7),
            Contact("right", "b", "pier", 0.06, 0.0),
        ),
        Ricker(5.0, 1.1, center=1.3),
        (Support("pier", motion=Ricker(4.0, 0.9, center=1.45)),),
    )


@pytest.mark.parametrize("solver", SOLVERS)
def test_another_reference(solver):
    """The pier chosen as the reference changes u by the difference of the displacements."""
    scene = pounding_on_two()
    pier, ground = scene.supports[0].motion, scene.motion
    assert pier is not None

    def turned(end: str) -> str:
        swapped = {"pier": GROUND, GROUND: "ground 1", BARRIER: "ground 1"}
        return swapped.get(end, end)

    def at_contact(end: str) -> str:
        return BARRIER if end == "pier" else turned(end)

    (d, v), (d_0, v_0) = (travelled(m, np.array(0.0)) for m in (ground, pier))
    shift, rate = float(d - d_0), float(v - v_0)
    other = replace(
        scene,
        bodies=tuple(
            replace(b, displacement=b.displacement + shift, velocity=b.velocity + rate)
            for b in scene.bodies
        ),
        springs=tuple(replace(s, between=tuple(map(turned, s.between))) for s in scene.springs),
        dashpots=tuple(replace(x, between=tuple(map(turned, x.between))) for x in scene.dashpots),
        contacts=tuple(
            replace(c, left=at_contact(c.left), right=at_contact(c.right)) for c in scene.contacts
        ),
        motion=pier,
        supports=(Support("ground 1", motion=ground),),
    )
    one, two = run(scene, 4.0, solver, 1e-11), run(other, 4.0, solver, 1e-11)
    assert len(one.events) == len(two.events) >= 4
    for x, y in zip(one.events, two.events, strict=True):
        assert (x.kind, x.contact) == (y.kind, y.contact)
        assert abs(x.t - y.t) <= 1e-8
    first, second = _at_outputs(one), _at_outputs(two)
    t = np.linspace(0.0, 4.0, 301)
    shifts = travelled(ground, t)[0] - travelled(pier, t)[0]
    assert np.abs(second - first - shifts[:, None]).max() <= 1e-8 * np.abs(first).max()


def _at_outputs(recording: Recording) -> np.ndarray:
    """Displacements at the output times, the first line of each."""
    t = np.linspace(0.0, 4.0, 301)
    place = np.searchsorted(recording.history.t, t)
    assert np.array_equal(recording.history.t[place], t)
    return recording.history.u[place]


@pytest.mark.parametrize("solver", SOLVERS)
def test_resting_on_a_support(solver):
    """A body that a force presses on a support moves with it until that falls away too fast."""
    push, a, period = 2.0, 3.0, 1.0
    scene = Scene(
        (Body("a", 4.0),),
        contacts=(Contact("seat", "pier", "a", 0.0, 0.0),),
        forces=(Force("a", f"-{push} m/s^2"),),
        supports=(Support("pier", motion=Sine(a, period, reverse=True)),),
    )
    recording = run(scene, 0.5, solver, 1e-12)
    (leaving,) = [e for e in recording.events if e.kind is EventKind.DETACHMENT]
    # a sin(wt) = push: then the support falls faster than the push can follow.
    t = math.asin(push / a) * period / (2.0 * math.pi)
    assert abs(leaving.t - t) <= 1e-10
    h, s = recording.history, recording.supports.s[:, 0]
    resting = h.t < t
    assert np.abs(h.u[resting, 0] - s[resting]).max() <= 1e-13
    expected = 4.0 * (push - a * np.sin(2.0 * math.pi * h.t[resting] / period))
    assert np.abs(h.contact_force[resting, 0] - expected).max() <= 1e-9
    free = s[resting][-1]
    assert h.u[-1, 0] > s[-1] + 0.01 > free - 1.0


@pytest.mark.parametrize("rtol", [1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_turn_in_the_middle_of_a_time_step(solver, rtol):
    """A body that rests on one support turns from another where their velocities are equal."""
    samples = np.repeat([0.0, -3.0, 0.0, 3.0], [1, 26, 12, 26])
    scene = Scene(
        (Body("a", 1.0),),
        (Spring("tie", ("far", "a"), Linear(1.0)),),
        contacts=(Contact("seat", "a", "near", 0.0, 0.0),),
        motion=Record(samples, 0.02),
        supports=(Support("far", 0.5), Support("near", 0.1)),
        forces=(Force("a", "20 m/s^2"),),
    )
    found, t = run(scene, 1.2, solver, rtol).elongation, 0.95
    near, far = (scene.motion.displacement(np.array([t - s.delay])) for s in scene.supports[::-1])
    assert found.minimum == pytest.approx(near - far, rel=1e-12)
    assert found.time_of_minimum == pytest.approx(t, abs=1e-6)


@pytest.mark.parametrize(("solver", "allowed"), [("cvode", 1e-14), ("ida", 1e-8), ("fast", 1e-9)])
def test_a_support_is_where_its_history_has_it_at_any_tolerance(solver, allowed):
    """What rests on it is there with it, in ida up to Newton's iteration, in fast one step.

    Were it integrated it would be 5e-5 m away.
    """
    scene = Scene(
        (Body("a", 4.0),),
        contacts=(Contact("seat", "pier", "a", 0.0, 0.0),),
        forces=(Force("a", "-20 m/s^2"),),
        supports=(Support("pier", motion=Harmonic(4.0, 1.0)),),
    )
    recording = run(scene, 20.0, solver, 1e-5)
    h, s, rate = recording.history, recording.supports.s[:, 0], recording.supports.sv[:, 0]
    # It goes 12.7 m in the end.
    assert np.abs(h.u[:, 0] - s).max() <= allowed * s[-1]
    assert np.abs(h.v[:, 0] - rate).max() <= 10.0 * allowed * s[-1]


class PressedOn(NamedTuple):
    """A yielding body, pressed against a pier that the ground motion reaches later."""

    exponent: float
    a: float = 3.0
    period: float = 1.0
    delay: float = 0.2
    push: float = 0.75
    pull: float = 0.75
    u_y: float = 0.01
    gap: float = 0.002

    def scene(self) -> Scene:
        """Of a mass of 1 kg."""
        return Scene(
            (Body("deck", 1.0),),
            (Spring("pier", (GROUND, "deck"), BoucWen(0.0, self.pull, self.u_y, self.exponent)),),
            contacts=(Contact("seat", "deck", "support", self.gap, 0.0),),
            motion=Sine(self.a, self.period),
            supports=(Support("support", self.delay),),
            forces=(Force("deck", Constant(self.push)),),
        )

    def ground(self, t: float) -> float:
        """Its acceleration (m/s²)."""
        inside = 0.0 <= t <= self.period
        return self.a * math.sin(2.0 * math.pi * t / self.period) if inside else 0.0

    def place(self, t: float) -> tuple[float, float]:
        """Displacement (m) and velocity (m/s) of the support relative to the ground."""
        (d, v), (late, late_v) = (
            travelled(Sine(self.a, self.period), np.array(x)) for x in (t, t - self.delay)
        )
        return float(late - d), float(late_v - v)

    def z_rate(self, v: float, z: float) -> float:
        """Rate of z (1/s)."""
        n = self.exponent
        bend = 0.5 * abs(v) * z * abs(z) ** (n - 1.0) + 0.5 * v * abs(z) ** n
        return (v - bend) / self.u_y

    def detachment(self) -> float:
        """When the pier lets the deck go, by SciPy alone (s)."""

        def free(t: float, y: np.ndarray) -> list[float]:
            u, v, z = y
            del u
            return [v, self.push - self.pull * z - self.ground(t), self.z_rate(v, z)]

        def closes(t: float, y: np.ndarray) -> float:
            return float(self.gap + self.place(t)[0] - y[0])

        def held(t: float, y: np.ndarray) -> list[float]:
            return [self.z_rate(self.place(t)[1], y[0])]

        def force(t: float, y: np.ndarray) -> float:
            return float(self.push - self.pull * y[0] - self.ground(t - self.delay))

        closes.terminal = force.terminal = True
        exact: dict[str, Any] = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13, "max_step": 2e-3}
        first = solve_ivp(free, (0.0, 1.0), [0.0, 0.0, 0.0], events=closes, **exact)
        (t, (*_, z)) = first.t[-1], first.y[:, -1]
        assert first.status == 1
        second = solve_ivp(held, (t, 1.0), [z], events=force, **exact)
        assert second.status == 1
        return float(second.t[-1])


@pytest.mark.parametrize("exponent", [2.0, 20.0])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_spring_that_yields_at_a_support(solver, exponent):
    """It moves nobody: what it does to the force of the contact is all that tells when it parts."""
    pressed = PressedOn(exponent)
    recording = run(pressed.scene(), 0.6, solver, 1e-10)
    (leaving,) = [e for e in recording.events if e.kind is EventKind.DETACHMENT]
    assert abs(leaving.t - pressed.detachment()) <= 1e-8
    assert recording.history.contact_force.min() >= -1e-9


@pytest.mark.parametrize("gap", [0.01, 0.02, 0.03])
def test_a_support_is_put_in_its_place_with_what_it_carries(gap):
    """Its motion errs by a tolerance, which is taken back where the next piece of it begins."""
    scene = Scene(
        (Body("deck", 5e5),),
        (Spring("frame", (GROUND, "deck"), Linear(2e7)),),
        contacts=(Contact("joint", "deck", "abutment", gap, 0.5),),
        motion=Sine(3.0, 0.8),
        supports=(Support("abutment", 0.1),),
    )
    loose, close = (run(scene, 3.0, "fast", rtol) for rtol in (1e-5, 1e-9))
    assert loose.success
    assert np.abs(loose.displacement.maximum - close.displacement.maximum).max() <= 1e-6


def test_a_spring_that_yields_on_a_heavy_body():
    """Its force is nothing to the two together, and all that parts them."""
    heavy, omega = 1e7, 7.702782177955612
    scene = Scene(
        (Body("light", 1.0), Body("heavy", heavy)),
        (
            Spring("bent", (GROUND, "light"), BoucWen(0.0, 0.5450713416, 0.0286135351, 5.0)),
            Spring("stiff", (GROUND, "heavy"), Linear(heavy * omega**2)),
        ),
        contacts=(Contact("seat", "light", "heavy", 0.002, 0.0),),
        motion=Sine(3.0, 1.0),
        forces=(Force("light", 1.27957863),),
    )
    (one, other) = (
        [e.t for e in run(scene, 1.0, solver, 1e-9).events if e.kind is EventKind.DETACHMENT]
        for solver in ("fast", "ida")
    )
    assert len(one) == len(other) > 0
    assert np.abs(np.subtract(one, other)).max() <= 1e-9


@pytest.mark.parametrize("end", [BARRIER, "pier"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_force_quicker_than_all_that_moves(solver, end):
    """No body moves with it, so no error of a step shows it; the force of the contact does."""
    slow, quick, period, a, of_pier = 0.6, 0.5, 0.05, 0.1, 8.0
    supports = (Support("pier", motion=Sine(a, of_pier)),) if end == "pier" else ()
    scene = Scene(
        (Body("pressed", 1.0), Body("slow", 1.0, displacement=0.1)),
        (Spring("soft", (GROUND, "slow"), Linear(1.0)),),
        contacts=(Contact("seat", end, "pressed", 0.0, 0.0),),
        supports=supports,
        forces=(
            Force("pressed", Constant(-1.0)),
            Force("pressed", PhasedSine(slow, 8.0, False, -8.0, None, 0.0)),
            Force("pressed", PhasedSine(quick, period, False, -1.0, None, 0.0)),
        ),
    )
    recording = run(scene, 1.5, solver, 1e-6)

    def force(t: Any) -> Any:
        lifted = a * np.sin(2.0 * np.pi * t / of_pier) if supports else 0.0
        lifts = slow * np.sin(0.25 * np.pi * t) + quick * np.sin(2.0 * np.pi * t / period)
        return 1.0 + lifted - lifts

    t = np.linspace(0.0, 1.5, 15001)
    down = np.flatnonzero(force(t) < 0.0)
    leaving = [e.t for e in recording.events if e.kind is EventKind.DETACHMENT]
    first = 1.5
    if down.size:
        first = brentq(force, t[down[0] - 1], t[down[0]], xtol=1e-14)
        assert abs(leaving[0] - first) <= 1e-9
    else:
        assert leaving == []
    largest = force(t[t < first]).max()
    assert -1e-9 <= recording.max_force[0] - largest <= 1e-4


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_record_quicker_than_all_that_moves(solver):
    """A force that lifts a body off between two steps of everything else."""
    lifts, dt = np.zeros(160), 0.01
    lifts[100:103] = 0.0, 1.2, 0.0
    scene = Scene(
        (Body("pressed", 1.0), Body("slow", 1.0, displacement=0.1)),
        (Spring("soft", (GROUND, "slow"), Linear(1.0)),),
        contacts=(Contact("seat", "pier", "pressed", 0.0, 0.0),),
        supports=(Support("pier", motion=Sine(0.1, 8.0)),),
        forces=(Force("pressed", Constant(-1.0)), Force("pressed", Record(lifts, dt))),
    )
    recording = run(scene, 1.5, solver, 1e-5)
    (leaving,) = [e for e in recording.events if e.kind is EventKind.DETACHMENT]

    def force(t: float) -> float:
        return 1.0 + 0.1 * math.sin(0.25 * math.pi * t) - 1.2 * (t - 1.0) / dt

    assert abs(leaving.t - brentq(force, 1.0, 1.01, xtol=1e-14)) <= 1e-9


@pytest.mark.parametrize("solver", SOLVERS)
def test_column_of_beads(solver):
    """Beads that fall in a row, followed from impact to impact by their parabolas."""
    g, e, mass = 9.81, (0.9, 0.8, 0.7), np.array([1.0, 2.0, 1.5])
    gaps = np.array([0.1, 0.05, 0.02])
    scene = Scene(
        tuple(Body(f"b{i}", float(m)) for i, m in enumerate(mass)),
        contacts=tuple(
            Contact(f"c{i}", BARRIER if i == 0 else f"b{i - 1}", f"b{i}", float(gaps[i]), e[i])
            for i in range(3)
        ),
        forces=tuple(Force(f"b{i}", f"-{g} m/s^2") for i in range(3)),
    )
    recording = run(scene, 0.6, solver, 1e-12)
    impacts = [(x.t, x.contact) for x in recording.events if x.kind is EventKind.IMPACT]
    t, u, v = 0.0, np.zeros(3), np.zeros(3)
    for found, contact in impacts[:12]:
        times = []
        for j in range(3):
            gap = gaps[j] + u[j] - (u[j - 1] if j else 0.0)
            rate = v[j] - (v[j - 1] if j else 0.0)
            if j == 0:
                times.append((rate + math.sqrt(rate * rate + 2.0 * g * max(gap, 0.0))) / g)
            else:
                times.append(-gap / rate if rate < 0.0 else math.inf)
        j = int(np.argmin(times))
        h = times[j]
        t, u, v = t + h, u + v * h - 0.5 * g * h * h, v - g * h
        assert j == contact
        assert abs(t - found) <= 1e-9 * t
        rate = v[j] - (v[j - 1] if j else 0.0)
        impulse = -(1.0 + e[j]) * rate / (1.0 / mass[j] + (1.0 / mass[j - 1] if j else 0.0))
        v[j] += impulse / mass[j]
        if j:
            v[j - 1] -= impulse / mass[j - 1]


def stepped(t: np.ndarray, p: float, omega: float) -> np.ndarray:
    return p / omega**2 * (1.0 - np.cos(omega * t))


def shaken(t: np.ndarray, p: float, omega: float) -> np.ndarray:
    """Undamped response to ``p sin(W t + phase)`` from rest, W = 5, phase = 0.6."""
    w, phase = 5.0, 0.6
    r = p / (omega**2 - w**2)
    free = -np.sin(phase) * np.cos(omega * t) - w / omega * np.cos(phase) * np.sin(omega * t)
    return np.asarray(r * (np.sin(w * t + phase) + free))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("history", "exact"),
    [(Constant(3.0), stepped), (PhasedSine(3.0, 2.0 * np.pi / 5.0, phase=0.6), shaken)],
    ids=["constant", "phased"],
)
def test_forced_oscillator(solver, history, exact):
    mass, omega = 2.0, 7.0
    scene = Scene(
        (Body("m", mass),),
        (Spring("k", (GROUND, "m"), Linear(mass * omega**2)),),
        forces=(Force("m", history),),
    )
    recording = run(scene, 4.0, solver, 1e-12)
    expected = exact(recording.history.t, 3.0 / mass, omega)
    allowed = 1e-12 if solver == "fast" else 3e-10
    assert np.abs(recording.history.u[:, 0] - expected).max() <= allowed * np.abs(expected).max()
    assert np.abs(recording.history.a[0, 0] - history.acceleration(np.array(0.0)) / mass) <= 1e-12


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_record_as_a_force(solver):
    """``-m a_g`` as a force on every body is the ground motion itself, in absolute measure."""
    samples = 8.0 * np.random.default_rng(3).normal(size=60)
    shake = Record(samples, 0.05)
    scene = replace(pounding_pair(), motion=NoMotion())
    forces = tuple(Force(b.name, Record(samples, 0.05, reverse=True), True) for b in scene.bodies)
    pushed = run(replace(scene, forces=forces), 3.5, solver, 1e-11)
    shaken_ = run(replace(scene, motion=shake), 3.5, solver, 1e-11)
    assert len(pushed.events) == len(shaken_.events) > 2
    scale = np.abs(shaken_.history.u).max()
    assert np.abs(pushed.u - shaken_.u).max() <= 1e-8 * scale
    assert np.abs(pushed.displacement.maximum - shaken_.displacement.maximum).max() <= 1e-8 * scale


@pytest.mark.parametrize("solver", ["cvode", "ida"])
@pytest.mark.parametrize("way", WAYS)
def test_other_ways_into_sundials(solver, way, monkeypatch):
    scene = replace(pounding_on_two(), forces=(Force("a", "-0.5 m/s^2"),))
    direct, other = directly_and_by(way, Task(scene, 0.0, 3.0, 1e-8), solver, monkeypatch)
    assert len(direct.events) >= 3
    scale = np.abs(direct.displacement.maximum).max()
    assert np.abs(other.u - direct.u).max() <= 1e-6 * scale


def test_an_element_at_a_support():
    """A stiff element between a deck and a support is a spring to it while it is pressed."""
    support = Support("pier", motion=Sine(3.0, 0.8, reverse=True))
    element = Contact("seat", "pier", "a", 0.0, None, ContactLaw("linear", 900.0))
    scene = Scene(
        (Body("a", 2.0, -0.05),),
        contacts=(element,),
        forces=(Force("a", -45.0),),
        supports=(support,),
    )
    spring = Spring("seat", ("pier", "a"), Linear(900.0))
    other = replace(scene, contacts=(), springs=(spring,))
    one, two = (run(x, 1.2, "cvode", 1e-10) for x in (scene, other))
    # 45 N press it to 5 cm, and the support moves too little to let it go.
    assert one.history.gap.max() < 0.0
    scale = np.abs(two.displacement.minimum).max()
    assert np.abs(one.u - two.u).max() <= 1e-8 * scale
    assert np.abs(one.displacement.minimum - two.displacement.minimum).max() <= 1e-8 * scale


def test_supports_that_close_in():
    scene = Scene(
        (Body("a", 1.0),),
        contacts=(
            Contact("left", BARRIER, "a", 0.01, 0.5),
            Contact("right", "a", "pier", 0.01, 0.5),
        ),
        motion=Sine(2.0, 1.0),
        supports=(Support("pier", motion=Sine(1.0, 1.0)),),
    )
    for solver in ("cvode", "fast"):
        with pytest.raises(ComputationError, match=r"at t = .*close in.*left, right.*no\s+motion"):
            run(scene, 2.0, solver, 1e-9)


@pytest.mark.parametrize("way", ["squeezed", "free", "apart"])
def test_supports_close_in_on_levers(way):
    """A point half on the pier, half on a body that the ground holds, presses another at a wall."""
    contacts = (
        Contact("lever", Point({"pier": 0.5, "held": 0.5}), "a", 0.0, 0.0),
        Contact("wall", "a", BARRIER, 0.0, 0.0),
        Contact("hold", BARRIER, "held", 0.0 if way == "squeezed" else 9.0, 0.0),
        Contact("beside", "held", "b", 0.0, 0.0),
    )
    scene = Scene(
        tuple(Body(name, 1.0) for name in ("a", "held", "b")),
        contacts=contacts,
        motion=NoMotion(),
        supports=(Support("pier", motion=Sine(1.0, 1.0, reverse=way == "apart")),),
    )
    if way != "squeezed":
        assert response_of(scene, "fast", 1e-6, duration=0.2).recording.success
        return
    with pytest.raises(ComputationError, match=r"close in .*\(lever, wall, hold\)"):
        response_of(scene, "fast", 1e-6, duration=0.2)


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
@pytest.mark.parametrize("reverse", [False, True])
def test_supports_close_in_only_where_they_approach(solver, reverse):
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0, 0.1)),
        (Spring("swing", (GROUND, "b"), Linear(400.0)),),
        contacts=(Contact("left", BARRIER, "a", 0.0, 0.5), Contact("right", "a", "pier", 0.0, 0.5)),
        motion=NoMotion(),
        supports=(Support("pier", motion=Sine(1.0, 1.0, reverse=reverse, start=0.5)),),
    )
    # The joints are closed, but nothing moves them yet.
    with pytest.raises(ComputationError, match="limit of 1 steps"):
        response_of(scene, solver, 1e-6, duration=1.0, max_steps=1)
    if not reverse:
        assert response_of(scene, solver, 1e-6, duration=1.0).recording.success
        return
    with pytest.raises(ComputationError, match=r"t = 0\.5.*close in.*left, right"):
        response_of(scene, solver, 1e-6, duration=1.0)


def closed_beside(order: tuple[str, str], support: Support) -> Scene:
    """A deck on a pier, its joint with an abutment closed as a wavelet of 0.5 s comes at 3 s."""
    return Scene(
        (Body("deck", 1e5),),
        (Spring("pier", (GROUND, "deck"), Linear(4e6)),),
        contacts=(Contact("joint", *order, 0.0, 0.5),),
        motion=Ricker(2.0, 0.5, center=3.0),
        supports=(support,),
    )


def impacts(recording: Recording) -> list[float]:
    """Times of the impacts that anybody can see (s)."""
    return [e.t for e in recording.events if e.kind is EventKind.IMPACT and e.impulse > 1.0]


@pytest.mark.parametrize("order", [("abutment", "deck"), ("deck", "abutment")])
def test_a_joint_that_is_closed_as_a_tail_begins(order):
    # The tail of the wavelet has moved the support by 1e-156 m as the run begins.
    own = Ricker(1.0, 0.5, center=3.0)
    for support in (Support("abutment", 0.4), Support("abutment", motion=own)):
        scene = closed_beside(order, support)
        check_scene(scene)
        one, *others = (run(scene, 6.0, solver, 1e-9) for solver in SOLVERS)
        assert len(impacts(one)) >= 4
        for other in others:
            assert impacts(other) == pytest.approx(impacts(one), abs=1e-7)


def test_a_joint_that_was_closed_too_far_is_refused():
    scene = closed_beside(("abutment", "deck"), Support("abutment", 0.4))
    late = replace(scene, bodies=(Body("deck", 1e5, -1e-9),))
    with pytest.raises(InputError, match="not penetrated at the start"):
        response_of(late, "fast", duration=1.0)


def test_a_rest_that_no_force_decides_does_not_come_again_for_ever():
    # Where the tail begins to be more than rounding the force is below zero, and no order tells it.
    found = run(closed_beside(("deck", "abutment"), Support("abutment", 0.4)), 6.0, "cvode", 1e-8)
    assert len(impacts(found)) == 6


def test_delays_in_one_call():
    scene = replace(pounding_on_two(), supports=(Support("pier", 0.05),))
    delays = [0.0, 0.03, 0.06]
    many = simulate_many(scene, {"support.pier.delay": delays}, rtol=1e-8)
    for i, delay in enumerate(delays):
        own = replace(scene, supports=(Support("pier", delay),))
        alone = response_of(own, "fast", 1e-8)
        assert alone.task.end == many.t[i]
        assert np.array_equal(many.u[i], alone.recording.u)
    with pytest.raises(InputError, match=r"variant 1 .*delay: found -0.1"):
        simulate_many(scene, {"support.pier.delay": [0.1, -0.1]})


def test_a_run_lasts_until_the_last_motion_has_died_down():
    record = Record(np.ones(11), 0.1)
    scene = Scene(
        (Body("a", 1.0),),
        (Spring("s", ("pier", "a"), Linear(4.0)),),
        motion=record,
        supports=(Support("pier", 0.5),),
    )
    # Five periods after its last sample, 2π/2 s each.
    assert default_duration(scene, 0.0) == pytest.approx(1.5 + 5.0 * math.pi, rel=1e-14)


def test_columns():
    response = response_of(pounding_on_two(), "fast", 1e-6, duration=2.0)
    table = response.history
    assert list(table.columns)[-3:] == ["s.pier", "sv.pier", "sf.pier"]
    gap = 0.06 + table["s.pier"] - table["u.b"]
    assert np.abs(gap - table["gap.right"]).max() < 1e-9
    assert response.quantity("supports.pier.abs_max_shear") > 0.0


@pytest.mark.parametrize("solver", SOLVERS)
def test_forces_on_supports(solver):
    """What stands on pier and ground pushes them by what its mass resists."""
    scene = replace(pounding_on_two(), forces=(Force("b", 70.0),))
    table = response_of(scene, solver, 1e-9, duration=4.0).rows(jumps=False)
    inertia = sum(body.mass * table[f"a.{body.name}"] for body in scene.bodies)
    ground = table["force.frame a"] + 0.3 * table["v.a"] - table["lambda.left"]
    total = table["sf.pier"] + ground + inertia - 70.0
    assert np.abs(total).max() <= 1e-9 * np.abs(table["sf.pier"]).max()
    # Pressed to the pier, its contact carries a part.
    assert table["lambda.right"].max() > 1.0
    bare = -table["force.frame b"]
    assert np.abs(table["sf.pier"] - bare - table["lambda.right"]).max() <= 1e-9


def test_summary_has_base_shears():
    """Of the ground and of each support apart, which the force on a support attains."""
    scene = replace(pounding_on_two(), contacts=pounding_on_two().contacts[:2])
    response = response_of(scene, "fast", 1e-8, duration=4.0, output_step=0.001)
    shear = summarise(response)["supports"]
    table = response.history
    assert shear["pier"]["max_shear"] == pytest.approx(table["sf.pier"].max(), rel=1e-4)
    assert shear["pier"]["max_shear"] >= table["sf.pier"].max() * (1.0 - 1e-12)
    assert shear["pier"]["abs_max_shear"] == response.summary["supports.pier.abs_max_shear"]
    ground = response.summary["base_shear.abs_max"]
    assert ground != pytest.approx(shear["pier"]["abs_max_shear"], rel=0.1)
    still = replace(scene, supports=(Support("pier", 0.0),))
    same = response_of(still, "fast", 1e-8, duration=4.0, output_step=0.001)
    on_pier = same.summary["supports.pier.max_shear"]
    assert on_pier == pytest.approx(same.history["sf.pier"].max(), rel=1e-4)
    # A support that moves with the ground is a part of it.
    both = same.history["sf.pier"] + same.history["force.frame a"] + 0.3 * same.history["v.a"]
    assert same.summary["base_shear.max"] == pytest.approx(both.max(), rel=1e-4)


def larger(scene: Scene, length: float, time: float, mass: float) -> Scene:
    """The scene with other units of length, time and mass, its delays with them."""
    other, _ = scaled(scene, length, time, mass)
    delays = tuple(Support(s.name, (s.delay or 0.0) * time) for s in scene.supports)
    return replace(other, supports=delays)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("factors", [(4.0, 2.0, 8.0), (0.3, 7.0, 90.0)])
def test_complete_similarity(solver, factors):
    """Scenes of one set of Π-terms, that of the delay among them, move alike."""
    length, time, mass = factors
    scene = replace(pounding_on_two(), supports=(Support("pier", 0.15),))
    other = larger(scene, length, time, mass)
    one, two = pi_terms(scene), pi_terms(other)
    assert two == pytest.approx(one, rel=1e-13)
    assert one["delay"] == pytest.approx(0.15 * 2.0 * np.pi / 1.1, rel=1e-14)
    rtol = 1e-10
    first = run(scene, 3.0, solver, rtol)
    second = run(other, 3.0 * time, solver, rtol)
    assert [(e.kind, e.contact) for e in first.events] == [
        (e.kind, e.contact) for e in second.events
    ]
    assert len(first.events) >= 3
    scale = np.abs(first.history.u).max()
    apart = np.abs(second.displacement.maximum / length - first.displacement.maximum).max()
    if all(math.frexp(factor)[0] == 0.5 for factor in factors):
        # Powers of two scale every number exactly, but for roots that are rounded: how far a
        # local series reaches is one.
        assert second.work.steps == first.work.steps
        assert apart <= 1e-11 * scale
        assert np.abs(second.u / length - first.u).max() <= 1e-11 * scale
    else:
        assert apart <= 1e-8 * scale
        assert np.abs(second.u / length - first.u).max() <= 1e-8 * scale


def _sizes(recording: Recording) -> dict[str, tuple[int, ...]]:
    """Shapes of what a recording has of the whole run."""
    found = {field.name: getattr(recording, field.name) for field in fields(recording)}
    sizes = {name: value.shape for name, value in found.items() if isinstance(value, np.ndarray)}
    extremes = {name: value for name, value in found.items() if isinstance(value, Extremes)}
    return sizes | {name: value.maximum.shape for name, value in extremes.items()}


def test_nothing_in_a_recording_is_of_a_support(solver):
    scene = pounding_pair()
    spring, *others = scene.springs
    moved = replace(spring, between=tuple("p" if e == GROUND else e for e in spring.between))
    beside = replace(scene, springs=(moved, *others), supports=(Support("p", 0.1),))
    on_ground, on_support = (
        solver_named(solver).solve(Task(each, 0.0, 1.0, 1e-6)) for each in (scene, beside)
    )
    assert _sizes(on_support) == _sizes(on_ground)
