"""Points of the paper's figures beside a program that shares nothing with the package."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound.study.reading import load_study
from tests.paper import points
from tests.paper.program import Program, Row, pulse


@pytest.mark.parametrize(
    "name",
    [
        "figure-02",
        "figure-09",
        *(pytest.param(f"figure-0{i}", marks=pytest.mark.sweep) for i in (5, 7)),
    ],
)
def test_peaks_of_a_study(name: str) -> None:
    """All of them: python -m tests.paper.points."""
    study = load_study(points.CASES / name).study
    for run in np.random.default_rng(6).choice(study.size, 1, replace=False).tolist():
        point = points.of_study(name, study, run)
        assert point.apart <= point.allowed, point


@pytest.mark.sweep
def test_displacements_of_the_bridge() -> None:
    for point in points.of_bridge("figure-11", 1, np.random.default_rng(3)):
        assert point.apart <= point.allowed, point


def test_the_program_knows_a_free_vibration_and_a_bounce() -> None:
    """An elastic body under a sine of its own frequency, and the same held by a barrier.

    u'' + u = −sin t from rest is u = (t cos t − sin t)/2, largest where t sin t = 0.
    """
    one = np.ones(1)
    free = Row(one, one, 0.0 * one, one, 0.0 * one, (), 0.0)
    end = 2.0 * np.pi
    peak = Program(free, 1.0, 1.0).run(pulse("sine", 1.0, 1.0, False, end)).peak
    assert peak[0] == pytest.approx(np.pi, rel=1e-10)
    # A plastic barrier where it starts: it goes left, comes back to it at t = tan t and rests.
    held = Row(one, one, 0.0 * one, one, 0.0 * one, ((0, -1, 0.0),), 0.0)
    answer = Program(held, 1.0, 1.0).run(pulse("sine", 1.0, 1.0, False, end))
    assert answer.peak[0] == pytest.approx(np.pi / 2.0, rel=1e-10)
    assert answer.impacts == 1
    assert answer.rows == []


def test_points_beyond_what_is_allowed_are_an_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    two = [points.Point("figure-04: a", 1.0, 1.0 + 2e-6, 1.0, 1e-6)]
    two.append(points.Point("figure-04: b", 1.0, 1.0, 1.0, 1e-6))
    monkeypatch.setattr(points, "drawn", lambda count, seed: iter(two))
    assert points.main() == 1
    assert "| `figure-04` | 2 | 1.0e-06 | 2.0e-06 | 1e-06 | 1 |" in capsys.readouterr().out
