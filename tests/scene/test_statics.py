"""Where forces hold a scene, against formulas, and against a run that stays there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eventpound.case import read_case
from eventpound.errors import InputError
from eventpound.motion import Cosine, NoMotion
from eventpound.motion.constant import Constant
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Force,
    Linear,
    Scene,
    Series,
    Spring,
    Support,
)
from eventpound.scene.contact_law import ContactLaw
from eventpound.scene.statics import in_equilibrium
from tests.solvers.random_scenes import driven_scene

G = 9.81


def displacements(scene: Scene) -> np.ndarray:
    return np.array([body.displacement for body in in_equilibrium(scene).bodies])


def weights(*names: str) -> tuple[Force, ...]:
    return tuple(Force(name, f"-{G} m/s^2") for name in names)


def test_masses_on_springs() -> None:
    scene = Scene(
        (Body("a", 2.0), Body("b", 3.0)),
        (Spring("1", (GROUND, "a"), Linear(100.0)), Spring("2", ("b", "a"), Linear(40.0))),
        forces=weights("a", "b"),
    )
    a = -5.0 * G / 100.0
    assert displacements(scene) == pytest.approx([a, a - 3.0 * G / 40.0], rel=1e-13)


def test_on_a_support_that_has_moved() -> None:
    support = Support("pier", motion=Cosine(2.0, 1.0, start=-0.5))
    scene = Scene(
        (Body("a", 2.0),),
        (Spring("1", ("pier", "a"), Linear(100.0)), Spring("2", (GROUND, "a"), Linear(300.0))),
        supports=(support,),
    )
    assert support.motion is not None
    s = float(support.motion.displacement(np.array(0.0)))
    assert displacements(scene) == pytest.approx([0.25 * s], rel=1e-13)


@pytest.mark.parametrize("push", [-50.0, 50.0])
def test_springs_with_a_kink(push: float) -> None:
    law = BilinearElastic(200.0, 50.0, 0.03)
    scene = Scene((Body("a", 1.0),), (Spring("1", (GROUND, "a"), law),), forces=(Force("a", push),))
    k = 50.0 if push > 0.0 else 200.0
    assert displacements(scene) == pytest.approx([0.03 + push / k], rel=1e-13)
    both = Series((Linear(100.0), law))
    scene = replace(scene, springs=(Spring("1", (GROUND, "a"), both),))
    assert displacements(scene) == pytest.approx([0.03 + push / k + push / 100.0], rel=1e-13)


def test_a_yielding_spring() -> None:
    """With n = 1 and beta = gamma = 1/2, z = 1 - exp(-x/u_y)."""
    law = BoucWen(10.0, 5.0, 0.1, 1.0)
    scene = Scene((Body("a", 1.0),), (Spring("1", (GROUND, "a"), law),), forces=(Force("a", 7.0),))
    found = in_equilibrium(scene)
    x = found.bodies[0].displacement
    assert 10.0 * x + 5.0 * (1.0 - np.exp(-x / 0.1)) == pytest.approx(7.0, rel=1e-11)
    (spring,) = found.springs
    assert isinstance(spring.law, BoucWen)
    assert spring.law.initial_z == pytest.approx(1.0 - np.exp(-x / 0.1), rel=1e-11)


def test_a_stack_on_the_floor() -> None:
    scene = Scene(
        tuple(Body(f"b{i}", 1.0 + i) for i in range(4)),
        contacts=tuple(
            Contact(f"c{i}", BARRIER if i == 0 else f"b{i - 1}", f"b{i}", 0.1 * (i + 1), 0.5)
            for i in range(4)
        ),
        forces=weights("b0", "b1", "b2", "b3"),
    )
    assert displacements(scene) == pytest.approx([-0.1, -0.3, -0.6, -1.0], rel=1e-14)


def test_some_contacts_hold_and_others_not() -> None:
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0)),
        (Spring("1", (GROUND, "a"), Linear(100.0)), Spring("2", (GROUND, "b"), Linear(50.0))),
        contacts=(Contact("ab", "a", "b", 0.02, 0.5), Contact("wall", "b", BARRIER, 0.5, 0.5)),
        forces=(Force("a", 10.0),),
    )
    # Together (10 - 50 * 0.02 ...): 100 u + 50 (u - 0.02) = 10.
    u = (10.0 + 50.0 * 0.02) / 150.0
    assert displacements(scene) == pytest.approx([u, u - 0.02], rel=1e-13)


def test_what_nothing_holds() -> None:
    scene = Scene((Body("loose", 1.0),), forces=weights("loose"))
    with pytest.raises(InputError, match="nothing holds the body 'loose'"):
        in_equilibrium(scene)


def test_contacts_with_a_law_are_refused() -> None:
    soft = Contact("wall", "a", BARRIER, 0.1, None, ContactLaw("linear", 1e5))
    scene = Scene((Body("a", 1.0),), contacts=(soft,), forces=(Force("a", 1.0),))
    with pytest.raises(InputError, match=r"'wall'.*rigid"):
        in_equilibrium(scene)


@pytest.mark.parametrize("seed", range(12))
def test_scenes_at_random_stay_there(seed: int) -> None:
    from eventpound.solvers import solver_named
    from eventpound.solvers.base import Task

    scene, _ = driven_scene(seed)
    rng = np.random.default_rng(seed)
    scene = replace(
        scene,
        motion=NoMotion(),
        supports=tuple(replace(s, delay=0.0, motion=None) for s in scene.supports),
        bodies=tuple(replace(b, velocity=0.0) for b in scene.bodies),
        forces=tuple(Force(b.name, Constant(rng.normal()), per_mass=True) for b in scene.bodies),
    )
    try:
        standing = in_equilibrium(scene)
    except InputError:
        pytest.skip("a body is held by nothing, or by a law without stiffness on one side")
    held = solver_named("cvode").solve(Task(standing, 0.0, 5.0, 1e-10))
    u = np.array([body.displacement for body in standing.bodies])
    moved = max(
        np.abs(held.displacement.maximum - u).max(), np.abs(held.displacement.minimum - u).max()
    )
    assert moved <= 1e-9 * max(np.abs(u).max(), 1e-3)


def test_in_a_case() -> None:
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
    for change, text in (
        ({"spring": []}, "[run]: start: found \"equilibrium\", but nothing holds the body 'a'"),
        ({"run": {"duration": 1.0, "start": "rest"}}, "[run]: start: found 'rest'"),
    ):
        with pytest.raises(InputError) as caught:
            read_case({**document, **change}, Path("case.toml"))
        assert any(text in problem for problem in caught.value.problems), caught.value.problems
