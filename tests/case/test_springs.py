"""Every way of giving a spring, a frequency and a damping ratio, against values by hand."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path

import pytest

from eventpound.case import Case, read_case
from eventpound.case.template import template
from eventpound.errors import InputError
from eventpound.results.inputs import inputs_of
from eventpound.scene import (
    Backfill,
    BilinearElastic,
    BoucWen,
    Dashpot,
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
def test_bouc_wen(keys: Table) -> None:
    (s,) = case_with(spring=[spring(law="bouc-wen", **keys)]).scene.springs
    assert isinstance(s.law, BoucWen)
    # 1 - alpha and the like lose at most a factor 1/alpha = 20 of the last digit.
    assert s.law.stiffness == pytest.approx(5.0, rel=20 * CLOSE)
    assert s.law.strength == pytest.approx(2.85, rel=20 * CLOSE)
    assert s.law.yield_displacement == pytest.approx(0.03, rel=20 * CLOSE)
    assert (s.law.exponent, s.law.beta, s.law.gamma, s.law.initial_z) == (20.0, 0.5, 0.5, 0.0)


def test_shape_of_the_loop() -> None:
    keys: Table = {"stiffness": 0, "strength": 1, "yield_displacement": 1}
    shape: Table = {"exponent": 2, "beta": 0.1, "gamma": 0.9, "initial_z": -0.5}
    (s,) = case_with(spring=[spring(law="bouc-wen", **keys, **shape)]).scene.springs
    assert s.law == BoucWen(0.0, 1.0, 1.0, 2.0, 0.1, 0.9, -0.5)


def test_frequency_zero_is_a_plastic_spring() -> None:
    keys: Table = {"frequency": 0, "strength": 1, "yield_displacement": 1}
    (s,) = case_with(spring=[spring(law="bouc-wen", **keys)]).scene.springs
    assert s.law == BoucWen(0.0, 1.0, 1.0)


@pytest.mark.parametrize(
    "keys", [{"stiffness": 50.0}, {"frequency": 5.0}, {"period": "1256.6370614359172 ms"}]
)
def test_linear(keys: Table) -> None:
    ends = {"between": ["a", "ground"]}
    (s,) = case_with(spring=[{**spring(law="linear", **keys), **ends}]).scene.springs
    assert isinstance(s.law, Linear)
    assert s.between == ("a", "ground")
    assert s.law.stiffness == pytest.approx(50.0, rel=CLOSE)


@pytest.mark.parametrize("mass", [5.0, "5 kg", ["a", "b"]])
def test_mass_of_a_period_that_is_not_the_body_s(mass: object) -> None:
    tables = [
        {**spring(law="linear", period="2 s", of_mass=mass), "between": ends}
        for ends in (["ground", "a"], ["a", "b"])
    ]
    for s in case_with(spring=tables).scene.springs:
        assert isinstance(s.law, Linear)
        assert s.law.stiffness == pytest.approx(5.0 * math.pi**2, rel=CLOSE)


def test_period_of_a_bouc_wen_spring_is_refused_in_one_message() -> None:
    for others in ({}, {"strength": 1}, {"strength": 1, "yield_displacement": 1}):
        text = problems(spring=[spring(law="bouc-wen", period="2 s", of_mass=4, **others)])
        assert len(text.splitlines()) == 1
        assert "[[spring]] 1: period: found '2 s'" in text
        for word in ("initial_period", "post_yield_period", "of_mass"):
            assert word in text


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"stiffness": 5, "of_mass": 4}, "of_mass: found 4; accepted: it beside a frequency"),
        ({"period": 1, "of_mass": 0}, "of_mass: found 0; accepted: a positive mass"),
        ({"period": 1, "of_mass": []}, "of_mass: found []; accepted: a positive mass"),
        ({"period": 1, "of_mass": "4 m"}, "of_mass: found '4 m': 'm' is no unit of mass"),
        ({"period": 1, "of_mass": ["a", "a"]}, "a list of different bodies, of a, b"),
        ({"period": 1, "of_mass": ["c"]}, "of_mass: found ['c']; accepted: a positive mass"),
        ({"period": 1, "of_mass": [["a"]]}, "of_mass: found [['a']]"),
        ({"period": 1, "frequency": 1}, "one of frequency and period; period says 78.9"),
        ({"period": 1, "between": ["a", "b"]}, "period: found 1; accepted: stiffness, or of_mass"),
        ({"period": -1}, "period: found -1; accepted: a positive period"),
        ({"frequency": -1}, "frequency: found -1; accepted: a frequency that is not negative"),
        ({"initial_period": 1}, "initial_period: unknown key"),
    ],
)
def test_wrong_frequencies_and_masses(keys: Table, said: str) -> None:
    assert said in problems(spring=[spring(law="linear", **keys)])


def test_periods_that_contradict_a_stiffness() -> None:
    keys: Table = {"initial_stiffness": 9.0, "initial_period": 1, "strength": 1, "stiffness": 1}
    said = problems(spring=[spring(law="bouc-wen", **keys)])
    assert "initial_stiffness: found 9.0; accepted: one of initial_stiffness and initial_p" in said


def test_kinked_laws() -> None:
    bilinear: Table = {"law": "bilinear-elastic", "compression": "2 kN/m", "extension": 0}
    parts = [{"law": "linear", "stiffness": 4.0}, {**bilinear, "offset": "1 cm"}]
    tables = [spring(**bilinear), spring(law="series", parts=parts)]
    first, second = case_with(spring=tables).scene.springs
    assert first.law == BilinearElastic(2000.0, 0.0, 0.0)
    assert second.law == Series((Linear(4.0), BilinearElastic(2000.0, 0.0, 0.01)))


def test_backfill() -> None:
    soil: Table = {"law": "backfill", "initial_stiffness": "200 MN/m", "ultimate_force": "3 MN"}
    (read,) = case_with(spring=[spring(**soil, failure_ratio=0.7, gap="5 cm")]).scene.springs
    assert read.law == Backfill(2e8, 3e6, 0.7, 0.05)
    said = problems(spring=[spring(**soil, failure_ratio=1.2, gap=-1.0)])
    assert "[[spring]] 1: failure_ratio: found 1.2; accepted: a number above 0, at most 1" in said
    assert "[[spring]] 1: gap: found -1.0; accepted: a length >= 0 (m)" in said


def test_soil_behind_a_wall_is_that_of_caltrans_sdc() -> None:
    wall: Table = {"law": "backfill", "wall_height": "1.6764 m", "wall_width": "3 m"}
    (read,) = case_with(spring=[spring(**wall, gap="5 cm")]).scene.springs
    law = read.law
    assert isinstance(law, Backfill)
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


def test_size_of_a_wall_that_is_not_a_size_is_told_by_its_key() -> None:
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


def test_slider() -> None:
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


def test_degrading_bouc_wen() -> None:
    law: Table = {"law": "degrading-bouc-wen", "stiffness": 0.0, "strength": "2 MN", "gamma": 0.6,
                  "yield_displacement": "1 cm", "strength_degradation": 0.1}  # fmt: skip
    (read,) = case_with(spring=[spring(**law, initial_loss="3")]).scene.springs
    assert read.law == DegradingBoucWen(
        0.0, 2e6, 0.01, gamma=0.6, strength_degradation=0.1, initial_loss=3.0
    )
    said = problems(spring=[spring(**law, stiffness_degradation=-1.0, beta=0.7)])
    assert "[[spring]] 1: stiffness_degradation: found -1.0; accepted: a number >= 0" in said
    assert "[[spring]] 1: beta: found 0.7; accepted: |beta| <= gamma of a law that degrades" in said


def test_names_by_default_are_those_of_the_ends() -> None:
    tables = [spring(law="linear", stiffness=1) for _ in range(3)]
    tables[1]["name"] = "ground-a-2"
    names = [s.name for s in case_with(spring=tables).scene.springs]
    assert names == ["ground-a", "ground-a-2", "ground-a-3"]


HYSTERETIC = spring(law="bouc-wen", stiffness=8.0, strength=1.0, yield_displacement=1 / 64)
# initial stiffness 8 + 64 = 72 N/m, mass 2 kg


@pytest.mark.parametrize(
    ("refers_to", "expected"),
    [
        ("initial-stiffness", 2 * 0.05 * math.sqrt(72.0 * 2.0)),
        ("post-yield-stiffness", 2 * 0.05 * math.sqrt(8.0 * 2.0)),
        ("6 rad/s", 2 * 0.05 * 2.0 * 6.0),
        (6.0, 2 * 0.05 * 2.0 * 6.0),
        ("0.5 s", 2 * 0.05 * 2.0 * 4.0 * math.pi),
    ],
)
def test_damping_ratio(refers_to: object, expected: float) -> None:
    dashpot: Table = {"between": ["a", "ground"], "ratio": "5 %", "refers_to": refers_to}
    (found,) = case_with(spring=[HYSTERETIC], dashpot=[dashpot]).scene.dashpots
    assert found.coefficient == pytest.approx(expected, rel=CLOSE)


def test_ratio_of_springs_in_parallel() -> None:
    linear = [spring(law="linear", stiffness=k) for k in (10.0, 8.0)]
    dashpot: Table = {"between": ["ground", "a"], "ratio": 0.5}
    (found,) = case_with(spring=linear, dashpot=[dashpot]).scene.dashpots
    assert found == Dashpot(("ground", "a"), 6.0)


def test_ratio_beside_a_kinked_spring_is_of_its_stiffness_at_rest() -> None:
    kinked = spring(law="bilinear-elastic", compression=0.0, extension=8.0, name="cable")
    dashpot: Table = {"between": ["ground", "a"], "ratio": 0.5}
    # 2 xi sqrt(k m), m = 2.
    (found,) = case_with(spring=[{**kinked, "offset": -0.1}], dashpot=[dashpot]).scene.dashpots
    assert found.coefficient == pytest.approx(4.0, rel=CLOSE)
    said = problems(spring=[{**kinked, "offset": 0.1}], dashpot=[dashpot])
    assert "coefficient; spring 'cable' does not resist at rest, refer to a frequency" in said


def test_hertz_is_refused_for_what_a_ratio_refers_to() -> None:
    dashpot: Table = {"between": ["ground", "a"], "ratio": 0.5, "refers_to": "1 Hz"}
    assert "refers_to: found '1 Hz'" in problems(spring=[HYSTERETIC], dashpot=[dashpot])


@pytest.mark.parametrize(
    "keys",
    [
        {"ratio": 0.05, "frequencies": [2.0, 8.0]},
        {"ratio": 0.05, "periods": [math.pi, math.pi / 4]},
        {"mass_coefficient": 0.16, "stiffness_coefficient": "10 ms"},
    ],
    ids=", ".join,
)
def test_rayleigh(keys: Table) -> None:
    # a = 2 x 0.05 x 2 x 8 / 10 = 0.16 1/s, b = 2 x 0.05 / 10 = 0.01 s
    between = {"between": ["a", "b"], "law": "linear", "stiffness": 30.0}
    scene = case_with(spring=[HYSTERETIC, between], rayleigh=[{"bodies": ["a", "b"], **keys}]).scene
    found = {dashpot.between: dashpot.coefficient for dashpot in scene.dashpots[1:2]}
    assert found == pytest.approx({("ground", "b"): 0.16 * 3.0}, rel=CLOSE)
    coefficients = [dashpot.coefficient for dashpot in scene.dashpots]
    assert coefficients == pytest.approx([0.32, 0.48, 0.72, 0.3], rel=CLOSE)


def test_rayleigh_damps_a_kinked_spring_as_it_is_at_rest() -> None:
    """At its kink by the smaller of two stiffnesses, which is said; slack not at all."""
    group: Table = {"bodies": ["a"], "mass_coefficient": 0.1, "stiffness_coefficient": 0.1}
    kinked = spring(law="bilinear-elastic", compression=3.0, extension=2.0, name="stop")
    for offset, damping in ((0.0, 0.2), (0.1, 0.3), (-0.1, 0.2)):
        case = case_with(spring=[{**kinked, "offset": offset}], rayleigh=[group])
        assert [d.coefficient for d in case.scene.dashpots] == pytest.approx([0.2, damping])
        assert inputs_of(case)["at_rest"]["at_kink"] == ["stop"] * (offset == 0.0)
    slack = spring(law="bilinear-elastic", compression=0.0, extension=2.0, name="s", offset=0.1)
    assert len(case_with(spring=[slack], rayleigh=[group]).scene.dashpots) == 1


def test_a_body_in_two_rayleigh_groups() -> None:
    group: Table = {"bodies": ["a"], "mass_coefficient": 0.1}
    assert "found 'a' again" in problems(rayleigh=[group, group])


# a on isolators, b on a storey of 30 N/m above it.
ISOLATED = [
    spring(name="isolators", law="bouc-wen", stiffness=1.0, strength=0.1, yield_displacement=0.1),
    {"between": ["a", "b"], "name": "storey", "law": "linear", "stiffness": 30.0},
    {"between": ["a", "b"], "name": "stop", "law": "bilinear-elastic", "compression": 1.0,
     "extension": 0.0},
]  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"stiffness_coefficient": "10 ms"}, 0.3),
        ({"ratio": "5 %", "frequency": 4.0}, 2 * 0.05 / 4.0 * 30.0),
        ({"ratio": "5 %", "period": "0.5 s"}, 0.05 * 0.5 / math.pi * 30.0),
    ],
)
def test_rayleigh_damping_of_springs(keys: Table, expected: float) -> None:
    group: Table = {"springs": ["storey"], **keys}
    (found,) = case_with(spring=ISOLATED[:2], rayleigh=[group]).scene.dashpots
    assert found.between == ("a", "b")
    assert found.coefficient == pytest.approx(expected, rel=CLOSE)


def test_a_ratio_of_springs_holds_at_a_mode_with_the_others_yielded() -> None:
    group: Table = {"springs": ["storey"], "ratio": "5 %", "mode": 2}
    scene = case_with(spring=ISOLATED[:2], rayleigh=[group]).scene
    assert modes_of(scene, ["a", "b"], yielded=True).damping[1] == pytest.approx(0.05, rel=1e-12)
    assert "strain energy: 2" in problems(spring=ISOLATED[:2], rayleigh=[{**group, "mode": 1}])


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"springs": ["story"]}, "springs: found 'story'; accepted: some of isolators, storey"),
        ({"springs": ["stop"]}, "springs: found 'stop'; accepted: springs that resist at rest"),
        ({"springs": ["storey", "storey"]}, "springs: found ['storey', 'storey']; accepted: every"),
        ({"springs": "storey"}, "springs: found 'storey'; accepted: a list of names"),
        ({"bodies": ["b"]}, "bodies: found ['b']; accepted: one of bodies and springs"),
        ({"mass_coefficient": 0.1}, "mass_coefficient: unknown key"),
        ({"support": "pier"}, "support: unknown key"),
        ({"stiffness_coefficient": 0.1}, "ratio: found 0.05; accepted: ratio with one of mode"),
        ({"period": "1 s"}, "mode: found mode and period of mode, period, frequency"),
        ({"mode": 3}, "mode: found 3; accepted: a mode in which"),
        ({"ratio": -0.05}, "ratio: found -0.05; accepted: a ratio that is not negative"),
    ],
)
def test_rayleigh_damping_of_springs_that_is_refused(keys: Table, said: str) -> None:
    group: Table = {"springs": ["storey"], "ratio": 0.05, "mode": 2, **keys}
    (line,) = [x for x in problems(spring=ISOLATED, rayleigh=[group]).splitlines() if said in x]
    assert line.startswith("case.toml: [[rayleigh]] 1: ")


def test_a_spring_in_two_rayleigh_groups() -> None:
    named: Table = {"springs": ["storey"], "stiffness_coefficient": 0.1}
    both: Table = {"bodies": ["a", "b"], "mass_coefficient": 0.1}
    case_with(spring=ISOLATED[:2], rayleigh=[named, both])
    both["stiffness_coefficient"] = 0.1
    for groups in ([named, both], [both, named], [named, named]):
        said = problems(spring=ISOLATED[:2], rayleigh=groups)
        assert "damps spring 'storey' again" in said


@pytest.mark.parametrize(
    "text",
    [(CASES / "isolated-building" / "case.toml").read_text(), template("isolated")],
    ids=["case", "template"],
)
def test_what_is_shipped_on_isolators_damps_its_storeys_only(text: str) -> None:
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
def test_what_others_call_a_yielding_spring_is_answered_by_bouc_wen(law: str) -> None:
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
def test_laws_by_the_names_of_the_trade_are_answered_with_ours(law: str, ours: str) -> None:
    found = problems(spring=[spring(law=law, stiffness=5.0)])
    assert re.search(f"found '{law}', .*{ours}.*; accepted: one of linear", found)


def test_a_part_of_a_series_by_the_name_of_the_trade() -> None:
    for law, answer in (("cable", "'bilinear-elastic'"), ("coulomb", "no part of a series yields")):
        parts = [{"law": law, "stiffness": 5.0}]
        assert answer in problems(spring=[spring(law="series", parts=parts)])


def test_the_answer_to_gap_is_a_stop_at_the_gap() -> None:
    """Elongated by -gap it begins to push, and never pulls: what the answer promises."""
    stop = spring(law="bilinear-elastic", extension=0, compression=7.0, offset="-2 cm")
    (read,) = case_with(spring=[stop]).scene.springs
    law = read.law
    assert isinstance(law, BilinearElastic)
    assert (law.compression, law.extension, law.offset) == (7.0, 0.0, -0.02)
