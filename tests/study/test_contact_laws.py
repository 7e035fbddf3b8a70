"""The study of contact laws: what each comes to with its stiffness, beside Newton's law."""

import csv
from dataclasses import replace

import pytest

from eventpound import load_case, simulate
from eventpound.accuracy.compare import rigid
from eventpound.study.reading import load_study
from eventpound.study.table import compute, header
from tests.models import CASES

FOLDER = CASES
KEY = "residual.flexible"


def newton(restitution: float) -> float:
    """What is left under Newton's law."""
    case = load_case(FOLDER / "pair-with-law")
    scene = rigid(case.scene, restitution)
    return float(simulate(replace(case, scene=scene), "fast", 1e-9).quantity(KEY))


@pytest.fixture(scope="module")
def stiffest():
    """What is left with the stiffest of each law."""
    study = load_study(FOLDER / "contact-laws").study
    table = header(study) + b"".join(compute(study, chunk) for chunk in study.chunks())
    rows = list(csv.DictReader(table.decode().splitlines()))
    assert len(rows) == 5 * 41
    assert all(row["success"] == "True" for row in rows)
    return {row["part"]: float(row[KEY]) for row in rows}


def test_the_line_is_newtons_law():
    (plan,) = load_study(FOLDER / "contact-laws").figures
    assert plan.levels == pytest.approx((newton(0.6),), abs=1e-7)


@pytest.mark.sweep
def test_laws_come_to_the_rigid_one_of_the_restitution_that_they_give(stiffest):
    # Times in contact of 0.6 ms and 0.8 ms in a motion of a second.
    assert stiffest["linear"] == pytest.approx(newton(1.0), rel=5e-3)
    assert stiffest["hertz"] == pytest.approx(newton(1.0), rel=5e-3)
    assert stiffest["kelvin-voigt"] == pytest.approx(newton(0.6), rel=5e-3)
    # Its formula is a fit: 0.596 for 0.6.
    assert stiffest["jankowski"] == pytest.approx(newton(0.6), rel=1e-2)
    # 0.756 for 0.6: `tests.solvers.laws.quadrature`.
    assert stiffest["hertz-damp"] == pytest.approx(newton(0.756), rel=1e-2)
    assert abs(stiffest["hertz-damp"] / newton(0.6) - 1.0) > 0.05
