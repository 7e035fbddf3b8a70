"""Problems of the set with what they are judged by."""

import pytest

from eventpound import score
from eventpound.problems.collection import read_collection
from eventpound.problems.entrants import materialized
from tests.models import CASES

SET = read_collection(CASES / "problems")
HIT = "19-graze-hit-1e-03"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return materialized(SET, SET.some([HIT])[0], tmp_path_factory.mktemp("set"))


@pytest.fixture(scope="module")
def problem(folder):
    return score.read_problem(folder)


@pytest.fixture(scope="module")
def resting(tmp_path_factory):
    """Eleven impacts, their limit, a rest, and the end of it."""
    return score.read_problem(
        materialized(SET, SET.some(["14"])[0], tmp_path_factory.mktemp("resting"))
    )
