"""The command behind docs/speed-against-error.md, on one small problem."""

from __future__ import annotations

import math

import pytest
from matplotlib import image

from tests.benchmarks import work_precision


def test_it_writes_the_page(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(work_precision, "RTOL", (1e-3, 1e-6))
    words = ["--problems", "P4", "--solvers", "fast,nobody", "--repeats", "1"]
    work_precision.main([*words, "--out", str(tmp_path)])
    page = (tmp_path / work_precision.PAGE).read_text(encoding="utf-8")
    assert page.startswith("# Speed against error, measured")
    tables = page.partition(work_precision.BEGIN)[2].partition(work_precision.END)[0]
    assert tables.count("| P4 | fast |") == 2
    assert "nobody" not in tables
    (reference,) = [line for line in tables.splitlines() if "P4" in line and line.count("|") == 4]
    # The stored answer holds to 1e-11 of scale.
    assert float(reference.split("|")[3]) < 1e-10
    assert image.imread(tmp_path / work_precision.PICTURE).std() > 0.0
    assert "cvode at rtol 1e-13, checked by fast" in capsys.readouterr().out


def test_steps_are_parts_of_the_motion():
    problems = work_precision.problems()
    pulse = work_precision.steps_of(work_precision.case_of("P1", problems["P1"]))
    assert pulse[0] == pytest.approx(2.0 * math.pi / 20.0)
    assert 8.0 * math.pi / pulse[-1] <= work_precision.MOST_STEPS
    record = work_precision.steps_of(work_precision.case_of("P7", problems["P7"]))
    assert record[:3] == [0.02, 0.01, 0.005]
    assert len(record) == 7
