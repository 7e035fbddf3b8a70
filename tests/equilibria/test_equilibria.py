"""Equilibria beside the independent program: a sample; and that what is wrong is seen.

The long run is a command: ``python -m tests.equilibria 1000``.
"""

import pytest

from tests.equilibria.examined import examine

LOCKED, PUSHED_SLOWLY, TWO_POINTS, NO_LENGTH = 109, 360, 27, 5063
"""A row without room; forces that reach a stiff body through soft ones; contacts at points;
no length but zero."""
SEEDS = (LOCKED, PUSHED_SLOWLY, TWO_POINTS, NO_LENGTH, *range(20))


@pytest.mark.parametrize("seed", SEEDS)
def test_random_scenes_stand_where_forces_balance(seed):
    found = examine(seed, solvers=())
    assert not found.wrong, found


@pytest.mark.parametrize("seed", range(20))
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
