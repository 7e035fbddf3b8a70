"""Modes against SciPy's eigenproblems and closed forms; what swings on a spring or isolators."""

import math

import numpy as np
import pytest
from scipy.linalg import eig, eigh

from eventpound.case.damping import read_group_damping
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene import (
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Dashpot,
    Deck,
    Linear,
    Scene,
    Slider,
    Spring,
)
from eventpound.scene.modes import modes_of, stiffness_proportional
from eventpound.scene.periods import longest_period
from eventpound.units import STANDARD_GRAVITY

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
def test_modes_are_those_of_scipy(yielded):
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


def test_a_deck_on_friction_pendulums_has_the_period_of_their_radius():
    laws = [Slider.pendulum(0.05, weight, 2.0) for weight in (3e6, 7e6)]
    ends = (GROUND, "deck")
    springs = tuple(Spring(f"b{i}", ends, law) for i, law in enumerate(laws))
    scene = Scene((Body("deck", 1e7 / STANDARD_GRAVITY),), springs)
    slipping = 2.0 * np.pi * np.sqrt(2.0 / STANDARD_GRAVITY)
    assert modes_of(scene, ["deck"]).period == pytest.approx(slipping, rel=1e-14)
    assert longest_period(scene) == pytest.approx(slipping, rel=1e-14)
    assert [law.numbers["T_slip"] for law in laws] == pytest.approx([slipping] * 2, rel=1e-14)


def test_rayleigh_damping_of_modes_is_the_ratio_there():
    scene, *_ = building()
    names = [body.name for body in scene.bodies]
    table = Table({"bodies": names, "ratio": 0.05, "modes": [1, 3]}, "[[rayleigh]] 1", [])
    dashpots = read_group_damping([table], [], scene.bodies, scene.springs)
    found = modes_of(Scene(scene.bodies, scene.springs, dashpots), names)
    assert found.damping[[0, 2]] == pytest.approx(0.05, rel=1e-12)
    assert found.damping[1] < 0.05 < found.damping[3]


@pytest.mark.parametrize("modes", [[0, 1], [1, 6], [1], ["1", 2], [True, 2], 3])
def test_modes_that_there_are_not(modes):
    scene, *_ = building()
    problems: list = []
    names = [body.name for body in scene.bodies]
    table = Table({"bodies": names, "ratio": 0.05, "modes": modes}, "[[rayleigh]] 1", problems)
    assert read_group_damping([table], [], scene.bodies, scene.springs) == ()
    assert [problem.key for problem in problems] == ["modes"]


@pytest.mark.parametrize("mass", [1e-300, 1.7976931348623157e308])
def test_shares_of_masses_whose_sum_is_no_double(mass):
    bodies = (Body("a", 0.5 * mass), Body("b", mass))
    springs = (
        Spring("s", (GROUND, "a"), Linear(1e-2 * mass)),
        Spring("t", ("a", "b"), Linear(1e-2 * mass)),
    )
    assert modes_of(Scene(bodies, springs), ["a", "b"]).share.sum() == pytest.approx(1.0)


def test_a_structure_that_nothing_holds():
    scene = Scene((Body("a", 2.0), Body("b", 3.0)), (Spring("s", ("a", "b"), Linear(12.0)),))
    found = modes_of(scene, ["a", "b"])
    assert found.period[0] == math.inf
    assert math.isnan(found.damping[0])
    # The two swing against each other with the reduced mass 6/5.
    assert found.period[1] == pytest.approx(2.0 * math.pi / math.sqrt(10.0), rel=1e-12)


STOREYS = ("s1", "s2", "s3")
FLOORS = ("base", "f1", "f2", "f3")
# Mass and stiffness of a base on isolators and of three storeys.
MASS = np.array([4e5, 3e5, 3e5, 2.5e5])
STIFFNESS = np.array([7.9e6, 4.5e8, 4.0e8, 3.5e8])
ISOLATORS = BoucWen(STIFFNESS[0], 6e5, 0.01)


def isolated_building(dashpots: tuple[Dashpot, ...] = ()) -> Scene:
    ends = (GROUND, *FLOORS)
    laws = [ISOLATORS, *map(Linear, STIFFNESS[1:].tolist())]
    names = ("isolators", *STOREYS)
    springs = [Spring(n, ends[i : i + 2], laws[i]) for i, n in enumerate(names)]
    bodies = [Body(name, m) for name, m in zip(FLOORS, MASS.tolist(), strict=True)]
    return Scene(tuple(bodies), tuple(springs), dashpots)


@pytest.mark.parametrize("yielded", [False, True])
def test_damping_of_isolated_modes_is_that_of_the_eigenvalues_of_the_state_matrix(yielded):
    scene = isolated_building()
    dashpots = stiffness_proportional(scene.bodies, scene.springs, STOREYS, "2 %", mode=2)
    k = STIFFNESS.copy()
    k[0] += 0.0 if yielded else ISOLATORS.strength / ISOLATORS.yield_displacement
    c = np.array([0.0, *(dashpot.coefficient for dashpot in dashpots)])
    inverse, zero = np.diag(1.0 / MASS), np.zeros((4, 4))
    state = np.block([[zero, np.eye(4)], [-inverse @ chain(k), -inverse @ chain(c)]])
    values = eig(state, right=False)
    values = sorted(values[values.imag > 0.0], key=abs)
    found = modes_of(isolated_building(dashpots), FLOORS, yielded)
    # The modes exchange a little: in a ratio second order in all of them, (5 %)^2.
    assert found.damping == pytest.approx([-v.real / abs(v) for v in values], rel=2.5e-3)
    if yielded:
        assert found.damping[1] == pytest.approx(0.02, rel=1e-12)
        # The storeys do not damp what goes on in the isolators.
        assert found.damping[0] < 1e-4


def test_stiffness_proportional_damping_by_a_period():
    scene = isolated_building()
    found = stiffness_proportional(scene.bodies, scene.springs, ["s2"], 0.03, period="0.2 s")
    # b = 2 xi/omega = xi T/pi
    assert [dashpot.between for dashpot in found] == [("f1", "f2")]
    assert found[0].coefficient == pytest.approx(0.03 * 0.2 / math.pi * 4.0e8)


@pytest.mark.parametrize(
    ("damped", "keys", "said"),
    [
        (STOREYS, {"mode": 1}, "more than half of the strain energy: 2, 3, 4"),
        (STOREYS, {"mode": 5}, "found 5"),
        (STOREYS, {"mode": True}, "found True"),
        (STOREYS, {}, "one of mode and period"),
        (STOREYS, {"mode": 2, "period": 0.2}, "one of mode and period"),
        (STOREYS, {"period": -0.2}, "none negative"),
        (["s4"], {"mode": 2}, "found 's4'; accepted: some of isolators, s1, s2, s3, stop"),
        ([], {"mode": 2}, "found none"),
        (["stop"], {"mode": 2}, "springs that resist at rest"),
        (["s1", "apart"], {"mode": 2}, "2 structures; accepted: springs of one"),
    ],
)
def test_what_no_spring_can_be_damped_by(damped, keys, said):
    scene = isolated_building()
    bodies = (*scene.bodies, Body("other", 1e5))
    springs = (
        *scene.springs,
        Spring("stop", (GROUND, "f3"), BilinearElastic(0.0, 1e3)),
        *([Spring("apart", (GROUND, "other"), Linear(1e7))] if "apart" in damped else []),
    )
    with pytest.raises(InputError, match=said):
        stiffness_proportional(bodies, springs, damped, 0.02, **keys)


def test_a_mode_in_which_masses_balance_has_none_of_them():
    bodies = tuple(Body(name, 3.0e5) for name in "abc")
    springs = [Spring(f"k{i}", ("ground", name), Linear(1.0e7)) for i, name in enumerate("abc")]
    joined = [
        Spring(f"j{i}", ends, Linear(7.0e6)) for i, ends in enumerate((("a", "b"), ("b", "c")))
    ]
    share = modes_of(Scene(bodies, (*springs, *joined)), ["a", "b", "c"]).share
    assert share.tolist() == [pytest.approx(1.0), 0.0, 0.0]


def test_masses_take_part_along_and_across_in_plan():
    deck = Deck("D", "900 t", "36 m", "11 m", 0.3)
    held = {"D.x": 4e7, "D.y": 2e7, "D.turn": 1e7}
    springs = [Spring(name, (GROUND, name), Linear(k)) for name, k in held.items()]
    modes = modes_of(Scene(deck.bodies(), springs, decks=[deck]), list(held))
    np.testing.assert_allclose(modes.share, [0.0, 0.0, 1.0], atol=1e-14)
    assert modes.share_across is not None
    np.testing.assert_allclose(modes.share_across, [0.0, 1.0, 0.0], atol=1e-14)
