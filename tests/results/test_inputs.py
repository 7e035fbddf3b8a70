"""Tables of what a case was understood to be."""

import math
from pathlib import Path

import pytest

from eventpound.case import read_case
from eventpound.results.inputs import inputs_of
from tests.scene.test_at_rest import CABLE, K, M, document


@pytest.mark.parametrize("damping", ["dashpot", "modal_damping", "rayleigh"])
def test_a_case_that_starts_in_equilibrium_is_damped_as_it_stands(damping):
    table = {
        "dashpot": {"between": ["ground", "deck"], "ratio": 0.05},
        "modal_damping": {"bodies": ["deck"], "ratio": 0.05},
        "rayleigh": {"springs": ["pier", "cable"], "ratio": 0.05, "mode": 1},
    }[damping]
    for start, k in (("equilibrium", K + CABLE), ("initial", K)):
        given = document(0.02, start=start)
        del given["dashpot"]
        if damping == "rayleigh" and start == "initial":
            table["springs"] = ["pier"]
        case = read_case(given | {damping: [table]}, Path("case.toml"))
        total = sum(dashpot.coefficient for dashpot in case.scene.dashpots)
        assert total == pytest.approx(0.05 * 2.0 * math.sqrt(k * M), rel=1e-8)
        (mode,) = inputs_of(case)["structures"][0]["initial"]
        assert mode["damping"] == pytest.approx(0.05, rel=1e-8)
        again = read_case(case.understood, Path("case.toml"))
        assert again.scene == case.scene
        assert inputs_of(again) == inputs_of(case)
