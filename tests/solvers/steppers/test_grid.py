"""Where steps end: at breakpoints of the ground motion and at samples."""

import numpy as np
import pytest

from eventpound.motion.pulses import Cosine
from eventpound.motion.record import Record
from eventpound.solvers.timestepping.steps import segments


def _nodes(motion, start, end, longest):
    nodes = [start]
    for segment in segments(motion.pieces(), start, end, longest):
        assert segment.start == pytest.approx(nodes[-1], abs=1e-12)
        assert segment.step <= longest * (1.0 + 1e-9)
        nodes += [segment.start + (i + 1) * segment.step for i in range(segment.steps)]
    assert nodes[-1] == pytest.approx(end, abs=1e-12)
    return np.array(nodes)


def _has(nodes, times):
    return all(np.abs(nodes - t).min() < 1e-12 for t in times)


def test_a_pulse_ends_with_a_step():
    motion = Cosine(1.0, 0.77, start=0.25)
    nodes = _nodes(motion, 0.0, 3.0, 0.01)
    assert _has(nodes, (0.25, 1.02))


@pytest.mark.parametrize("longest", [0.02, 0.0199, 0.007, 0.0033])
@pytest.mark.parametrize("start", [0.0, 0.013, -0.4])
def test_every_sample_is_met(longest, start):
    motion = Record(np.arange(1.0, 52.0), 0.02)
    end = 1.537
    nodes = _nodes(motion, start, end, longest)
    assert _has(nodes, [t for t in 0.02 * np.arange(51) if t > start])


def test_a_step_longer_than_the_sampling_interval_is_kept():
    nodes = _nodes(Record(np.arange(1.0, 52.0), 0.02), 0.0, 1.0, 0.05)
    np.testing.assert_allclose(np.diff(nodes), 0.05)


def test_a_run_shorter_than_a_step_is_one_step():
    assert _nodes(Cosine(1.0, 5.0), 0.0, 0.3, 1.0).size == 2
