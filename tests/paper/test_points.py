"""Points of the paper's figures beside a program that shares nothing with the package."""

import numpy as np
import pytest

from eventpound.study.reading import load_study
from tests.paper import points


@pytest.mark.parametrize(
    "name",
    [
        "figure-02",
        "figure-09",
        *(pytest.param(f"figure-0{i}", marks=pytest.mark.sweep) for i in (5, 7)),
    ],
)
def test_peaks_of_a_study(name):
    """All of them: python -m tests.paper.points."""
    study = load_study(points.CASES / name).study
    for run in np.random.default_rng(6).choice(study.size, 1, replace=False).tolist():
        point = points.of_study(name, study, run)
        assert point.apart <= point.allowed, point


@pytest.mark.sweep
def test_displacements_of_the_bridge():
    for point in points.of_bridge("figure-11", 1, np.random.default_rng(3)):
        assert point.apart <= point.allowed, point
