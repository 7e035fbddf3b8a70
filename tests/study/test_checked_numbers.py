"""Numbers of many variants are checked where they meet others."""

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.study.checked_numbers import CheckedRanges, variants_to_check
from tests.scene.test_parameters import PLACES, SCENE, told_of


def test_numbers_one_by_one_are_checked_where_they_meet_others():
    ranges = CheckedRanges(SCENE, 0.0)
    for key, value in (("gap", 0.3), ("gap", 0.1), ("initial_gap", 0.3)):
        ranges.check({PLACES[f"spring.soil.{key}"]: value})
    with pytest.raises(InputError, match="initial_gap"):
        ranges.check({PLACES["spring.soil.initial_gap"]: 0.001})


def test_of_many_variants_few_are_looked_at():
    rng = np.random.default_rng(1)
    columns = {
        "contact.c.gap": rng.uniform(0.0, 0.1, 300),
        "spring.s.stiffness": rng.uniform(0.0, 10.0, 300),
        "body.a.mass": rng.uniform(1.0, 2.0, 300),
    }
    assert len(told_of(SCENE, columns)) == 6
    assert variants_to_check(SCENE, {}, 3).tolist() == []
