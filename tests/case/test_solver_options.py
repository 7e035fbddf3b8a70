"""Which solver computes what names none: one rule for every way to run."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eventpound import Case, InputError, Study, load_case, simulate, simulate_many, simulate_suite
from eventpound.case.solver_options import FAST, default_solver
from eventpound.cli import main
from eventpound.solvers import knows_scene, solver_named
from eventpound.study.reading import load_study
from tests.study.test_suite import time_series

CASE = """\
body = [
  { name = "floor", mass = 1.0 },
  { name = "low", mass = 1.0 },
  { name = "high", mass = 1.0 },
]
spring = [
  { between = ["ground", "floor"], law = "linear", stiffness = 60.0 },
  { between = ["ground", "low"], law = "linear", stiffness = 200.0 },
  { between = ["low", "high"], law = "linear", stiffness = 200.0 },
]
contact = [{ between = ["floor", "low"], name = "joint", gap = "1 cm", restitution = 0.5 }]
[excitation]
kind = "record"
file = "a.txt"
units = "g"
time_step = "0.02 s"
[run]
duration = 3.0
"""
AT_POINT = CASE.replace('["floor", "low"]', '["floor", { low = 0.5, high = 0.5 }]')
WITH_LAW = CASE.replace("restitution = 0.5", 'law = "hertz", stiffness = 1e5')


def _with_spring(law: str) -> str:
    return CASE.replace("]\ncontact", f'  {{ between = ["ground", "high"], {law} }},\n]\ncontact')


SOIL = _with_spring(
    'law = "backfill", initial_stiffness = 9.0, ultimate_force = 1.0, failure_ratio = 0.7'
)
SLIDER = _with_spring('law = "slider", friction = 0.1, normal_force = 1.0')
STUDY = '[study]\nquantities = ["impacts"]\n[[study.axis]]\nkey = "contact.joint.gap"\n'
GAPS = {"contact.joint.gap": [0.01, 0.02]}


def written(folder: Path, text: str) -> Path:
    (folder / "a.txt").write_text(time_series(0.3))
    (folder / "case.toml").write_text(text)
    return folder


@pytest.mark.parametrize(
    ("text", "many"),
    [(CASE, "fast"), (SOIL, "fast"), (AT_POINT, "fast"), (WITH_LAW, "cvode"), (SLIDER, "fast")],
)
def test_many_runs_are_left_to_the_fast_solver_if_it_takes_the_scene(tmp_path, text, many):
    case = load_case(written(tmp_path, text))
    assert case.solver.name == "cvode"
    assert (many == FAST) == knows_scene(solver_named(FAST), case.scene)
    assert default_solver([case.scene], many=True) == many
    assert Study(case, GAPS).plan.solver == many
    assert load_case(tmp_path, suite=str(tmp_path / "a.txt")).solver.name == many
    assert load_study(written(tmp_path, f"{text}{STUDY}values = [0.01, 0.02]\n")).study.solver == (
        many
    )


@pytest.mark.parametrize(
    ("text", "solver"),
    [(AT_POINT, "fast"), (WITH_LAW, "cvode"), (SLIDER, "fast")],
    ids=["at a point", "with a law", "with a slider"],
)
def test_what_no_compiled_call_takes_at_once_runs_where_no_solver_is_named(tmp_path, text, solver):
    """Rows of a suite, of a study and of `simulate_many` are those of single runs."""
    case = load_case(written(tmp_path, text))
    names = ["impacts", "peaks.floor.abs_max"]
    one = [
        simulate(with_gap(case, gap), solver, error_estimate=False).summary[names].tolist()
        for gap in GAPS["contact.joint.gap"]
    ]
    assert one[0][0] > 0
    assert simulate_many(case, GAPS, quantities=names).table[names].to_numpy().tolist() == one
    assert Study(case, GAPS, quantities=names).run().table[names].to_numpy().tolist() == one
    table = simulate_suite(load_case(tmp_path, suite=str(tmp_path / "a.txt")))
    np.testing.assert_array_equal(table[names].to_numpy(), one[:1])
    assert main(["run", str(tmp_path), "--suite", str(tmp_path / "a.txt"), "--no-figures"]) == 0


def with_gap(case: Case, gap: float) -> Case:
    contacts = tuple(replace(contact, gap=gap) for contact in case.scene.contacts)
    return replace(case, scene=replace(case.scene, contacts=contacts))


@pytest.mark.parametrize(
    ("text", "solver", "said"),
    [
        (
            AT_POINT,
            "penalty",
            r"does not take ends at a point.*accepted: cvode, ida, fast, moreau$",
        ),
        *(
            (
                WITH_LAW,
                solver,
                r"does not know the laws of contacts 'joint' \(hertz\); accepted: cvode, penalty",
            )
            for solver in ("fast", "ida")
        ),
    ],
    ids=["at a point", "with a law, fast", "with a law, ida"],
)
def test_a_named_solver_that_does_not_take_the_scene_is_refused_before_anything_runs(
    tmp_path, text, solver, said, capsys
):
    case = load_case(written(tmp_path, text))
    with pytest.raises(InputError, match=f"{solver} {said}"):
        simulate(case, solver)
    with pytest.raises(InputError, match=f"{solver} {said}"):
        Study(case, GAPS, solver=solver)
    suite = load_case(tmp_path, suite=str(tmp_path / "a.txt"))
    with pytest.raises(InputError, match=f"{solver} {said}"):
        simulate_suite(suite, solver=solver)
    assert main(["run", str(tmp_path), "--solver", solver, "--no-figures"]) == 2
    assert re.search(said, capsys.readouterr().err.strip())
    assert not (tmp_path / "results").exists()


def test_a_part_of_a_study_cannot_name_a_solver_of_its_own(tmp_path):
    part = '[[study.part]]\nname = "a"\nsolver = { name = "ida" }\n'
    with pytest.raises(InputError, match=r"solver: found .*'ida'.*those of .solver. in all parts"):
        load_study(written(tmp_path, f"{CASE}{STUDY}values = [0.01]\n{part}"))
