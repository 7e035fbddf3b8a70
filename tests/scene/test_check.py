"""Scenes built in Python are checked as those of cases are."""

import math
from dataclasses import replace
from typing import Any

import pytest

from eventpound.errors import InputError
from eventpound.motion import Sine
from eventpound.scene import (
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Series,
    Spring,
)
from eventpound.scene.check import check_scene, scene_warnings

BOUC_WEN = BoucWen(stiffness=1.0, strength=1.0, yield_displacement=0.1)
SCENE = Scene(
    bodies=(Body("a", 1.0), Body("b", 2.0)),
    springs=(
        Spring("s", ("ground", "a"), BOUC_WEN),
        Spring("stop", ("a", "b"), Series((Linear(1.0), BilinearElastic(0.0, 2.0, 0.1)))),
    ),
    dashpots=(Dashpot(("ground", "a"), 0.1),),
    contacts=(Contact("c", "a", "b", 0.0, 0.5), Contact("wall", "barrier", "a", 0.1, 1.0)),
    motion=Sine(1.0, 1.0),
)


def test_sound_scene():
    check_scene(SCENE)
    assert scene_warnings(SCENE) == ()


def changed(kind: str, position: int, **values: Any) -> Scene:
    elements = list(getattr(SCENE, kind))
    elements[position] = replace(elements[position], **values)
    scene_values: dict[str, Any] = {kind: tuple(elements)}
    return replace(SCENE, **scene_values)


@pytest.mark.parametrize(
    ("scene", "fragment"),
    [
        (replace(SCENE, bodies=(), springs=(), dashpots=(), contacts=()), "at least one body"),
        (changed("bodies", 0, mass=-1.0), "body 1 (a): mass: found -1.0"),
        (changed("bodies", 0, mass=math.nan), "body 1 (a): mass: found nan"),
        (changed("bodies", 1, velocity=math.inf), "body 2 (b): initial.velocity: found inf"),
        (changed("springs", 1, name="s"), "spring 2 (s): name: found 's'"),
        (changed("springs", 0, law=Linear(-1.0)), "spring 1 (s): stiffness: found -1.0"),
        (changed("springs", 1, law=Series(())), "spring 2 (stop): parts: found []"),
        (
            changed("springs", 1, law=Series((Linear(math.nan),))),
            "spring 2 (stop): parts 1: stiffness: found nan",
        ),
        (
            changed("springs", 0, law=replace(BOUC_WEN, yield_displacement=0.0)),
            "spring 1 (s): yield_displacement: found 0.0",
        ),
        (changed("springs", 0, law=replace(BOUC_WEN, exponent=0.9)), "exponent: found 0.9"),
        (changed("springs", 0, law=replace(BOUC_WEN, beta=-0.5)), "beta: found -0.5"),
        (changed("springs", 0, law=replace(BOUC_WEN, initial_z=1.01)), "initial_z: found 1.01"),
        (changed("dashpots", 0, coefficient=-0.1), "dashpot 1: coefficient: found -0.1"),
        (changed("contacts", 0, restitution=1.1), "contact 1 (c): restitution: found 1.1"),
        (changed("contacts", 1, gap=-0.1), "contact 2 (wall): gap: found -0.1"),
        (changed("bodies", 0, displacement=1e-3), "contact 1 (c): gap: found 0.0"),
    ],
)
def test_refused(scene, fragment):
    with pytest.raises(InputError) as caught:
        check_scene(scene)
    assert len(caught.value.problems) == 1
    assert fragment in str(caught.value)


def test_rounding_is_no_penetration():
    # 0.3 - 0.1 - 0.2 = -2.8e-17 in doubles.
    scene = Scene(
        (Body("a", 1.0, displacement=0.3), Body("b", 1.0, displacement=0.1)),
        contacts=(Contact("c", "a", "b", 0.2, 0.5),),
    )
    check_scene(scene)


def test_rounding_of_a_row_is_no_penetration():
    # Bodies that rest on each other stand at sums along their row, and what rounds there is
    # more than the last of them is long; anything beyond is a penetration.
    def scene(overlap: float) -> Scene:
        return Scene(
            (Body("a", 1.0, -0.3), Body("b", 1.0, overlap), Body("c", 1.0, 0.0)),
            contacts=(Contact("ab", "a", "b", -0.3, 0.5), Contact("bc", "b", "c", 0.0, 0.5)),
        )

    check_scene(scene(6e-18))
    with pytest.raises(InputError, match="not penetrated"):
        check_scene(scene(1e-15))


def test_rounding_of_what_a_motion_left_is_no_penetration():
    # Bodies that came to rest where they began, without gaps: nothing else has a length.
    def scene(overlap: float) -> Scene:
        contacts = (Contact("wall", "a", "barrier", 0.0, 0.5),)
        return Scene((Body("a", 1.0, overlap),), contacts=contacts, motion=Sine(3.0, 0.5))

    check_scene(scene(1e-16))
    with pytest.raises(InputError, match="not penetrated"):
        check_scene(scene(1e-13))


def test_bound_of_z():
    # (beta + gamma)^(-1/n) = 0.25^(-1/2) = 2
    law = replace(BOUC_WEN, beta=0.1, gamma=0.15, exponent=2.0, initial_z=-2.0)
    check_scene(changed("springs", 0, law=law))
    with pytest.raises(InputError, match="= 2 in size"):
        check_scene(changed("springs", 0, law=replace(law, initial_z=-2.001)))


def test_a_law_that_creates_energy_is_warned_of():
    scene = changed("springs", 0, law=replace(BOUC_WEN, beta=0.7, gamma=0.3))
    check_scene(scene)
    (warning,) = scene_warnings(scene)
    assert "spring 1 (s)" in warning
    assert "energy" in warning
