"""A run is as wrong as it says itself, with nobody else to judge it, or it warns."""

import pytest

from eventpound import Case, load_case
from eventpound.accuracy.estimate import estimate_errors
from eventpound.accuracy.quantities import values_by_name
from eventpound.simulation import response_of
from eventpound.solvers import knows_scene, solver_named
from tests.accuracy.honesty import CASES, single_runs, true_error, true_run, word
from tests.hard.catalogue import REFUSED

HOLDS = (
    "bridge-pulse",
    "elastoplastic-barrier",
    "hard/exponent-20",
    "pair",
    "pair-with-law",
    "problems/46-row-tiny-gaps",
    "restrained-decks",
    "symmetric-triplet",
)
SOLVERS = ("cvode", "ida", "fast")
TELLS_NOTHING = ("hard/chaotic", "hard/short-pulse")
"""Of these the tolerance of `cvode` tells a number or an event too little."""


def _found(case: Case, solver: str) -> str:
    response = response_of(case, solver)
    error, _ = true_error(values_by_name(case.scene, response.recording), true_run(case))
    return word(error, estimate_errors(response, solver))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", HOLDS)
def test_what_a_run_says_of_itself_is_true(name, solver):
    case = load_case(CASES / name)
    if not knows_scene(solver_named(solver), case.scene):
        pytest.skip("the solver does not take the scene")
    assert _found(case, solver) == "holds"


@pytest.mark.sweep
def test_no_shipped_case_is_more_wrong_than_it_says():
    cases = {folder.name: load_case(folder) for folder in single_runs(())}
    able = {name: case for name, case in cases.items() if name not in REFUSED}
    assert [name for name, case in able.items() if _found(case, "cvode") == "unsaid"] == []


@pytest.mark.parametrize("name", TELLS_NOTHING)
def test_what_the_tolerance_does_not_tell_warns(name):
    assert _found(load_case(CASES / name), "cvode") == "warns"


def test_of_what_is_off_by_more_than_it_says_nothing_holds():
    estimate = {"largest": {"part": 1e-9}, "warnings": []}
    assert word(1.9e-9, estimate) == "holds"
    assert word(2.1e-9, estimate) == "unsaid"
    assert word(2.1e-9, estimate | {"warnings": ["off"]}) == "warns"
