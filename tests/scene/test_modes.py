"""Modes against SciPy's generalised eigenproblem and closed forms; what swings on a spring."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from eventpound.case.dashpots import read_rayleigh
from eventpound.case.table import Table
from eventpound.scene import GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.scene.modes import modes_of
from eventpound.scene.structures import mass_on, structures_of

RNG = np.random.default_rng(11)
COUNT = 5


def building(yielded_share: float = 0.1) -> tuple[Scene, np.ndarray, np.ndarray, np.ndarray]:
    """A storey frame of random numbers; masses, initial and post-yield stiffnesses."""
    mass = RNG.uniform(1e5, 4e5, COUNT)
    first = RNG.uniform(5e7, 2e8, COUNT)
    ends = [GROUND, *(f"f{i}" for i in range(COUNT))]
    springs = tuple(
        Spring(f"s{i}", (ends[i], ends[i + 1]), BoucWen.from_yield(k, 1e6, yielded_share))
        for i, k in enumerate(first)
    )
    bodies = tuple(Body(name, m) for name, m in zip(ends[1:], mass, strict=True))
    return Scene(bodies, springs), mass, first, yielded_share * first


def chain(k: np.ndarray) -> np.ndarray:
    """Stiffness of a chain from the ground up."""
    above = np.append(k[1:], 0.0)
    return np.diag(k + above) - np.diag(k[1:], 1) - np.diag(k[1:], -1)


@pytest.mark.parametrize("yielded", [False, True])
def test_modes_are_those_of_scipy(yielded: bool) -> None:
    scene, mass, first, later = building()
    squares, vectors = eigh(chain(later if yielded else first), np.diag(mass))
    found = modes_of(scene, [body.name for body in scene.bodies], yielded)
    # Rounding of the matrix is of the size of its largest square.
    assert found.period == pytest.approx(2.0 * np.pi / np.sqrt(squares), rel=1e-12)
    share = (vectors.T @ mass) ** 2 / mass.sum()
    assert found.share == pytest.approx(share, abs=1e-12)
    assert found.share.sum() == pytest.approx(1.0, rel=1e-13)
    for shape, vector in zip(found.shape.T, vectors.T, strict=True):
        assert shape == pytest.approx(vector / vector[np.argmax(np.abs(vector))], abs=1e-10)


def test_rayleigh_damping_of_modes_is_the_ratio_there() -> None:
    scene, *_ = building()
    names = [body.name for body in scene.bodies]
    table = Table({"bodies": names, "ratio": 0.05, "modes": [1, 3]}, "[[rayleigh]] 1", [])
    dashpots, _ = read_rayleigh([table], scene.bodies, scene.springs)
    found = modes_of(Scene(scene.bodies, scene.springs, dashpots), names)
    assert found.damping[[0, 2]] == pytest.approx(0.05, rel=1e-12)
    assert found.damping[1] < 0.05 < found.damping[3]


@pytest.mark.parametrize("modes", [[0, 1], [1, 6], [1], ["1", 2], [True, 2], 3])
def test_modes_that_there_are_not(modes: object) -> None:
    scene, *_ = building()
    problems: list = []
    names = [body.name for body in scene.bodies]
    table = Table({"bodies": names, "ratio": 0.05, "modes": modes}, "[[rayleigh]] 1", problems)
    assert read_rayleigh([table], scene.bodies, scene.springs)[0] == ()
    assert [problem.key for problem in problems] == ["modes"]


@pytest.mark.parametrize("mass", [1e-300, 1.7976931348623157e308])
def test_shares_of_masses_whose_sum_is_no_double(mass: float) -> None:
    bodies = (Body("a", 0.5 * mass), Body("b", mass))
    springs = (
        Spring("s", (GROUND, "a"), Linear(1e-2 * mass)),
        Spring("t", ("a", "b"), Linear(1e-2 * mass)),
    )
    assert modes_of(Scene(bodies, springs), ["a", "b"]).share.sum() == pytest.approx(1.0)


def test_a_structure_that_nothing_holds() -> None:
    scene = Scene((Body("a", 2.0), Body("b", 3.0)), (Spring("s", ("a", "b"), Linear(12.0)),))
    found = modes_of(scene, ["a", "b"])
    assert found.period[0] == math.inf
    assert math.isnan(found.damping[0])
    # The two swing against each other with the reduced mass 6/5.
    assert found.period[1] == pytest.approx(2.0 * math.pi / math.sqrt(10.0), rel=1e-12)


def test_structures_are_what_springs_and_dashpots_join() -> None:
    scene = Scene(
        tuple(Body(name, 1.0) for name in "abcd"),
        (Spring("s", ("a", "c"), Linear(1.0)),),
        (Dashpot(("d", "b"), 1.0),),
        (Contact("touch", "a", "b", 1.0, 0.5),),
    )
    assert structures_of(scene) == [["a", "c"], ["b", "d"]]


def test_what_swings_on_a_spring() -> None:
    scene, mass, *_ = building()
    for i, spring in enumerate(scene.springs):
        assert mass_on(scene, spring) == pytest.approx(mass[i:].sum(), rel=1e-14)
    bridge = Scene(
        (Body("deck1", 3.0), Body("deck2", 5.0)),
        (
            Spring("pier1", (GROUND, "deck1"), Linear(1.0)),
            Spring("pier2", ("deck2", GROUND), Linear(1.0)),
            Spring("bearing", ("deck1", "deck2"), Linear(1.0)),
        ),
    )
    # Each deck is held by the other's pier too: its own mass; between them none.
    assert [mass_on(bridge, spring) for spring in bridge.springs] == [3.0, 5.0, None]
