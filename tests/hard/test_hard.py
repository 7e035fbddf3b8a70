"""The catalogue of hard scenes: known answers are met, and the solvers agree or refuse alike."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound import simulate
from tests.hard.catalogue import Hard, catalogue
from tests.hard.outcome import SOLVERS, outcome, verdict

CATALOGUE = catalogue()
SCALES = [hard for hard in CATALOGUE if hard.name.startswith("scale-")]


@pytest.mark.parametrize("hard", CATALOGUE, ids=lambda hard: hard.name)
def test_right_or_refused(hard: Hard) -> None:
    word, remark = verdict(hard, [outcome(hard, solver) for solver in SOLVERS])
    assert word in ("agree", "refused"), remark


@pytest.mark.parametrize("solver", SOLVERS)
def test_scales(solver: str) -> None:
    """Peaks in parts of L_e do not depend on the units of length and time."""
    peaks = []
    for hard in SCALES:
        response = simulate(hard.case, solver=solver)
        scales = hard.case.scene.motion.scales()
        assert scales is not None
        peaks.append(response.peaks["abs_max"].iloc[0] * scales.omega_g**2 / scales.a_g)
    np.testing.assert_allclose(peaks, peaks[0], rtol=1e3 * SCALES[0].case.solver.rtol)
