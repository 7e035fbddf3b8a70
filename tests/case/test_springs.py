"""Every way of giving a spring, a frequency and a damping ratio, against values by hand."""

import math
import re
import tomllib
from pathlib import Path

import pytest

from eventpound.case import Case, read_case
from eventpound.case.template import template
from eventpound.errors import InputError
from eventpound.scene import (
    Backfill,
    BilinearElastic,
    BoucWen,
    DegradingBoucWen,
    Linear,
    Series,
    Slider,
)
from eventpound.scene.modes import modes_of
from tests.models import CASES

Table = dict[str, object]
# A few roundings.
CLOSE = 1e-14
# Periods of 2 kg on 5 and on 100 N/m (s).
PERIOD_5, PERIOD_100 = 2 * math.pi * math.sqrt(2.0 / 5.0), 2 * math.pi * math.sqrt(2.0 / 100.0)


def case_with(**tables: list[Table]) -> Case:
    document: Table = {
        "excitation": {"kind": "sine", "amplitude": 1.0, "period": 1.0},
        "body": [{"name": "a", "mass": 2.0}, {"name": "b", "mass": 3.0}],
        **tables,
    }
    return read_case(document, Path("case.toml"))


def spring(**keys: object) -> Table:
    return {"between": ["ground", "a"], **keys}


def problems(**tables: list[Table]) -> str:
    with pytest.raises(InputError) as caught:
        case_with(**tables)
    return str(caught.value)


@pytest.mark.parametrize(
    "keys",
    [
        {"stiffness": 5.0, "strength": 2.85, "yield_displacement": 0.03},
        {"initial_stiffness": 100.0, "yield_force": 3.0, "hardening": 0.05},
        {"initial_stiffness": "0.1 kN/m", "yield_displacement": "3 cm", "hardening": "5 %"},
        {"initial_stiffness": 100.0, "stiffness": 5.0, "yield_force": 3.0},
        {"frequency": math.sqrt(5.0 / 2.0), "strength": 2.85, "yield_displacement": 0.03},
        {"post_yield_period": PERIOD_5, "yield_force": 3.0, "hardening": 0.05},
        {"initial_period": PERIOD_100, "yield_force": 3.0, "hardening": 0.05},
        {"initial_period": PERIOD_100, "post_yield_period": PERIOD_5, "yield_force": 3.0},
        {"initial_period": 2 * PERIOD_100, "of_mass": "8 kg", "yield_force": 3, "hardening": 0.05},
        {"frequency": math.sqrt(2.5), "stiffness": 5.0, "yield_force": 3.0, "hardening": 0.05},
    ],
    ids=", ".join,
)
def test_bouc_wen(keys):
    (s,) = case_with(spring=[spring(law="bouc-wen", **keys)]).scene.springs
    # 1 - alpha and the like lose at most a factor 1/alpha = 20 of the last digit.
    assert s.law.stiffness == pytest.approx(5.0, rel=20 * CLOSE)
    assert s.law.strength == pytest.approx(2.85, rel=20 * CLOSE)
    assert s.law.yield_displacement == pytest.approx(0.03, rel=20 * CLOSE)
    assert (s.law.exponent, s.law.beta, s.law.gamma, s.law.initial_z) == (20.0, 0.5, 0.5, 0.0)


def test_shape_of_the_loop():
    keys: Table = {"stiffness": 0, "strength": 1, "yield_displacement": 1}
    shape: Table = {"exponent": 2, "beta": 0.1, "gamma": 0.9, "initial_z": -0.5}
    (s,) = case_with(spring=[spring(law="bouc-wen", **keys, **shape)]).scene.springs
    assert s.law == BoucWen(0.0, 1.0, 1.0, 2.0, 0.1, 0.9, -0.5)


def test_frequency_zero_is_a_plastic_spring():
    keys: Table = {"frequency": 0, "strength": 1, "yield_displacement": 1}
    (s,) = case_with(spring=[spring(law="bouc-wen", **keys)]).scene.springs
    assert s.law == BoucWen(0.0, 1.0, 1.0)


def test_kinked_laws():
    bilinear: Table = {"law": "bilinear-elastic", "compression": "2 kN/m", "extension": 0}
    parts = [{"law": "linear", "stiffness": 4.0}, {**bilinear, "offset": "1 cm"}]
    tables = [spring(**bilinear), spring(law="series", parts=parts)]
    first, second = case_with(spring=tables).scene.springs
    assert first.law == BilinearElastic(2000.0, 0.0, 0.0)
    assert second.law == Series((Linear(4.0), BilinearElastic(2000.0, 0.0, 0.01)))


def test_backfill():
    soil: Table = {"law": "backfill", "initial_stiffness": "200 MN/m", "ultimate_force": "3 MN"}
    (read,) = case_with(spring=[spring(**soil, failure_ratio=0.7, gap="5 cm")]).scene.springs
    assert read.law == Backfill(2e8, 3e6, 0.7, 0.05)
    said = problems(spring=[spring(**soil, failure_ratio=1.2, gap=-1.0)])
    assert "[[spring]] 1: failure_ratio: found 1.2; accepted: a number above 0, at most 1" in said
    assert "[[spring]] 1: gap: found -1.0; accepted: a length >= 0 (m)" in said
    said = problems(spring=[spring(**{**soil, "ultimate_force": 5e-324}, failure_ratio=0.7)])
    assert "[[spring]] 1: ultimate_force: found 5e-324; accepted: a positive force (N), by" in said


def test_soil_behind_a_wall_is_that_of_caltrans_sdc():
    wall: Table = {"law": "backfill", "wall_height": "1.6764 m", "wall_width": "3 m"}
    (read,) = case_with(spring=[spring(**wall, gap="5 cm")]).scene.springs
    law = read.law
    assert law == Backfill.of_wall("1.6764 m", 3.0, "5 cm")
    # SDC 2.0, 6.3.1.2 at 5.5 ft by hand: 50.25 kip/in and 27.803 kip for each foot.
    stiffness, force = 3.0 * 50.25 * 574.5634e3, 3.0 * 27.803 * 14593.90
    assert law.ultimate_force == pytest.approx(force, rel=1e-4)
    assert law.push(0.05 * 1.6764) == pytest.approx(force, rel=1e-4)
    assert law.push(0.5 * force / stiffness) == pytest.approx(0.5 * force, rel=1e-4)
    assert law.numbers["y_ult"] == pytest.approx(0.05 * 1.6764)
    # SDC 1.7, 7.8.1 at this height: 28.7 kN/mm and 239 kPa of each metre.
    assert force / 3.0 == pytest.approx(239e3 * 1.6764, rel=0.02)
    assert stiffness / 3.0 == pytest.approx(28.7e6, rel=0.02)


def test_size_of_a_wall_that_is_not_a_size_is_told_by_its_key():
    wall: Table = {"law": "backfill", "wall_height": 5.0, "wall_width": 0.0}
    said = problems(spring=[spring(**wall)])
    heights = "accepted: from 0.6096 to 3.048 m (Caltrans SDC 2.0)"
    assert f"[[spring]] 1: wall_height: found 5.0; {heights}" in said
    assert "[[spring]] 1: wall_width: found 0.0; accepted: a positive length (m)" in said
    assert said.count("\n") == 1
    said = problems(spring=[spring(law="backfill", wall_height=2.0, failure_ratio=0.7)])
    assert "[[spring]] 1: wall_width: missing; accepted: " in said
    assert "[[spring]] 1: failure_ratio: found beside the size of a wall" in said
    assert said.count("\n") == 1


def test_slider():
    bearing: Table = {"law": "slider", "friction": 0.05, "normal_force": "2 MN"}
    tables = [spring(**bearing), spring(**bearing, radius="4 m"), spring(**bearing, stiffness=3.0)]
    laws = [read.law for read in case_with(spring=tables).scene.springs]
    assert laws == [Slider(0.05, 2e6), Slider.pendulum(0.05, 2e6, 4.0), Slider(0.05, 2e6, 3.0)]
    assert laws[1].stiffness == 5e5
    said = problems(spring=[spring(**bearing, radius="4 m", stiffness=3.0)])
    assert (
        "[[spring]] 1: radius: found beside stiffness; accepted: one of stiffness, radius" in said
    )
    said = problems(spring=[spring(**{**bearing, "friction": 0.0}, radius=0.0)])
    assert "[[spring]] 1: radius: found 0.0; accepted: a positive length (m)" in said
    said = problems(spring=[spring(**{**bearing, "friction": 0.0, "normal_force": -1.0})])
    assert "[[spring]] 1: friction: found 0.0; accepted: a positive number" in said
    assert "[[spring]] 1: normal_force: found -1.0; accepted: a positive force (N)" in said


def test_degrading_bouc_wen():
    law: Table = {"law": "degrading-bouc-wen", "stiffness": 0.0, "strength": "2 MN", "gamma": 0.6,
                  "yield_displacement": "1 cm", "strength_degradation": 0.1}  # fmt: skip
    (read,) = case_with(spring=[spring(**law, initial_loss="3")]).scene.springs
    assert read.law == DegradingBoucWen(
        0.0, 2e6, 0.01, gamma=0.6, strength_degradation=0.1, initial_loss=3.0
    )
    said = problems(spring=[spring(**law, stiffness_degradation=-1.0, beta=0.7)])
    assert "[[spring]] 1: stiffness_degradation: found -1.0; accepted: a number >= 0" in said
    assert "[[spring]] 1: beta: found 0.7; accepted: |beta| <= gamma of a law that degrades" in said


def test_names_by_default_are_those_of_the_ends():
    tables = [spring(law="linear", stiffness=1) for _ in range(3)]
    tables[1]["name"] = "ground-a-2"
    names = [s.name for s in case_with(spring=tables).scene.springs]
    assert names == ["ground-a", "ground-a-2", "ground-a-3"]


# initial stiffness 8 + 64 = 72 N/m, mass 2 kg


@pytest.mark.parametrize(
    "text",
    [(CASES / "isolated-building" / "case.toml").read_text(), template("isolated")],
    ids=["case", "template"],
)
def test_what_is_shipped_on_isolators_damps_its_storeys_only(text):
    pulse = {"kind": "cosine", "amplitude": 4.0, "period": 1.0}
    case = read_case({**tomllib.loads(text), "excitation": pulse}, Path("case.toml"))
    assert not any("isolated mode" in warning for warning in case.warnings)
    for yielded in (False, True):
        names = [body.name for body in case.scene.bodies]
        isolated, first, *others = modes_of(case.scene, names, yielded).damping
        assert isolated < 0.001
        assert first == pytest.approx(0.02, rel=1e-12 if yielded else 0.05)
        assert 0.03 < min(others) <= max(others) < 0.06


@pytest.mark.parametrize("law", ["bilinear", "elastoplastic", "Elasto-plastic", "elastic_plastic"])
def test_what_others_call_a_yielding_spring_is_answered_by_bouc_wen(law):
    found = problems(spring=[spring(law=law, stiffness=5.0)])
    assert "'bouc-wen' with exponent = 20" in found
    assert "did you mean" not in found
    parts = [{"law": law, "stiffness": 5.0}]
    assert "no part of a series yields" in problems(spring=[spring(law="series", parts=parts)])


@pytest.mark.parametrize(
    ("law", "ours"),
    [
        (
            "gap",
            r"'bilinear-elastic' with extension = 0, .* offset = minus the gap, or a \[\[conta",
        ),
        ("Stopper", "'bilinear-elastic' with extension = 0"),
        ("hook", "'bilinear-elastic' with compression = 0, extension = ... and offset = the slack"),
        ("cable", "'bilinear-elastic' with compression = 0"),
        ("coulomb", "'slider' with friction and normal_force"),
        ("friction-pendulum", "'slider' with friction, normal_force and radius"),
        ("lead-rubber", "'bouc-wen' with exponent = 20"),
        ("dashpot", r"a \[\[dashpot\]\]"),
        ("pounding", r"a \[\[contact\]\]"),
        ("hyperbolic", "'backfill'"),
    ],
)
def test_laws_by_the_names_of_the_trade_are_answered_with_ours(law, ours):
    found = problems(spring=[spring(law=law, stiffness=5.0)])
    assert re.search(f"found '{law}', .*{ours}.*; accepted: one of linear", found)


def test_a_part_of_a_series_by_the_name_of_the_trade():
    for law, answer in (("cable", "'bilinear-elastic'"), ("coulomb", "no part of a series yields")):
        parts = [{"law": law, "stiffness": 5.0}]
        assert answer in problems(spring=[spring(law="series", parts=parts)])


def test_the_answer_to_gap_is_a_stop_at_the_gap():
    """Elongated by -gap it begins to push, and never pulls: what the answer promises."""
    stop = spring(law="bilinear-elastic", extension=0, compression=7.0, offset="-2 cm")
    (read,) = case_with(spring=[stop]).scene.springs
    law = read.law
    assert (law.compression, law.extension, law.offset) == (7.0, 0.0, -0.02)
