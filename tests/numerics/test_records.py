"""Records of named numbers, as Python reads them."""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.records import NamedNumbers


class Row(NamedNumbers, room=2):
    """A field of every kind."""

    x: float
    steps: int
    done: bool
    terms: Floats


def test_a_record_is_a_view_of_its_array():
    rows = np.zeros(3, Row.layout)
    row = rows[1]
    row.x, row.done = 0.5, True
    row.steps += 4
    row.terms[1] = 2.0
    assert rows["x"].tolist() == [0.0, 0.5, 0.0]
    assert rows["steps"].tolist() == [0, 4, 0]
    assert rows["done"].tolist() == [False, True, False]
    assert (row.x, row.steps, row.done) == (0.5, 4, True)
    assert rows["terms"][1].tolist() == [0.0, 2.0]
