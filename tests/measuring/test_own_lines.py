"""The lines that stand beside a stepper's own: its own model, and a run among many."""

from eventpound.accuracy.compare import entries, judge_entries
from tests.benchmarks import own_lines, work_precision, yardsticks
from tests.benchmarks.work_precision import case_of


def test_the_lines_stand_beside_the_others(monkeypatch):
    monkeypatch.setattr(own_lines, "RUNS", 20)
    case = case_of("P4", yardsticks.load()["P4"])
    asked = entries([("fast", {}), ("penalty", {})], [1e-6], [0.02])
    found = own_lines.with_own_lines(judge_entries(case, asked, repeats=1), [0.02])
    runs = {run.label: run for run in found.runs}
    assert list(runs) == [
        "fast", "penalty", own_lines.AMONG_MANY, own_lines.OWN_MODEL,
    ]  # fmt: skip
    assert runs[own_lines.AMONG_MANY].errors == runs["fast"].errors
    law, own = runs["penalty"].errors, runs[own_lines.OWN_MODEL].errors
    assert own.distance.graph < 0.1 * law.distance.graph
    figure = work_precision.panels([found, found])
    assert [axes.get_title() for axes in figure.axes] == ["P4", "P4"]
    assert all(axes.get_lines() for axes in figure.axes)
