"""Groups handed on as one address: records in them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from eventpound.numerics.arrays import Floats
from eventpound.numerics.by_address import by_address, change_first, whole, with_address
from eventpound.numerics.compiled import scalar_kernel
from eventpound.numerics.records import NamedNumbers


class Mass(NamedNumbers, room=3):
    """A record with an array."""

    x: float
    terms: Floats


class Pair(NamedTuple):
    """Records in an array, one of them by itself, and an array."""

    all: Any
    one: Any
    y: Floats


class Several(NamedTuple):
    """Records in an array."""

    all: Any
    factor: float


@scalar_kernel
def fill(pair: Pair) -> float:
    """Write into records by address, and read them."""
    pair.one.x = 2.0 * pair.y[0]
    pair.one.terms[2] = pair.all[1].x
    return pair.all[0].x


@scalar_kernel
def fill_all(several: Several, y: Floats) -> float:
    """The same, with an address of parts of what Python handed over."""
    return several.factor * fill(by_address(Pair(several.all, several.all[1], y)))


def test_records_go_by_address() -> None:
    masses = np.zeros(2, Mass.layout)
    masses[0].x = 3.0
    assert fill_all(with_address(Several(masses, 0.5)), np.array([7.0])) == 1.5
    assert masses[1].x == 14.0
    assert masses[1].terms.tolist() == [0.0, 0.0, 14.0]


def test_layouts_are_told_apart_by_their_class() -> None:
    other = np.dtype((type("Other", (Mass,), {}), np.dtype([("x", float)])))
    groups = [with_address(Several(np.zeros(2, each), 0.5)) for each in (Mass.layout, other)]
    kinds = {each._numba_type_ for each in groups}
    assert len(kinds) == 2


class Inner(NamedTuple):
    """A number and arrays."""

    factor: float
    y: Floats
    z: Floats


class Scaled(NamedTuple):
    """A group, and an array beside it."""

    first: Inner
    second: Floats


@scalar_kernel
def total(inner: Inner) -> float:
    """All numbers of a group without an address."""
    return inner.factor * inner.y[0] + inner.z[0]


@scalar_kernel
def total_by_address(scaled: Scaled) -> float:
    """The same of one by address, and the number beside it."""
    return total(whole(scaled.first)) + scaled.second[0]


def test_the_first_group_at_an_address_is_exchanged() -> None:
    y, z = np.array([2.0]), np.array([3.0, 4.0])
    addressed = with_address(Scaled(Inner(0.5, y, z), np.array([100.0])))
    assert total_by_address(addressed) == 104.0
    change_first(addressed, Inner(10.0, y, np.array([5.0])))
    assert total_by_address(addressed) == 125.0
    assert addressed.first.factor == 10.0
    with pytest.raises(TypeError, match="Inner is of another kind"):
        change_first(addressed, Inner(10.0, y, np.array([5])))
