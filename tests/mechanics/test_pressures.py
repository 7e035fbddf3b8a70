"""The smallest forces of locked contacts that do not pull."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import linprog

from eventpound.mechanics.descriptor import contact_rows
from eventpound.mechanics.followers import held_closed
from eventpound.mechanics.model import assemble
from eventpound.mechanics.pressures import press_locked, smallest_pressures
from eventpound.mechanics.supported import lowered
from eventpound.motion import NoMotion, Sine
from eventpound.scene import BARRIER, Body, Contact, Point, Scene, Support
from tests.numerics.problems import graph


def _left_of(W: np.ndarray, x: np.ndarray) -> float:
    """By how much x misses being the smallest: the least t of a linear program.

    x is the projection of the origin on ``{x >= 0, Wᵀ x = r}`` exactly if there are y with
    ``(W y)_i = x_i`` where ``x_i > 0`` and ``(W y)_i <= 0`` where ``x_i = 0``.
    """
    presses = x > 1e-9 * x.max(initial=1.0)
    one = np.ones((x.size, 1))
    above = np.hstack((W, -one)), x
    below = np.hstack((-W[presses], -one[presses])), -x[presses]
    found = linprog(
        np.append(np.zeros(W.shape[1]), 1.0),
        np.vstack((above[0], below[0])),
        np.concatenate((above[1], below[1])),
        bounds=[(None, None)] * W.shape[1] + [(0.0, None)],
    )
    assert found.success
    return float(found.fun)


def test_random_locked_groups_are_pressed_as_little_as_may_be():
    dice, several, shifted = np.random.default_rng(36), 0, 0
    for _ in range(60):
        rows = graph(dice, 0.0).W.T
        W = rows[held_closed(rows)]
        if W.shape[0] == 0:
            continue
        given = dice.normal(size=(3, W.shape[0])) * 10.0 ** dice.uniform(-6, 6)
        several += W.shape[0] - np.linalg.matrix_rank(W) > 1
        for before, x in zip(given, smallest_pressures(W, given), strict=True):
            size = np.abs(before).max()
            assert x.min() >= 0.0
            np.testing.assert_allclose(x @ W, before @ W, atol=1e-12 * size)
            assert _left_of(W, x / size) <= 1e-9
            shifted += (x == 0.0).any()
    assert several > 4
    assert shifted > 60


def test_a_long_squeezed_row_is_pressed_until_none_pulls():
    # The self-stress is (1, ..., 1): the smallest forces are those whose smallest is none.
    bodies = 60
    row = [BARRIER, *(f"b{i}" for i in range(bodies)), BARRIER]
    contacts = tuple(Contact(f"c{i}", a, b, 0.0, 0.5) for i, (a, b) in enumerate(pairwise(row)))
    model = assemble(Scene(tuple(Body(name, 1.0) for name in row[1:-1]), contacts=contacts))
    given = np.random.default_rng(2).normal(size=(3, bodies + 1))
    given[2] = 0.0
    told, none = given.copy(), np.zeros(bodies + 1, bool)
    press_locked(np.zeros(given.shape), told, none, model)
    expected = given - given.min(axis=1)[:, None]
    np.testing.assert_allclose(told, expected, atol=1e-13)


@pytest.mark.parametrize("at_point", [False, True])
def test_what_is_not_locked_keeps_its_forces(at_point):
    """A row between barriers, beside it two contacts between a free pair and one that is open."""
    right = Point({"a": 1.0}) if at_point else "a"
    scene = Scene(
        tuple(Body(name, 1.0) for name in "abcd"),
        contacts=(
            Contact("left", BARRIER, right, 0.0, 0.5),
            Contact("right", "a", BARRIER, 0.0, 0.5),
            Contact("above", "b", "c", 0.0, 0.5),
            Contact("below", "b", "c", 0.0, 0.5),
            Contact("open", "d", BARRIER, 0.1, 0.5),
        ),
    )
    model = assemble(scene)
    gap = np.tile([0.0, 0.0, 0.0, 0.0, 0.1], (2, 1))
    force = np.array([[-3.0, 0.0, 7.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0, 0.0]])
    unique = np.array([False, False, False, False, True])
    press_locked(gap, force, unique, model)
    expected = [[0.0, 3.0, 7.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0, 0.0]]
    np.testing.assert_allclose(force, expected, atol=1e-15)
    assert (contact_rows(model)[0] == [1.0, 0.0, 0.0, 0.0]).all()


def test_what_two_supports_lock_is_pressed_as_between_barriers():
    row = ("pier", "a", "b", "wall")
    contacts = tuple(Contact(x + y, x, y, 0.0, 0.5) for x, y in pairwise(row))
    scene = Scene((Body("a", 1.0), Body("b", 2.0)), contacts=contacts, motion=Sine(1.0, 1.0))
    still = tuple(Support(name, motion=NoMotion()) for name in ("pier", "wall"))
    model = assemble(lowered(replace(scene, supports=still), 0.0))
    force = np.array([[-3.0, 1.0, 2.0]])
    press_locked(np.zeros((1, 3)), force, np.zeros(3, bool), model)
    np.testing.assert_allclose(force, [[0.0, 4.0, 5.0]], atol=1e-15)
