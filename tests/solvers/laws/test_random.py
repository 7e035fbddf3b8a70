"""Random scenes with contact laws that once differed between solvers."""

from __future__ import annotations

import pytest

from tests.benchmarks.agreement import judge
from tests.solvers.random_scenes import scene_with_laws


@pytest.mark.parametrize(
    "seed",
    [
        190,  # one contact pressed shut at first closes another that only touches
        223,  # a spring with a kink does
        79,  # an opening and a closing of two contacts without play at one instant
        322,  # a local power series from a closing on, without the force
    ],
)
def test_agrees(seed: int) -> None:
    verdict = judge(seed, "cvode", scene_with_laws)
    assert verdict.word in ("agree", "agree when tight"), verdict
