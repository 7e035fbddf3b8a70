"""Contacts at points between bodies, against closed forms and other ways to say the same."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm, null_space

from eventpound.accuracy.reference import reference_of
from eventpound.case.case import Case
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.mechanics.model import assemble
from eventpound.motion import NoMotion, Ricker, Sine
from eventpound.motion.constant import Constant
from eventpound.numerics.compiled import PLAIN
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
    Slider,
    Spring,
    Support,
)
from eventpound.scene.check import check_scene
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Recording, Task
from eventpound.solvers.from_samples import inferred_impacts
from eventpound.study.many import simulate_many
from tests.oracle.line import solved
from tests.properties.restored import restored
from tests.properties.transforms import mirrored, scaled
from tests.solvers.random_scenes import pointed_scene, random_scene
from tests.solvers.ways import WAYS, directly_and_by

SOLVERS = ("cvode", "ida", "fast")
OWN_ERROR = {"cvode": 1.0, "ida": 100.0, "fast": 10.0}
"""Of solvers at their finest, in units of what is allowed of the reference."""


def run(
    scene: Scene, end: float, rtol: float = 1e-12, solver: str = "cvode", *, energy: bool = False
) -> Recording:
    times = np.linspace(0.0, end, 201)
    return solver_named(solver).solve(
        Task(scene, 0.0, end, rtol, output_times=times, energy=energy)
    )


def towers(point: object = None, restitution: float = 0.4) -> Scene:
    """Two yielding buildings; each has a floor between two floors of the other (4 s)."""
    law = BoucWen(stiffness=12.0, strength=1.5, yield_displacement=0.02, exponent=2.0)
    chains = (("A", (3.0, 2.5, 2.0)), ("B", (1.5, 1.0)))
    pairs = [
        (f"{t}{i}" if i else GROUND, f"{t}{i + 1}") for t, ms in chains for i in range(len(ms))
    ]
    return Scene(
        bodies=tuple(Body(f"{t}{i}", m) for t, ms in chains for i, m in enumerate(ms, 1)),
        springs=tuple(Spring("-".join(p), p, law) for p in pairs),
        dashpots=tuple(Dashpot(p, 0.1) for p in pairs),
        contacts=(
            Contact("low", {GROUND: 0.3, "A1": 0.7}, "B1", 0.002, 0.0),
            Contact("high", "A3", point or {"B1": 0.25, "B2": 0.75}, 0.008, restitution),
            Contact("roof", {"A1": 0.2, "A2": 0.8}, "B2", 0.0, restitution),
        ),
        motion=Ricker(4.0, 0.9, center=1.0),
    )


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_a_body_strikes_a_point_of_free_bodies(restitution, solver):
    """Λ = (1 + ε) m v with 1/m = Σ w²/m_b; what is lost is ½ (1 - ε²) m v²."""
    masses, w, v, gap = (1.3, 0.7, 2.9), 0.35, 2.0, 0.1
    scene = Scene(
        bodies=(Body("a", masses[0], 0.0, v), Body("b", masses[1]), Body("c", masses[2])),
        springs=(),
        dashpots=(),
        contacts=(Contact("point", "a", {"b": w, "c": 1.0 - w}, gap, restitution),),
        motion=NoMotion(),
    )
    found = run(scene, 0.2, solver=solver, energy=True)
    W = np.array([-1.0, w, 1.0 - w])
    m = 1.0 / float(W**2 @ (1.0 / np.array(masses)))
    impact = found.events[0]
    assert impact.t == pytest.approx(gap / v, rel=1e-12)
    assert impact.impulse == pytest.approx((1.0 + restitution) * m * v, rel=1e-12)
    assert impact.energy_lost == pytest.approx(0.5 * (1.0 - restitution**2) * m * v**2, rel=1e-11)
    after = np.array([v, 0.0, 0.0]) + W * impact.impulse / np.array(masses)
    np.testing.assert_allclose(found.v, after, rtol=1e-12)
    np.testing.assert_allclose(found.u, after * 0.15 + [gap, 0.0, 0.0], rtol=1e-11)
    assert abs(found.energy.closure) < 1e-12


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_middle_of_two_equal_bodies_is_one_of_twice_the_mass(solver):
    """Under the same springs both move as one body does."""
    bodies = (Body("a", 1.0, 0.0, 1.0), Body("b", 0.5), Body("c", 0.5))
    springs = tuple(
        Spring(name, (GROUND, name), Linear(k)) for name, k in (("a", 2.0), ("b", 8.0), ("c", 8.0))
    )
    contact = Contact("joint", "a", {"b": 0.5, "c": 0.5}, 0.05, 0.0)
    two = run(Scene(bodies, springs, (), (contact,), NoMotion()), 3.0, solver=solver)
    one = run(
        Scene(
            (bodies[0], Body("b", 1.0)),
            (springs[0], Spring("b", (GROUND, "b"), Linear(16.0))),
            (),
            (replace(contact, right="b"),),
            NoMotion(),
        ),
        3.0,
    )
    np.testing.assert_allclose(two.u, one.u[[0, 1, 1]], atol=1e-10 * OWN_ERROR[solver])
    kinds = [[e.kind for e in r.events] for r in (two, one)]
    assert kinds[0] == kinds[1]
    assert EventKind.DETACHMENT in kinds[0]
    np.testing.assert_allclose(two.max_force, one.max_force, rtol=1e-9 * OWN_ERROR[solver])


@pytest.mark.parametrize("solver", SOLVERS[1:])
def test_towers_are_those_of_the_reference(solver):
    """Yielding springs, cascades, rests at points: programs that share no equation of motion."""
    theirs, ours = (
        run(towers(restitution=0.3), 4.0),
        run(towers(restitution=0.3), 4.0, 1e-11, solver),
    )
    size = np.abs(theirs.history.u).max()
    np.testing.assert_allclose(ours.u, theirs.u, atol=1e-7 * size)
    kinds = [[(e.kind, e.contact) for e in r.events] for r in (ours, theirs)]
    assert kinds[0] == kinds[1]
    np.testing.assert_allclose(ours.max_force, theirs.max_force, rtol=1e-5)
    np.testing.assert_allclose(ours.largest_gap, theirs.largest_gap, atol=1e-7 * size)
    np.testing.assert_allclose(ours.resting_time, theirs.resting_time, atol=1e-7)


@pytest.mark.parametrize("seed", [4, 6, 10, 11, 12])
def test_random_scenes(seed):
    """Rests on points, on barriers and on each other, some of them redundant; cascades."""
    scene, end = pointed_scene(seed)
    theirs = run(scene, end, 1e-10)
    size = max(np.abs(theirs.displacement.maximum).max(), np.abs(theirs.displacement.minimum).max())
    for solver in SOLVERS[1:]:
        ours = run(scene, end, 1e-10, solver)
        np.testing.assert_allclose(ours.u, theirs.u, atol=1e-7 * size)
        assert [(e.kind, e.contact) for e in ours.events] == [
            (e.kind, e.contact) for e in theirs.events
        ]
        np.testing.assert_array_equal(ours.unique_forces, theirs.unique_forces)
        np.testing.assert_allclose(
            ours.max_force, theirs.max_force, atol=1e-5 * theirs.max_force.max()
        )


def plain_scene(seed: int, supports: int, *, slides: bool = False) -> tuple[Scene, float]:
    """Two to four bodies on linear springs, and sliders if it slides.

    Contacts are at points on them, the ground and supports.
    """
    rng = np.random.default_rng([seed, supports, 58])
    names = [f"b{i}" for i in range(int(rng.integers(2, 5)))]
    held = [f"p{k}" for k in range(supports)]
    motions = [Sine(rng.uniform(0.5, 1.5), rng.uniform(2.0, 9.0)) for _ in held]
    laws = [Linear(rng.uniform(0.5, 3.0)) for _ in names]
    if slides:
        laws += [Slider(rng.uniform(0.05, 0.5), rng.uniform(0.5, 2.0)) for _ in names[1:]]
    springs = [
        Spring(f"k{i}", (str(rng.choice([GROUND, *held])), name), law)
        for i, (name, law) in enumerate(zip(names + names[1:], laws, strict=False))
    ]
    contacts = []
    for i in range(int(rng.integers(1, 4))):
        striking, *on = rng.permutation([*names, *held, GROUND]).tolist()[:3]
        w = float(rng.uniform(0.15, 0.85))
        ends = (BARRIER if striking == GROUND else striking, Point({on[0]: w, on[1]: 1.0 - w}))
        if {striking, *on} & {*names}:
            gap = float(rng.choice([0.0, rng.uniform(0.05, 0.5)], p=(0.3, 0.7)))
            e = float(rng.choice([0.0, 0.5], p=(0.8, 0.2)))
            contacts.append(Contact(f"c{i}", *(ends if rng.random() < 0.5 else ends[::-1]), gap, e))
    scene = Scene(
        bodies=tuple(Body(name, rng.uniform(0.5, 3.0)) for name in names),
        springs=tuple(springs),
        dashpots=tuple(Dashpot((GROUND, name), rng.uniform(0.05, 0.3)) for name in names),
        contacts=tuple(contacts),
        motion=Sine(rng.uniform(0.3, 1.5), rng.uniform(3.0, 12.0)),
        supports=tuple(Support(n, motion=m) for n, m in zip(held, motions, strict=True)),
        forces=tuple(Force(name, Constant(0.4 * rng.normal()), True) for name in names),
    )
    return scene, float(rng.uniform(8.0, 15.0))


@pytest.mark.parametrize(
    ("supports", "slides"),
    [
        *((0, True), (1, False), (2, True)),
        *(pytest.param(*each, marks=pytest.mark.sweep) for each in ((0, False), (1, True))),
        pytest.param(2, False, marks=pytest.mark.sweep),
    ],
)
def test_random_scene_moves_as_in_another_program(supports, *, slides):
    """That shares nothing with the package: it tries who rests, and has SciPy solve impacts."""
    scene, end = plain_scene(0, supports, slides=slides)
    check_scene(scene)
    first = run(scene, end, 1e-11, energy=True)
    size = float(np.abs(first.history.u).max())
    moved = (scene.motion, *(support.motion for support in scene.supports))
    corners = {piece.end for motion in moved if motion for piece in motion.pieces()}
    answer = solved(scene, end, size, 1.0, tuple(sorted(corners)))
    for solver in SOLVERS:
        found = first if solver == "cvode" else run(scene, end, 1e-11, solver, energy=True)
        np.testing.assert_allclose(found.u, answer.u, rtol=0.0, atol=1e-7 * size, err_msg=solver)
        assert abs(found.energy.closure) < 1e-7, solver


def test_a_point_on_the_ground_alone_is_a_barrier():
    """It is no coordinate, whose number those behind it would have to skip."""
    ends = ({GROUND: 1.0}, BARRIER)
    models = [
        assemble(
            replace(towers(), contacts=(Contact("c", end, "B1", 0.01, 0.5), *towers().contacts))
        )
        for end in ends
    ]
    for name in ("left", "right", "weights", "mass"):
        np.testing.assert_array_equal(*(getattr(model, name) for model in models))


def test_many_at_once_are_those_one_by_one():
    scene, gaps = towers(), np.array([0.001, 0.004, 0.02])
    many = simulate_many(
        scene, {"contact.roof.gap": gaps}, rtol=1e-9, duration=4.0, accelerations=True, workers=1
    )
    for i, gap in enumerate(gaps):
        contacts = tuple(replace(c, gap=gap) if c.name == "roof" else c for c in scene.contacts)
        one = response_of(
            replace(scene, contacts=contacts), "fast", rtol=1e-9, duration=4.0
        ).recording
        np.testing.assert_array_equal(many.u[i], one.u)
        np.testing.assert_array_equal(many.displacement.maximum[i], one.displacement.maximum)
        np.testing.assert_array_equal(many.acceleration.minimum[i], one.acceleration.minimum)
        np.testing.assert_array_equal(many.smallest_gap[i], one.smallest_gap)
        impacts = EventKind.IMPACT, EventKind.ACCUMULATION
        assert many.impacts[i].sum() == sum(e.count for e in one.events if e.kind in impacts)


def test_with_all_weight_on_one_body_it_is_a_contact_with_that():
    """The other's part in it, 1e-10, changes as much, amplified by what impacts amplify."""
    near = run(towers({"B1": 1e-10, "B2": 1.0 - 1e-10}), 4.0)
    alone = run(towers("B2"), 4.0)
    np.testing.assert_allclose(near.u, alone.u, atol=1e-8)
    ours, theirs = (
        [sum(e.impulse for e in found.events if e.contact == j) for j in range(3)]
        for found in (near, alone)
    )
    np.testing.assert_allclose(ours, theirs, atol=1e-8)


@pytest.mark.parametrize("seed", [0, 3, 15, 23, 26, 57])
def test_points_of_one_body_are_the_bodies(seed):
    """Rows of bodies, some locked, by clusters and by constraints: two ways through the code.

    So tried were 150 scenes; in those here are rests on barriers, cascades and a locked row.
    """
    scene, end = random_scene(seed)

    def at_point(contact: Contact) -> Contact:
        if contact.left != BARRIER:
            return replace(contact, left=Point({str(contact.left): 1.0}))
        return replace(contact, right=Point({str(contact.right): 1.0}))

    pointed = replace(scene, contacts=tuple(map(at_point, scene.contacts)))
    ours, theirs = (run(s, end, 1e-10) for s in (pointed, scene))
    size = max(np.abs(theirs.displacement.maximum).max(), np.abs(theirs.displacement.minimum).max())
    np.testing.assert_allclose(ours.u, theirs.u, atol=1e-8 * size)
    assert [(e.kind, e.contact) for e in ours.events] == [
        (e.kind, e.contact) for e in theirs.events
    ]
    np.testing.assert_array_equal(ours.unique_forces, theirs.unique_forces)
    unique = ours.unique_forces
    force = np.abs(theirs.max_force).max()
    np.testing.assert_allclose(ours.max_force[unique], theirs.max_force[unique], atol=1e-7 * force)


@pytest.mark.parametrize("solver", SOLVERS)
def test_at_rest_on_a_point_it_is_a_linear_system(solver):
    """A body pressed on a column: the matrix exponential in coordinates that the constraint leaves.

    The contact's force is what the pressed body does not take: ``λ = p - m a``.
    """
    mass, w, push = np.array([1.5, 1.0, 0.8]), 0.3, 4.0
    k = ((-1, 1, 30.0), (1, 2, 22.0))
    K = np.zeros((3, 3))
    for i, j, stiffness in k:
        d = np.eye(3)[j] - (np.eye(3)[i] if i >= 0 else 0.0)
        K += stiffness * np.outer(d, d)
    scene = Scene(
        bodies=tuple(Body(name, m) for name, m in zip("abc", mass, strict=True)),
        springs=(
            Spring("lower", (GROUND, "b"), Linear(30.0)),
            Spring("upper", ("b", "c"), Linear(22.0)),
        ),
        dashpots=(),
        contacts=(Contact("column", "a", {"b": w, "c": 1.0 - w}, 0.0, 0.0),),
        motion=NoMotion(),
        forces=(Force("a", Constant(push)),),
    )
    end = 1.5
    found, own = run(scene, end, solver=solver, energy=True), OWN_ERROR[solver]
    T = null_space(np.array([[-1.0, w, 1.0 - w]]))
    inverse = np.linalg.inv(T.T @ np.diag(mass) @ T)
    pushed = inverse @ T.T @ np.array([push, 0.0, 0.0])
    A = np.zeros((5, 5))
    A[:2, 2:4], A[2:4, :2], A[2:4, 4] = np.eye(2), -inverse @ T.T @ K @ T, pushed
    times = found.history.t
    states = np.array([expm(A * t)[:, 4] for t in times])
    u, a = states[:, :2] @ T.T, (states @ A[2:4].T) @ T.T
    size = np.abs(u).max()
    np.testing.assert_allclose(found.history.u, u, atol=1e-10 * own * size)
    force = push - mass[0] * a[:, 0]
    assert force.min() > 0.0
    assert found.resting_time[0] == end
    np.testing.assert_allclose(found.history.contact_force[:, 0], force, atol=1e-9 * own * push)
    assert found.max_force[0] == pytest.approx(force.max(), rel=1e-3)
    # Linear constraints are kept but for rounding; IDA has them as equations, to its tolerance.
    gap = found.history.u @ np.array([-1.0, w, 1.0 - w])
    assert np.abs(gap).max() < (1e-10 if solver == "ida" else 1e-13) * size
    assert abs(found.energy.closure) < 1e-10 * own


def test_mirror_and_units():
    scene = towers()
    whole = run(scene, 4.0)
    image, view = mirrored(scene)
    np.testing.assert_allclose(restored(run(image, 4.0), view).u, whole.u, atol=1e-10)
    other, view = scaled(scene, 0.0137, 3.3, 1e5)
    found = restored(run(other, 4.0 * 3.3), view)
    np.testing.assert_allclose(found.u, whole.u, atol=1e-10)
    assert [(e.kind, e.contact) for e in found.events] == [
        (e.kind, e.contact) for e in whole.events
    ]


@pytest.mark.parametrize("way", WAYS)
def test_other_ways_into_sundials(way, monkeypatch):
    task = Task(towers(restitution=0.0), 0.0, 3.0, 1e-8)
    direct, other = directly_and_by(way, task, "cvode", monkeypatch)
    np.testing.assert_allclose(other.u, direct.u, atol=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_nothing_moves_but_the_ground(solver):
    """Two floors held between a wall and a column: forces follow the ground, until they let go.

    A single body on a point of itself is known by its contact with a barrier.
    """
    springs = (Spring("s", (GROUND, "a"), Linear(0.0)),)
    motion = Ricker(3.0, 1.0, center=1.2)
    wall = Contact("wall", "a", BARRIER, 0.01, 0.0)
    plain = Scene((Body("a", 1.0),), springs, (), (wall,), motion)
    half = replace(wall, left=Point({GROUND: 0.5, "a": 0.5}), gap=0.005)
    ours, theirs = (
        run(replace(plain, contacts=(contact,)), 4.0, solver=solver) for contact in (half, wall)
    )
    assert [e.kind for e in ours.events] == [e.kind for e in theirs.events]
    assert len(theirs.events) >= 3
    np.testing.assert_allclose([e.t for e in ours.events], [e.t for e in theirs.events], atol=1e-9)
    # The lever is half as long.
    np.testing.assert_allclose(ours.max_force, 2.0 * theirs.max_force, rtol=1e-9)


@pytest.mark.skipif(PLAIN, reason="Numba compiles in its own way here")
def test_other_scenes_have_nothing_of_it_to_compile():
    """What waits for a point is made ready by towers, and not by a pair that pounds before them."""
    program = """
from eventpound.mechanics import followers
from tests.solvers.scenes import pounding_pair, run
from tests.solvers.test_points import towers

for scene in (pounding_pair(), towers()):
    assert run(scene, 1e-6, solver="cvode").events
    print(len(followers.follow.overloads), len(followers.examine_rests.overloads))
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == ["0 0", "1 1"]


def test_what_follows_from_rows_knows_the_points():
    """The largest opening between rows, and impacts read off the motion alone."""
    scene = towers()
    response = response_of(scene, rtol=1e-10, duration=4.0, output_step=1e-3)
    h, found = response.recording.history, response.recording
    for j, contact in enumerate(scene.contacts):
        opening = response.quantity(f"contacts.{contact.name}.largest_gap")
        assert opening is not None
        # A row is at most half a step from the turning point: a h²/8 below it.
        assert 0.0 <= opening - h.gap[:, j].max() < np.abs(h.a).max() * 1e-6
    seen = inferred_impacts(assemble(scene), h.t, h.u, h.v)
    loud = [e for e in found.events if e.kind is EventKind.IMPACT and e.gap_velocity_before < -1e-2]
    for event in loud:
        (same,) = [e for e in seen if e.contact == event.contact and abs(e.t - event.t) < 1e-9]
        assert same.gap_velocity_before == pytest.approx(event.gap_velocity_before, rel=1e-6)


def test_the_gap_that_would_have_avoided_it():
    scene = towers()
    run = response_of(scene, rtol=1e-11, duration=4.0)
    names = {c.name: f"contacts.{c.name}.avoiding_gap" for c in scene.contacts}
    needed = {contact: run.quantity(name) or 0.0 for contact, name in names.items()}
    assert all(needed.values())
    wide = replace(
        scene, contacts=tuple(replace(c, gap=needed[c.name] + 1e-7) for c in scene.contacts)
    )
    assert not response_of(wide, rtol=1e-11, duration=4.0).recording.events
    for contact in wide.contacts:
        touching = tuple(replace(c, gap=c.gap - 2e-7) if c == contact else c for c in wide.contacts)
        found = response_of(replace(wide, contacts=touching), rtol=1e-11, duration=4.0)
        assert {e.contact for e in found.recording.events} == {wide.contacts.index(contact)}


def test_a_comparison_is_checked_by_another_program(tmp_path):
    scene = towers()
    case = Case("", scene, RunOptions(0.0, 1.5, 0.1), SolverOptions(), tmp_path, "", None, (), {})
    reference = reference_of(case, case.run, None)
    assert "checked by fast" in reference.words
    assert reference.check is not None
    assert max(q.bound for q in reference.truth.quantities) < 1e-8
