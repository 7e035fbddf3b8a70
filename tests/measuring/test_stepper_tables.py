"""The commands behind docs/steppers.md print their tables, and the parts are what they say."""

from __future__ import annotations

import pytest

from eventpound.scene.contact_law import Element
from tests.benchmarks import orders, penalty_split
from tests.solvers.steppers.restitution import real_restitution


def test_orders_command_prints_its_tables(capsys, monkeypatch):
    monkeypatch.setattr(orders, "STEPS", (50, 100))
    monkeypatch.setattr(orders, "TOLERANCES", (1e-5, 1e-7))
    orders.main(["--solvers", "moreau", "fast"])
    printed = capsys.readouterr().out
    assert "| moreau, θ = 0.5 | " in printed
    assert "| fast | " in printed
    assert "cvode" not in printed


def test_split_command_prints_its_table(capsys, monkeypatch):
    monkeypatch.setattr(penalty_split, "FINE", 100)
    penalty_split.main(["--problems", "chain"])
    assert "| chain | hertz-damp | " in capsys.readouterr().out


@pytest.mark.parametrize("element", list(Element))
def test_parts_of_an_isolated_impact(element, monkeypatch):
    monkeypatch.setattr(penalty_split, "FINE", 1600)
    parts = penalty_split.split(penalty_split.cases()["one impact"], element)
    # What a single impact leaves to simultaneous ones is what the two limits err: a step of
    # first order at 1600 steps, and the next power of the time in contact.
    assert parts.not_isolated < 2e-3
    assert parts.total <= sum((parts.step, parts.stiffness, parts.not_isolated, parts.formula))
    # ε = 0.6; the speed after the impact, and all that follows, errs by what e misses.
    missed = abs(real_restitution(element, 0.6) - 0.6)
    assert 0.3 * missed <= parts.formula <= missed
