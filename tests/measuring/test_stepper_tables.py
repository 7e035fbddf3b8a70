"""The commands behind docs/steppers.md print their tables, and the parts are what they say."""

from tests.benchmarks import orders, penalty_split


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
