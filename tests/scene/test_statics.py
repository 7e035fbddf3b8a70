"""Where forces hold a scene, against formulas."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from eventpound import ContactLaw, Cosine, InputError, Point, simulate
from eventpound.case import read_case
from eventpound.mechanics.model import assemble
from eventpound.mechanics.observables import initial_gaps
from eventpound.scene import (
    BARRIER,
    GROUND,
    Backfill,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    DegradingBoucWen,
    Force,
    Linear,
    Scene,
    Series,
    Slider,
    Spring,
    Support,
)
from eventpound.scene.check import check_scene
from eventpound.scene.spring import Law
from eventpound.scene.statics import in_equilibrium

G = 9.81


def displacements(scene: Scene) -> np.ndarray:
    return np.array([body.displacement for body in in_equilibrium(scene).bodies])


def weights(*names: str) -> tuple[Force, ...]:
    return tuple(Force(name, f"-{G} m/s^2") for name in names)


def test_masses_on_springs():
    scene = Scene(
        (Body("a", 2.0), Body("b", 3.0)),
        (Spring("1", (GROUND, "a"), Linear(100.0)), Spring("2", ("b", "a"), Linear(40.0))),
        forces=weights("a", "b"),
    )
    a = -5.0 * G / 100.0
    assert displacements(scene) == pytest.approx([a, a - 3.0 * G / 40.0], rel=1e-13)


def test_on_a_support_that_has_moved():
    support = Support("pier", motion=Cosine(2.0, 1.0, start=-0.5))
    scene = Scene(
        (Body("a", 2.0),),
        (Spring("1", ("pier", "a"), Linear(100.0)), Spring("2", (GROUND, "a"), Linear(300.0))),
        supports=(support,),
    )
    s = float(support.motion.displacement(np.array(0.0)))
    assert displacements(scene) == pytest.approx([0.25 * s], rel=1e-13)


@pytest.mark.parametrize("push", [-50.0, 50.0])
def test_springs_with_a_kink(push):
    law = BilinearElastic(200.0, 50.0, 0.03)
    scene = Scene((Body("a", 1.0),), (Spring("1", (GROUND, "a"), law),), forces=(Force("a", push),))
    k = 50.0 if push > 0.0 else 200.0
    assert displacements(scene) == pytest.approx([0.03 + push / k], rel=1e-13)
    both = Series((Linear(100.0), law))
    scene = replace(scene, springs=(Spring("1", (GROUND, "a"), both),))
    assert displacements(scene) == pytest.approx([0.03 + push / k + push / 100.0], rel=1e-13)


def test_a_yielding_spring():
    """With n = 1 and beta = gamma = 1/2, z = 1 - exp(-x/u_y)."""
    law = BoucWen(10.0, 5.0, 0.1, 1.0)
    scene = Scene((Body("a", 1.0),), (Spring("1", (GROUND, "a"), law),), forces=(Force("a", 7.0),))
    found = in_equilibrium(scene)
    x = found.bodies[0].displacement
    assert 10.0 * x + 5.0 * (1.0 - np.exp(-x / 0.1)) == pytest.approx(7.0, rel=1e-11)
    (spring,) = found.springs
    assert spring.law.initial_z == pytest.approx(1.0 - np.exp(-x / 0.1), rel=1e-11)


def test_a_stack_on_the_floor():
    scene = Scene(
        tuple(Body(f"b{i}", 1.0 + i) for i in range(4)),
        contacts=tuple(
            Contact(f"c{i}", BARRIER if i == 0 else f"b{i - 1}", f"b{i}", 0.1 * (i + 1), 0.5)
            for i in range(4)
        ),
        forces=weights("b0", "b1", "b2", "b3"),
    )
    assert displacements(scene) == pytest.approx([-0.1, -0.3, -0.6, -1.0], rel=1e-14)


def test_some_contacts_hold_and_others_not():
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0)),
        (Spring("1", (GROUND, "a"), Linear(100.0)), Spring("2", (GROUND, "b"), Linear(50.0))),
        contacts=(Contact("ab", "a", "b", 0.02, 0.5), Contact("wall", "b", BARRIER, 0.5, 0.5)),
        forces=(Force("a", 10.0),),
    )
    # Together (10 - 50 * 0.02 ...): 100 u + 50 (u - 0.02) = 10.
    u = (10.0 + 50.0 * 0.02) / 150.0
    assert displacements(scene) == pytest.approx([u, u - 0.02], rel=1e-13)


def test_what_nothing_holds():
    scene = Scene((Body("loose", 1.0),), forces=weights("loose"))
    with pytest.raises(InputError, match="nothing holds the body 'loose'"):
        in_equilibrium(scene)


def test_contacts_with_a_law_are_refused():
    soft = Contact("wall", "a", BARRIER, 0.1, None, ContactLaw("linear", 1e5))
    scene = Scene((Body("a", 1.0),), contacts=(soft,), forces=(Force("a", 1.0),))
    with pytest.raises(InputError, match=r"'wall'.*rigid"):
        in_equilibrium(scene)


@pytest.mark.parametrize(
    ("k", "force", "gap"),
    [((100.0, 100.0 * c), 10.0, 0.02) for c in (1e-9, 1e-4, 1e4, 1e9)] + [((1e8, 5e7), 5e6, 0.01)],
)
def test_a_body_pressed_against_another(k, force, gap):
    """A soft one and a stiff one, and two of 100 and 50 MN/m that 5 MN press."""
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0)),
        tuple(Spring(n, (GROUND, n), Linear(x)) for n, x in zip("ab", k, strict=True)),
        contacts=(Contact("ab", "a", "b", gap, 0.5),),
        forces=(Force("a", force),),
    )
    u = (force + k[1] * gap) / sum(k)
    assert displacements(scene) == pytest.approx([u, u - gap], rel=1e-12)


def test_two_contacts_that_hold_two_bodies_are_shut_to_rounding():
    """Gaps whose zero is the solution of two equations, in the terms that a run measures them."""
    at = Point({GROUND: 0.279, "a": 0.721}), Point({GROUND: 0.427, "b": 0.573})
    scene = Scene(
        (Body("a", 46.6), Body("b", 45.0)),
        (Spring("1", (GROUND, "a"), BoucWen(327.0, 8.24, 0.0079)),
         Spring("2", (GROUND, "b"), Linear(2487.0))),
        contacts=(
            Contact("low", *at, 0.0154, 0.5),
            Contact("high", Point({GROUND: 0.78, "a": 0.22}), "b", 0.0133, 0.5),
        ),
        forces=(Force("a", 23.6), Force("b", -49.1)),
    )  # fmt: skip
    standing = in_equilibrium(scene)
    a, b = (body.displacement for body in standing.bodies)
    expected = np.linalg.solve([[-0.721, 0.573], [-0.22, 1.0]], [-0.0154, -0.0133])
    assert (a, b) == pytest.approx(tuple(expected), rel=1e-14)
    assert (initial_gaps(assemble(standing), 1e-3) == 0.0).all()
    check_scene(standing)


def test_of_many_equilibria_it_is_the_nearest():
    """What floats stays, bodies that overlap part alike, a cable is let slack and no more."""
    floating = Scene((Body("a", 1.0, 0.03),), contacts=(Contact("wall", "a", BARRIER, 0.1, 0.5),))
    assert displacements(floating) == [0.03]
    apart = Scene(
        (Body("a", 1.0, 0.03), Body("b", 9.0, -0.01)), contacts=(Contact("c", "a", "b", 0.02, 0.5),)
    )
    assert displacements(apart) == pytest.approx([0.02, 0.0], abs=1e-17)
    cable = Spring("cable", (GROUND, "a"), BilinearElastic(0.0, 1e6, 0.02))
    assert displacements(replace(floating, springs=(cable,))) == pytest.approx([0.02], rel=1e-14)


def test_contacts_that_leave_no_room():
    walls = Contact("left", BARRIER, "a", 0.01, 0.5), Contact("right", "a", BARRIER, -0.02, 0.5)
    scene = Scene((Body("a", 1.0),), contacts=walls)
    with pytest.raises(InputError, match=r"leave bodies no room \(left, right\)"):
        in_equilibrium(scene)
    # Without play, but with room: the contacts share whatever presses on the body.
    exact = replace(scene, contacts=(walls[0], replace(walls[1], gap=-0.01)))
    exact = replace(exact, forces=(Force("a", 1e3),))
    assert displacements(exact) == pytest.approx([-0.01], rel=1e-15)


def test_a_law_that_unloads_downwards_is_refused():
    law = BoucWen(1.0, 2.0, 0.1, 2.0, 1.0, -0.2)
    scene = Scene((Body("a", 1.0),), (Spring("s", (GROUND, "a"), law),), forces=(Force("a", 1.0),))
    with pytest.raises(InputError, match=r"'s'.*gamma = -0.2.*accepted: gamma >= 0"):
        in_equilibrium(scene)


def held_by(law: Law, force: float, u: float = 0.0) -> Scene:
    return Scene(
        (Body("a", 1.0, u),), (Spring("s", (GROUND, "a"), law),), forces=(Force("a", force),)
    )


@pytest.mark.parametrize("u", [0.0, 0.01])
def test_a_slider_sticks_until_its_friction_is_reached(u):
    law = Slider(0.1, 50.0, 200.0)
    for force in (200.0 * u, 200.0 * u + 4.99, 200.0 * u - 4.99):
        assert displacements(held_by(law, force, u)) == [u]
    for slip in (0.02, -0.03):
        force = 200.0 * (u + slip) + np.sign(slip) * 5.0
        assert displacements(held_by(law, force, u)) == pytest.approx([u + slip], rel=1e-12)
    with pytest.raises(InputError, match="nothing holds the body 'a'"):
        in_equilibrium(held_by(Slider(0.1, 50.0), 5.1))


def test_backfill_is_pushed_in_and_let_go():
    """On its hyperbola y/(1/K0 + R_f y/F_ult); from there on the line of K0, to a wider gap."""
    soil = Backfill(1e3, 20.0, 0.8, gap=0.01)
    pushed = in_equilibrium(held_by(soil, -8.0))
    depth = 8.0 / 1e3 / (1.0 - 0.8 * 8.0 / 20.0)
    (body,), (spring,) = pushed.bodies, pushed.springs
    assert body.displacement == pytest.approx(-0.01 - depth, rel=1e-12)
    less = in_equilibrium(replace(pushed, forces=(Force("a", -3.0),)))
    assert less.bodies[0].displacement == pytest.approx(body.displacement + 5e-3, rel=1e-12)
    gone = in_equilibrium(replace(less, forces=()))
    assert gone.bodies[0].displacement == pytest.approx(body.displacement + 8e-3, rel=1e-12)
    assert spring.law.initial_gap == pytest.approx(0.01 + depth - 8e-3, rel=1e-12)
    again = in_equilibrium(replace(gone, forces=(Force("a", -8.0),)))
    assert again.bodies[0].displacement == pytest.approx(body.displacement, rel=1e-12)
    with pytest.raises(InputError, match="nothing holds the body 'a'"):
        in_equilibrium(held_by(soil, -26.0))
    untouched = held_by(soil, 0.0)
    assert in_equilibrium(untouched) == untouched


def test_a_degrading_spring_is_loaded_straight_as_far_as_it_grows_stronger():
    """Without degradation as Bouc-Wen; with eta alone z' eta = 1 while it is elastic."""
    plain = BoucWen(10.0, 5.0, 0.1, 2.0)
    same = DegradingBoucWen(10.0, 5.0, 0.1, 2.0)
    found = displacements(held_by(same, 4.0))
    assert found == pytest.approx(displacements(held_by(plain, 4.0)), rel=1e-11)
    # epsilon = (e^a - 1)/delta, a = delta z^2/2, and u_y z' = e^-a, so x/u_y = int e^a dz.
    soft = DegradingBoucWen(0.0, 5.0, 0.1, 200.0, stiffness_degradation=4.0)
    standing = in_equilibrium(held_by(soft, 2.5))
    x = 0.1 * quad(lambda z: np.exp(2.0 * z**2), 0.0, 0.5)[0]
    assert standing.bodies[0].displacement == pytest.approx(x, rel=1e-10)
    (spring,) = standing.springs
    assert spring.law.second_at == pytest.approx(np.expm1(0.5) / 4.0, rel=1e-10)
    assert spring.law.initial_loss == pytest.approx(0.0, abs=1e-10)
    weak = DegradingBoucWen(0.0, 5.0, 0.1, 2.0, strength_degradation=1.0)
    for force in (4.9, 1e3):
        with pytest.raises(InputError, match=r"beyond what degrading springs bear \(.s.\)"):
            in_equilibrium(held_by(weak, force))


def test_a_scene_from_python_starts_in_equilibrium_by_the_word_of_the_case():
    scene = Scene(
        (Body("joint", 1e3),),
        (Spring("frame", (GROUND, "joint"), Linear(3.3e8)),),
        forces=(Force("joint", 7e5),),
    )
    response = simulate(scene, duration=0.1, start="equilibrium", error_estimate=False)
    u = 7e5 / 3.3e8
    assert response.peaks.loc["joint", "min"] == pytest.approx(u, rel=1e-12)
    assert response.peaks.loc["joint", "max"] == pytest.approx(u, rel=1e-12)
    swinging = simulate(scene, duration=0.1, start="initial", error_estimate=False)
    assert swinging.peaks.loc["joint", "max"] == pytest.approx(2.0 * u, rel=1e-6)
    with pytest.raises(InputError, match="start: found 'rest'; accepted: 'initial', 'equilibrium'"):
        simulate(scene, duration=0.1, start="rest")
    with pytest.raises(InputError, match="nothing holds the body 'joint'"):
        simulate(replace(scene, springs=()), duration=0.1, start="equilibrium")
    with pytest.raises(InputError, match=r"body 1 .joint.: mass"):
        simulate(replace(scene, bodies=(Body("joint", -1.0),)), duration=0.1, start="equilibrium")


@pytest.mark.parametrize("solver", ["cvode", "fast"])
def test_what_soil_sliders_and_degrading_springs_hold_stays(solver):
    laws = (
        (Backfill(1e3, 20.0, 0.8, gap=0.01), -8.0),
        (Slider(0.1, 50.0, 200.0), 4.0),
        (DegradingBoucWen(10.0, 5.0, 0.1, 2.0, stiffness_degradation=2.0), 3.0),
    )
    for law, force in laws:
        scene = in_equilibrium(held_by(law, force))
        (u,) = (body.displacement for body in scene.bodies)
        response = simulate(scene, solver, 1e-10, duration=5.0, error_estimate=False)
        extremes = response.peaks.loc["a", ["min", "max"]].to_numpy(float)
        assert extremes == pytest.approx([u, u], abs=1e-9)


def test_in_a_case():
    document: dict[str, object] = {
        "excitation": {"kind": "none"},
        "body": [{"name": "a", "mass": 2.0}],
        "spring": [{"between": ["ground", "a"], "law": "linear", "stiffness": 100.0}],
        "force": [{"body": "a", "value": "-9.81 m/s^2"}],
        "run": {"duration": 1.0, "start": "equilibrium"},
    }
    case = read_case(document, Path("case.toml"))
    assert case.scene.bodies[0].displacement == pytest.approx(-2.0 * G / 100.0, rel=1e-13)
    assert read_case(case.understood, Path("case.toml")).scene == case.scene
    # Where it is to be placed the body may be given where it cannot be.
    wall = {"between": ["barrier", "a"], "name": "wall", "gap": -0.2, "restitution": 0.5}
    placed = read_case({**document, "contact": [wall]}, Path("case.toml"))
    assert placed.scene.bodies[0].displacement == pytest.approx(0.2, rel=1e-15)
    for change, text in (
        ({"spring": []}, "[run]: start: found \"equilibrium\", but nothing holds the body 'a'"),
        ({"run": {"duration": 1.0, "start": "rest"}}, "[run]: start: found 'rest'"),
        ({"contact": [wall], "run": {"duration": 1.0}}, "[[contact]] 1 (wall): gap: found -0.2"),
    ):
        with pytest.raises(InputError) as caught:
            read_case({**document, **change}, Path("case.toml"))
        assert any(text in problem for problem in caught.value.problems), caught.value.problems
