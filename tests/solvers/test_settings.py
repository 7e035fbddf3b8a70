"""What `[solver]` may say, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import pytest

from eventpound.case import write_template
from eventpound.case.loading import load_case
from eventpound.errors import InputError
from eventpound.simulation import simulate


@pytest.fixture
def case(tmp_path):
    write_template(tmp_path / "case")
    return load_case(tmp_path / "case")


def _with(case, **changes):
    return replace(case, solver=replace(case.solver, **changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"settings": {"method": "RK4"}}, "method = 'RK4'; accepted: Adams or BDF"),
        ({"settings": {"theta": 0.5}}, "theta is not a setting of cvode; accepted: method"),
        ({"rtol": 0.5}, "rtol = 0.5; accepted: 1e-14 to 0.01"),
        ({"name": "euler"}, "solver = 'euler' is not known; accepted: cvode"),
    ],
)
def test_refused(case, changes, message):
    with pytest.raises(InputError, match=message.replace("(", r"\(")):
        simulate(_with(case, **changes))


def test_adams_and_bdf_agree(case):
    adams = simulate(case)
    bdf = simulate(_with(case, settings={"method": "BDF"}))
    wanted = adams.peaks["min"].iloc[0]
    # Two methods, each within some hundred times rtol = 1e-9 of the motion.
    assert bdf.peaks["min"].iloc[0] == pytest.approx(wanted, rel=2e-7)
    assert bdf.impacts == adams.impacts
