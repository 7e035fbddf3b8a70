import numpy as np
import pytest

from eventpound.accuracy.near_misses import largest_turns


def test_turning_points_of_a_sine():
    t = np.linspace(0.0, 12.0, 301)
    turns = largest_turns(t, np.sin(t), np.cos(t), -np.sin(t), 0.5)
    # h^6/46080 of the sixth derivative for the value, h^5 of the rate's error for the time.
    h = t[1]
    assert [turn.t for turn in turns[:2]] == pytest.approx([np.pi / 2, 5 * np.pi / 2], abs=h**5)
    assert [turn.value for turn in turns[:2]] == pytest.approx([1.0, 1.0], abs=h**6 / 46080)
    assert all(turn.between for turn in turns)


def test_a_bounce_turns_where_two_samples_have_one_time():
    """u = 1 - |t - 1| at a barrier at 1."""
    t = np.array([0.0, 0.5, 1.0, 1.0, 1.5])
    x, v = 1.0 - np.abs(t - 1.0), np.array([1.0, 1.0, 1.0, -1.0, -1.0])
    turns = largest_turns(t, x, v, np.zeros(5), 0.9)
    assert [(turn.t, turn.value, turn.sample, turn.between) for turn in turns] == [
        (1.0, 1.0, 3, False)
    ]


def test_a_motion_that_ends_rising_is_largest_at_its_end():
    t = np.linspace(0.0, 1.0, 11)
    turns = largest_turns(t, t, np.ones(11), np.zeros(11), 0.5)
    assert [turn.t for turn in turns] == [1.0]
