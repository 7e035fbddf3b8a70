"""The command behind docs/measured/speed-against-error.md, on one small problem."""

from __future__ import annotations

import math

import pytest
from matplotlib import image

from tests.benchmarks import speed_page, work_precision, yardsticks


def test_it_writes_the_page(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(work_precision, "RTOL", (1e-3, 1e-6))
    words = ["P4", "--solvers", "fast,nobody", "--repeats", "1"]
    work_precision.main([*words, "--out", str(tmp_path)])
    page = (tmp_path / speed_page.PAGE).read_text(encoding="utf-8")
    assert page.startswith("# Speed against error: tables")
    tables = _tables(page, "problems")
    assert tables.count("| P4 | fast |") == 2
    assert "| P4 | cvode |" not in tables
    # Of what was not measured the old rows stay.
    old = (speed_page.DOCS / speed_page.PAGE).read_text(encoding="utf-8")
    assert "| P3 | cvode |" in tables
    assert _tables(page, "hard") == _tables(old, "hard")
    (reference,) = [line for line in tables.splitlines() if "P4" in line and line.count("|") == 4]
    # The stored answer holds to 1e-11 of scale.
    assert float(reference.split("|")[3]) < 1e-10
    assert image.imread(tmp_path / speed_page.PICTURES["problems"]).std() > 0.0
    assert "cvode at rtol 1e-13, checked by fast" in capsys.readouterr().out


def test_hard_scenes_stand_on_the_page_with_their_certificates(monkeypatch, tmp_path):
    monkeypatch.setattr(work_precision, "RTOL", (1e-6,))
    words = ["graze-hit-1e-06", "--solvers", "fast", "--repeats", "1"]
    work_precision.main([*words, "--out", str(tmp_path)])
    tables = _tables((tmp_path / speed_page.PAGE).read_text(encoding="utf-8"), "hard")
    (row,) = [line for line in tables.splitlines() if "graze" in line and "± " in line]
    cells = [cell.strip() for cell in row.split("|")[2:-1]]
    # Two peaks, two final values; four numbers of the impact.
    assert cells[:3] == ["yes", "4 of 4", "4 of 4"]
    assert cells[5].startswith("min of b -1.000000")
    assert cells[6].startswith("3 numbers, off by ")
    assert float(cells[6].rpartition(" ")[2]) < 7.1e-9


def _tables(page: str, group: str) -> str:
    begin, end = speed_page.marks(group)
    return page.partition(begin)[2].partition(end)[0]


def test_an_unknown_problem_is_named(capsys):
    with pytest.raises(SystemExit):
        work_precision.main(["P44"])
    assert "P44: no problem; accepted: problems, hard, P1" in capsys.readouterr().err


def test_steps_are_parts_of_the_motion():
    problems = yardsticks.load()
    pulse = work_precision.steps_of(work_precision.case_of("P1", problems["P1"]))
    assert pulse[0] == pytest.approx(2.0 * math.pi / 20.0)
    assert 8.0 * math.pi / pulse[-1] <= work_precision.MOST_STEPS
    record = work_precision.steps_of(work_precision.case_of("P7", problems["P7"]))
    assert record[:3] == [0.02, 0.01, 0.005]
    assert len(record) == 7
