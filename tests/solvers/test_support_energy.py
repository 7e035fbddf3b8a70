"""Work of supports in the energy ledger, against closed forms and on scenes at random."""

import math
from dataclasses import replace

import numpy as np
import pytest

from eventpound.motion import Ricker, Sine
from eventpound.motion.constant import PhasedSine
from eventpound.results.run_files import summarise
from eventpound.scene import GROUND, Body, Contact, Force, Linear, Scene, Spring, Support
from eventpound.scene.contact_law import ContactLaw
from eventpound.simulation import response_of
from eventpound.solvers.base import EventKind
from tests.solvers.random_scenes import driven_scene
from tests.solvers.test_supports import SOLVERS, DeckBetween, pounding_on_two, run

NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


@pytest.mark.parametrize(("solver", "allowed"), [("fast", 1e-12), ("cvode", 1e-9), ("ida", 1e-9)])
def test_oscillator_between_two_supports(solver, allowed):
    """The pier does ∫ k (s - u) s' dt through its spring, here by Gauss's rule."""
    deck = DeckBetween()
    motion, period, delay = deck.motion, deck.period, deck.delay
    k = (1.0 - deck.part) * deck.stiffness
    energy = run(deck.scene(Support("still", 0.0)), 1.2, solver, 1e-13, energy=True).energy
    expected = put_in = 0.0
    for low, high in ((0.0, delay), (delay, period), (period, period + delay)):
        t = 0.5 * (low + high) + 0.5 * (high - low) * NODES
        w = 0.5 * (high - low) * WEIGHTS
        d, v = motion.displacement(t), motion.velocity(t)
        s, rate = motion.displacement(t - delay) - d, motion.velocity(t - delay) - v
        u, h = deck.displacement(t), 1e-6
        ahead, behind = deck.displacement(t + h), deck.displacement(t - h)
        expected += float(w @ (k * (s - u) * rate))
        put_in -= float(w @ (deck.mass * motion.acceleration(t) * (ahead - behind) / (2.0 * h)))
    assert energy.supports[0] == 0.0
    assert abs(energy.supports[1] - expected) <= allowed * abs(expected)
    # Central differences of u lose half the digits.
    assert abs(energy.input - put_in) <= 1e-8 * abs(put_in)
    assert abs(energy.closure) <= allowed


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_body_carried_by_a_support(solver):
    """What rests on a seat is lifted by it against the force that presses it down."""
    push, a, period, mass = 4.0, 3.0, 1.0, 4.0
    scene = Scene(
        (Body("a", mass),),
        contacts=(Contact("seat", "pier", "a", 0.0, 0.0),),
        forces=(Force("a", f"-{push} m/s^2"),),
        supports=(Support("pier", motion=Sine(a, period, reverse=True)),),
    )
    recording = run(scene, 0.5, solver, 1e-12, energy=True)
    # s' = -a/w (1 - cos wt), at half a period -2 a/w and s = -a/w t.
    w = 2.0 * math.pi / period
    fallen, speed = -a / w * 0.5, -2.0 * a / w
    assert recording.energy.input == pytest.approx(-mass * push * fallen, rel=1e-9)
    work = 0.5 * mass * speed**2 + mass * push * fallen
    assert recording.energy.supports[0] == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_impulses_of_a_support(solver):
    """A ball between impacts at a support that comes on: only those give it energy."""
    scene = Scene(
        (Body("ball", 2.0, 0.0, -1.0),),
        contacts=(Contact("racket", "pier", "ball", 0.3, 0.7),),
        supports=(Support("pier", motion=Sine(3.0, 0.8)),),
    )
    recording = run(scene, 0.7, solver, 1e-12, energy=True)
    (impact,) = [e for e in recording.events if e.kind is EventKind.IMPACT]
    w = 2.0 * math.pi / 0.8
    speed = 3.0 / w * (1.0 - math.cos(w * impact.t))
    after = speed + 0.7 * (1.0 + speed)
    assert recording.v[0] == pytest.approx(after, rel=1e-12)
    assert recording.energy.supports[0] == pytest.approx(2.0 * (after + 1.0) * speed, rel=1e-11)
    assert recording.energy.input == 0.0
    assert abs(recording.energy.closure) <= 1e-11


@pytest.mark.parametrize(
    "law",
    [ContactLaw("linear", 900.0), ContactLaw("kelvin-voigt", 9000.0, 0.3)],
    ids=lambda law: law.kind,
)
def test_an_element_at_a_support(law):
    """Its force works while it is closed; its impulse is no further work."""
    scene = Scene(
        (Body("a", 2.0),),
        (Spring("s", (GROUND, "a"), Linear(40.0)),),
        contacts=(Contact("seat", "pier", "a", 0.001, None, law),),
        forces=(Force("a", -1.0),),
        supports=(Support("pier", motion=Sine(3.0, 0.8)),),
        motion=Ricker(2.0, 0.7),
    )
    energy = run(scene, 2.0, "cvode", 1e-11, energy=True).energy
    assert abs(energy.supports[0]) > 0.01
    assert abs(energy.closure) <= 1e-9


@pytest.mark.parametrize("solver", SOLVERS)
def test_one_work_a_support(solver):
    """Two supports that move as one do what one does."""
    one = pounding_on_two()
    own = one.supports[0]
    two = replace(
        one,
        supports=(own, Support("pile", motion=own.motion)),
        contacts=tuple(
            replace(c, right="pile" if c.right == "pier" else c.right) for c in one.contacts
        ),
    )
    first, second = (run(x, 4.0, solver, 1e-11, energy=True).energy for x in (one, two))
    assert min(map(abs, second.supports)) > 1e-3
    assert sum(second.supports) == pytest.approx(first.supports[0], rel=1e-7)
    assert second.input == pytest.approx(first.input, rel=1e-7)


def test_closes_on_random_scenes():
    """As well as rtol says; works and input add up whatever the contacts do."""
    worked = 0
    for seed in range(40):
        scene, end = driven_scene(seed)
        if not scene.supports:
            continue
        energy = run(scene, end, "fast", 1e-9, energy=True).energy
        assert len(energy.supports) == len(scene.supports)
        assert abs(energy.closure) <= 1e-6, seed
        worked += any(w != 0.0 for w in energy.supports)
    assert worked > 15


def test_summary_names_them():
    scene = replace(pounding_on_two(), forces=(Force("b", PhasedSine(6.0, 0.7, cycles=1.0)),))
    response = response_of(scene, "fast", 1e-8, duration=3.0, energy=True)
    energy = summarise(response)["energy"]
    assert list(energy["supports"]) == ["pier"]
    assert response.quantity("supports.pier.work") == energy["supports"]["pier"]
    balance = energy["initial"] + energy["input"] + energy["supports"]["pier"]
    spent = sum(energy[k] for k in ("kinetic", "elastic", "hysteretic", "viscous", "impact"))
    assert balance == pytest.approx(spent, rel=1e-7)
    alone = response_of(replace(scene, supports=(Support("pier", 0.0),)), "fast", duration=1.0)
    assert alone.energy is None
