"""Ends that springs and contacts cannot have are refused, each by one line."""

import pytest

from eventpound.scene.end_check import end_problems
from eventpound.scene.point import Point
from eventpound.scene.problem import Part
from tests.scene.test_check import SCENE

WRONG = [
    (("ground", "x"), "found 'x'; accepted: two different ones of a, b, ground"),
    (("a", "a"), "found ['a', 'a']; accepted: two different ones of a, b, ground"),
    (("ground", "ground"), "found ['ground', 'ground']; accepted: two different ones"),
    ((Point({"a": 0.5, "b": 0.4}), "ground"), "found 0.9; accepted: weights of a point"),
    ((Point({"a": 0.5, "b": 0.5}), "a"), "found 'a'; accepted: no body at both ends"),
]


@pytest.mark.parametrize(("sides", "fragment"), WRONG)
def test_ends_that_cannot_be_are_refused(sides, fragment):
    (problem,) = end_problems(Part("spring", 1, "s"), sides, SCENE, "ground")
    assert f"spring 1 (s): between: {fragment}" in str(problem)
