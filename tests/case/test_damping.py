"""Dashpots by a ratio, and Rayleigh damping of bodies and springs."""

import math

import pytest

from eventpound.results.inputs import inputs_of
from eventpound.scene.modes import modes_of
from tests.case.test_springs import CLOSE, Table, case_with, problems, spring

HYSTERETIC = spring(law="bouc-wen", stiffness=8.0, strength=1.0, yield_displacement=1 / 64)


@pytest.mark.parametrize(
    "keys",
    [
        {"ratio": 0.05, "frequencies": [2.0, 8.0]},
        {"ratio": 0.05, "periods": [math.pi, math.pi / 4]},
        {"mass_coefficient": 0.16, "stiffness_coefficient": "10 ms"},
    ],
    ids=", ".join,
)
def test_rayleigh(keys):
    # a = 2 x 0.05 x 2 x 8 / 10 = 0.16 1/s, b = 2 x 0.05 / 10 = 0.01 s
    between = {"between": ["a", "b"], "law": "linear", "stiffness": 30.0}
    scene = case_with(spring=[HYSTERETIC, between], rayleigh=[{"bodies": ["a", "b"], **keys}]).scene
    found = {dashpot.between: dashpot.coefficient for dashpot in scene.dashpots[1:2]}
    assert found == pytest.approx({("ground", "b"): 0.16 * 3.0}, rel=CLOSE)
    coefficients = [dashpot.coefficient for dashpot in scene.dashpots]
    assert coefficients == pytest.approx([0.32, 0.48, 0.72, 0.3], rel=CLOSE)


def test_rayleigh_damps_a_kinked_spring_as_it_is_at_rest():
    """At its kink by the smaller of two stiffnesses, which is said; slack not at all."""
    group: Table = {"bodies": ["a"], "mass_coefficient": 0.1, "stiffness_coefficient": 0.1}
    kinked = spring(law="bilinear-elastic", compression=3.0, extension=2.0, name="stop")
    for offset, damping in ((0.0, 0.2), (0.1, 0.3), (-0.1, 0.2)):
        case = case_with(spring=[{**kinked, "offset": offset}], rayleigh=[group])
        assert [d.coefficient for d in case.scene.dashpots] == pytest.approx([0.2, damping])
        assert inputs_of(case)["at_rest"]["at_kink"] == ["stop"] * (offset == 0.0)
    slack = spring(law="bilinear-elastic", compression=0.0, extension=2.0, name="s", offset=0.1)
    assert len(case_with(spring=[slack], rayleigh=[group]).scene.dashpots) == 1


def test_a_body_in_two_rayleigh_groups():
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
def test_rayleigh_damping_of_springs(keys, expected):
    group: Table = {"springs": ["storey"], **keys}
    (found,) = case_with(spring=ISOLATED[:2], rayleigh=[group]).scene.dashpots
    assert found.between == ("a", "b")
    assert found.coefficient == pytest.approx(expected, rel=CLOSE)


def test_a_ratio_of_springs_holds_at_a_mode_with_the_others_yielded():
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
def test_rayleigh_damping_of_springs_that_is_refused(keys, said):
    group: Table = {"springs": ["storey"], "ratio": 0.05, "mode": 2, **keys}
    (line,) = [x for x in problems(spring=ISOLATED, rayleigh=[group]).splitlines() if said in x]
    assert line.startswith("case.toml: [[rayleigh]] 1: ")


def test_a_spring_in_two_rayleigh_groups():
    named: Table = {"springs": ["storey"], "stiffness_coefficient": 0.1}
    both: Table = {"bodies": ["a", "b"], "mass_coefficient": 0.1}
    case_with(spring=ISOLATED[:2], rayleigh=[named, both])
    both["stiffness_coefficient"] = 0.1
    for groups in ([named, both], [both, named], [named, named]):
        said = problems(spring=ISOLATED[:2], rayleigh=groups)
        assert "damps spring 'storey' again" in said
