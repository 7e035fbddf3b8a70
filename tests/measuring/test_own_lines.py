"""The lines that stand beside a stepper's own: its own model, and a run among many."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eventpound import simulate
from eventpound.accuracy.compare import entries, judge_entries
from eventpound.scene.contact_law import Element
from tests.benchmarks import own_lines, work_precision, yardsticks
from tests.benchmarks.work_precision import case_of
from tests.solvers.scenes import with_springs


def test_the_own_model_is_what_the_element_tends_to() -> None:
    """Newmark with the element against an event-driven run of the spring in its place."""
    case = case_of("P4", yardsticks.load()["P4"])
    model = own_lines.own_model(case)
    assert model.scene.contacts == ()
    stops = [spring.law.compression for spring in model.scene.springs[-len(case.scene.contacts) :]]
    sprung = replace(case, scene=with_springs(case.scene, Element.LINEAR, stops[0]))
    exact = simulate(model, "fast", 1e-11).peaks[["max", "min"]].to_numpy()
    apart = []
    for step in (4e-3, 2e-3, 1e-3):
        settings = {"time_step": step}
        stepped = simulate(sprung, "penalty", settings=settings).peaks[["max", "min"]].to_numpy()
        apart.append(np.abs(stepped - exact).max() / np.abs(exact).max())
    # Of second order, but for where in a step the barrier is met.
    assert apart[2] < 0.2 * apart[0]
    assert apart[2] < 1e-4
    rigid = simulate(case, "fast", 1e-11).peaks[["max", "min"]].to_numpy()
    assert np.abs(rigid - exact).max() > 1e-2 * np.abs(exact).max()


def test_the_lines_stand_beside_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
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
    assert law is not None
    assert own is not None
    assert own.distance.graph < 0.1 * law.distance.graph
    figure = work_precision.panels([found, found])
    assert [axes.get_title() for axes in figure.axes] == ["P4", "P4"]
    assert all(axes.get_lines() for axes in figure.axes)
