"""Laws of springs drawn beside a model."""

from eventpound.report.law_panel import laws_shown
from eventpound.scene import GROUND, BoucWen, Linear, Spring


def test_laws_of_many_springs_are_one_of_each_kind():
    springs = [Spring(f"s{i}", (GROUND, f"b{i}"), BoucWen(1.0, 1.0 + i, 1.0)) for i in range(5)]
    springs += [Spring("l", (GROUND, "b0"), Linear(1.0)), Spring("m", (GROUND, "b1"), Linear(1.0))]
    assert [name for name, _ in laws_shown(springs)] == ["s0, one of 5 such laws", "l, m"]
    assert laws_shown(springs[-2:]) == []
