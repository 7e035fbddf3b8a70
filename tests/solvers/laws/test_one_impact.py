"""One impact under each law against quadrature: energy lost, time in contact, forces, depth."""

import math

import pytest

from eventpound.scene import BARRIER, Body, Contact, ContactLaw, Scene
from eventpound.scene.contact_law import (
    BY_WORD,
    Element,
    damping_constant,
    jankowski_ratio,
    kelvin_voigt_ratio,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from tests.solvers.laws.quadrature import Impact, hertz, jankowski, kelvin_voigt

STIFFNESS, SPEED, GAP = 5e4, 1.7, 0.3
RTOL = 1e-12
# The overlap is some 40 times smaller than the scene, and a rate off by 1e-13 at the start makes
# a hundred times that of an overlap at the end; quadrature adds 1e-12.
ALLOWED = 1e-10


def run_of(word: str, restitution: float, *, barrier: bool = False) -> Recording:
    """A body of 2 kg that strikes one of 3 kg at rest, or a barrier."""
    element = BY_WORD[word]
    e = restitution if element.damped else None
    law = ContactLaw(word, STIFFNESS)
    bodies = (Body("a", 2.0, 0.0, SPEED), Body("b", 3.0))
    contact = Contact("c", "a", BARRIER if barrier else "b", GAP, e, law)
    scene = Scene(bodies, (), (), (contact,))
    return solver_named("cvode").solve(Task(scene, 0.0, 0.4, RTOL, energy=True))


def expected(word: str, restitution: float, mass: float) -> Impact:
    match BY_WORD[word]:
        case Element.LINEAR:
            return kelvin_voigt(STIFFNESS, mass, SPEED, 0.0)
        case Element.KELVIN_VOIGT:
            return kelvin_voigt(STIFFNESS, mass, SPEED, kelvin_voigt_ratio(restitution))
        case Element.HERTZ:
            return hertz(STIFFNESS, mass, SPEED, 0.0)
        case Element.HERTZ_DAMP:
            a = damping_constant(Element.HERTZ_DAMP, restitution)
            return hertz(STIFFNESS, mass, SPEED, a)
    return jankowski(STIFFNESS, mass, SPEED, jankowski_ratio(restitution))


@pytest.mark.parametrize("barrier", [False, True])
@pytest.mark.parametrize("restitution", [0.3, 0.65, 0.95])
@pytest.mark.parametrize("word", list(BY_WORD))
def test_against_quadrature(word, restitution, barrier):
    mass = 2.0 if barrier else 1.2
    found, true = (run_of(word, restitution, barrier=barrier), expected(word, restitution, mass))
    (event,) = found.events
    e = -event.gap_velocity_after / event.gap_velocity_before
    assert event.t == pytest.approx(GAP / SPEED, rel=1e-12)
    assert e == pytest.approx(true.restitution, abs=ALLOWED)
    energy = 0.5 * mass * SPEED**2
    assert event.impulse == pytest.approx(mass * SPEED * (1.0 + e), rel=ALLOWED)
    assert event.energy_lost == pytest.approx(
        energy * (1.0 - true.restitution**2), abs=ALLOWED * energy
    )
    assert found.laws.longest_contact[0] == pytest.approx(true.duration, rel=ALLOWED)
    assert found.max_force[0] == pytest.approx(true.largest, rel=ALLOWED)
    assert found.laws.smallest_force[0] == pytest.approx(true.smallest, abs=ALLOWED * true.largest)
    assert -found.smallest_gap[0] == pytest.approx(true.depth, rel=ALLOWED)
    assert abs(found.energy.closure) < ALLOWED


def test_the_limit_at_closing_is_the_largest_force():
    # ζ > 1/2: the dashpot falls faster than the spring grows.
    scene = Scene(
        (Body("a", 2.0, 0.0, SPEED),),
        (),
        (),
        (Contact("c", "a", BARRIER, GAP, None, ContactLaw("kelvin-voigt", STIFFNESS, 0.8)),),
    )
    found = solver_named("cvode").solve(Task(scene, 0.0, 0.4, 1e-9))
    c = 2.0 * 0.8 * math.sqrt(STIFFNESS * 2.0)
    assert found.max_force[0] == pytest.approx(c * SPEED, rel=1e-9)


def test_a_force_that_is_cut_against_its_closed_form():
    """kelvin-voigt up to k d + c d' = 0, free after: the cut ends a step, so few are needed."""
    law = ContactLaw("kelvin-voigt", STIFFNESS, None, False)
    scene = Scene(
        (Body("a", 2.0, 0.0, SPEED),), (), (), (Contact("c", "a", BARRIER, GAP, 0.3, law),)
    )
    found = solver_named("cvode").solve(Task(scene, 0.0, 0.4, RTOL, energy=True))
    zeta, omega = kelvin_voigt_ratio(0.3), math.sqrt(STIFFNESS / 2.0)
    damped = omega * math.sqrt(1.0 - zeta**2)
    # tan(ω_d t) = -2 ζ sqrt(1 - ζ²)/(1 - 2 ζ²), the first one after the deepest point.
    t = math.atan2(2.0 * zeta * math.sqrt(1.0 - zeta**2), 2.0 * zeta**2 - 1.0) / damped
    decay = SPEED * math.exp(-zeta * omega * t)
    depth = decay / damped * math.sin(damped * t)
    rate = decay * (math.cos(damped * t) - zeta * omega / damped * math.sin(damped * t))
    (event,) = found.events
    assert event.gap_velocity_after == pytest.approx(-rate, rel=ALLOWED)
    assert found.laws.longest_contact[0] == pytest.approx(t - depth / rate, rel=ALLOWED)
    assert found.laws.smallest_force[0] == 0.0
    assert found.work.steps < 150
