"""Equilibria beside the independent program: a sample; and that what is wrong is seen.

The long run is a command: ``python -m tests.equilibria 1000``.
"""

from dataclasses import replace

import numpy as np
import pytest

from eventpound.scene import BARRIER, Body, Contact, Force, Linear, Scene, Spring
from eventpound.scene.statics import in_equilibrium
from tests.equilibria.examined import LIMITS, examine
from tests.equilibria.oracle import judge, loose, room

LOCKED, PUSHED_SLOWLY, TWO_POINTS, NO_LENGTH = 109, 360, 27, 5063
"""A row without room; forces that reach a stiff body through soft ones; contacts at points;
no length but zero."""
SEEDS = (LOCKED, PUSHED_SLOWLY, TWO_POINTS, NO_LENGTH, *range(28))
PAIR = Scene(
    (Body("a", 1.0), Body("b", 1.0)),
    (Spring("1", ("ground", "a"), Linear(100.0)), Spring("2", ("ground", "b"), Linear(50.0))),
    contacts=(Contact("ab", "a", "b", 0.02, 0.5),),
    forces=(Force("a", 10.0),),
)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_scenes_stand_where_forces_balance(seed):
    found = examine(seed, solvers=())
    assert not found.wrong, found


@pytest.mark.parametrize("seed", range(30))
def test_random_scenes_with_soil_and_sliders_stand_where_forces_balance(seed):
    found = examine(seed, solvers=(), memory=True)
    assert not found.wrong, found


@pytest.mark.parametrize("seed", range(4))
def test_random_scenes_with_soil_and_sliders_stay_there(seed):
    found = examine(seed, solvers=("cvode",), memory=True)
    assert not found.wrong, found


@pytest.mark.parametrize("seed", [LOCKED, *range(4)])
@pytest.mark.parametrize("solver", ["fast", "cvode"])
def test_random_scenes_stay_there(seed, solver):
    found = examine(seed, solvers=(solver,))
    assert not found.wrong, found


def test_what_is_out_of_place_is_seen():
    standing = in_equilibrium(PAIR)
    assert judge(PAIR, standing).unbalanced <= LIMITS["unbalanced"]
    a, b = standing.bodies
    together = (replace(x, displacement=x.displacement + 1e-6) for x in (a, b))
    assert judge(PAIR, replace(standing, bodies=tuple(together))).unbalanced > 1e-6
    pressed = replace(standing, bodies=(replace(a, displacement=a.displacement + 1e-6), b))
    assert judge(PAIR, pressed).overlap > 1e-6
    floating = replace(PAIR, springs=(), forces=())
    moved = replace(floating, bodies=(Body("a", 1.0, -0.01), Body("b", 1.0)))
    assert judge(floating, moved).farther > 0.1


def test_what_has_no_equilibrium_is_seen():
    assert loose(PAIR) is None
    away = loose(replace(PAIR, springs=PAIR.springs[:1], forces=(Force("b", 1.0),)))
    assert away is not None
    assert np.flatnonzero(away).tolist() == [1]
    tight = Contact("left", BARRIER, "a", -0.02, 0.5), Contact("right", "a", BARRIER, 0.01, 0.5)
    assert not room(replace(PAIR, contacts=tight))
    assert room(replace(PAIR, contacts=(tight[0], replace(tight[1], gap=0.02))))
