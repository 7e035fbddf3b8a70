"""Sensitivities beside a closed form, saltation matrices and cvode; where there are none."""

import math
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eventpound import (
    AccuracyWarning,
    Body,
    Contact,
    Dashpot,
    Harmonic,
    InputError,
    Linear,
    Scene,
    Spring,
    load_case,
    sensitivities,
    simulate,
)
from eventpound.basics.input_files import read_columns
from eventpound.cli import main
from eventpound.report.study_curves import tornado_figure
from eventpound.scene.parameters import number_places, with_values
from tests.models import CASES
from tests.study.saltation import Array, LinearSystem, final_sensitivity

BRIDGE = CASES / "bridge-el-centro"


def column(table: pd.DataFrame, quantity: str, name: str, keys: list[str]) -> Array:
    """One column of the rows of a quantity, by keys."""
    return table[table["quantity"] == quantity].set_index("to").loc[keys, name].to_numpy()


def test_of_an_elastic_impact_they_are_those_of_the_closed_form():
    m, k, d, e, v = 2.0, 50.0, 0.1, 0.8, 1.0
    scene = Scene(
        (Body("a", m, velocity=v),),
        (Spring("s", ("ground", "a"), Linear(k)),),
        contacts=(Contact("c", "a", "barrier", gap=d, restitution=e),),
    )
    keys = ["body.a.mass", "spring.s.stiffness", "contact.c.gap", "contact.c.restitution"]
    keys += ["body.a.velocity"]
    table = sensitivities(scene, of=["peaks.a.min"], to=keys, duration=1.2)
    # The energy that is left swings to -A, A^2 = d^2 + e^2 (v^2 m / k - d^2).
    a = math.sqrt(d**2 + e**2 * (v**2 * m / k - d**2))
    expected = [
        -(e**2) * v**2 / k / (2.0 * a),
        e**2 * v**2 * m / k**2 / (2.0 * a),
        -d * (1.0 - e**2) / a,
        -e * (v**2 * m / k - d**2) / a,
        -(e**2) * v * m / k / a,
    ]
    assert_allclose(column(table, "peaks.a.min", "value", keys), -a, rtol=1e-12)
    found = column(table, "peaks.a.min", "derivative", keys)
    assert_allclose(found, expected, rtol=1e-8)
    # h^2/6 of the third derivative, some hundred times the derivative beside the number's own
    # scale, and the rounding of a peak over a step.
    error = column(table, "peaks.a.min", "error", keys)
    assert np.all(np.abs(found - expected) <= error + 1e-10)
    elasticity = np.array(expected) * [m, k, d, e, v] / -a
    assert_allclose(column(table, "peaks.a.min", "elasticity", keys), elasticity, rtol=1e-8)
    assert table["elasticity"].abs().is_monotonic_decreasing


def sine(t: float, p: Array) -> Array:
    """Ground acceleration, whose amplitude and period are the last two parameters."""
    return p[-2] * np.sin(2.0 * np.pi * t / p[-1])


def test_of_one_body_they_are_those_of_saltation_matrices():
    p = np.array([1.3, 60.0, 1.1, 0.02, 0.7, 2.0, 0.9])
    keys = ["body.a.mass", "spring.s.stiffness", "dashpot.ground-a.coefficient"]
    keys += ["contact.c.gap", "contact.c.restitution"]
    m, k, c, gap, e, amplitude, period = p.tolist()
    scene = Scene(
        (Body("a", m),),
        (Spring("s", ("ground", "a"), Linear(k)),),
        (Dashpot(("ground", "a"), c),),
        (Contact("c", "a", "barrier", gap=gap, restitution=e),),
        Harmonic(amplitude, period),
    )
    system = LinearSystem(
        lambda p: (p[:1], p[1:2, None], p[2:3, None], p[3], p[4]), sine, np.array([1.0])
    )
    beside(scene, system, p, [*keys, "excitation.amplitude", "excitation.period"])


def test_of_two_bodies_they_are_those_of_saltation_matrices():
    p = np.array([1.0, 3.0, 40.0, 90.0, 0.5, 0.01, 0.6, 2.0, 0.8])
    keys = ["body.a.mass", "body.b.mass", "spring.a.stiffness", "spring.b.stiffness"]
    keys += ["dashpot.a-b.coefficient", "contact.c.gap", "contact.c.restitution"]
    m, n, k, k_b, c, gap, e, amplitude, period = p.tolist()
    scene = Scene(
        (Body("a", m), Body("b", n)),
        (Spring("a", ("ground", "a"), Linear(k)), Spring("b", ("ground", "b"), Linear(k_b))),
        (Dashpot(("a", "b"), c),),
        (Contact("c", "a", "b", gap=gap, restitution=e),),
        Harmonic(amplitude, period),
    )
    between = np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = LinearSystem(
        lambda p: (p[:2], np.diag(p[2:4]), p[4] * between, p[5], p[6]), sine, np.array([1.0, -1.0])
    )
    beside(scene, system, p, [*keys, "excitation.amplitude", "excitation.period"])


def beside(scene: Scene, system: LinearSystem, p: Array, keys: list[str]) -> None:
    """Derivatives of the final state beside the saltation matrices, through several impacts."""
    names, end = [body.name for body in scene.bodies], 3.0
    x, s, impacts = final_sensitivity(system, np.zeros(2 * len(names)), p, end)
    assert impacts >= 3
    of = [f"final.{name}.{word}" for word in "uv" for name in names]
    table = sensitivities(scene, of=of, to=keys, duration=end)
    for name, value, derivatives in zip(of, x, s, strict=True):
        assert_allclose(column(table, name, "value", keys), value, rtol=1e-8)
        found = column(table, name, "derivative", keys)
        size = np.abs(derivatives * p).max()
        # A step of 1e-5 misses by its square times the third derivative, which each impact
        # makes larger; what the two differences are apart by is no less.
        assert_allclose(found * p, derivatives * p, rtol=0.0, atol=2e-7 * size)
        error = column(table, name, "error", keys)
        assert np.all(np.abs(found - derivatives) * p <= error * p + 1e-8 * size)


@pytest.mark.parametrize("key", ["contact.joint.gap", "body.segment2.mass"])
def test_through_the_impacts_of_a_bridge_they_are_those_of_another_solver(key):
    case, of = load_case(BRIDGE), "peaks.segment2.abs_max"
    row = sensitivities(case, of=[of], to=[key]).iloc[0]
    place, step = number_places(case.scene)[key], 1e-5 * row["at"]

    def peak(value: float) -> float:
        varied = replace(case, scene=with_values(case.scene, {place: value}))
        found = simulate(varied, "cvode", rtol=1e-12, error_estimate=False).quantity(of)
        assert found is not None
        return found

    other = (peak(row["at"] + step) - peak(row["at"] - step)) / (2.0 * step)
    assert row["note"] == ""
    assert row["derivative"] == pytest.approx(other, rel=2e-5)


def grazing(gap: float) -> Scene:
    """A body that swings to 0.1 m, beside a barrier."""
    return Scene(
        (Body("a", 1.0, velocity=1.0),),
        (Spring("s", ("ground", "a"), Linear(100.0)),),
        contacts=(Contact("c", "a", "barrier", gap=gap, restitution=0.5),),
    )


def test_where_an_impact_appears_within_the_step_there_is_none():
    keys = ["contact.c.gap", "contact.c.restitution"]
    with pytest.warns(
        AccuracyWarning, match="no derivative, 1 of 4.*: of final.a.u to contact.c.g"
    ):
        table = sensitivities(
            grazing(0.1 * (1.0 + 5e-6)), of=["final.a.u", "peaks.a.min"], to=keys, duration=0.3
        )
    assert column(table, "final.a.u", "note", keys).tolist() == [
        "0 to 1 impacts of c within the steps",
        "",
    ]


def test_an_impact_that_appears_after_a_peak_leaves_its_derivative():
    late = replace(grazing(0.1 * (1.0 + 5e-6)), bodies=(Body("a", 1.0, velocity=-1.0),))
    table = sensitivities(late, of=["peaks.a.min"], to=["body.a.velocity"], duration=0.6)
    assert table["note"].tolist() == [""]
    assert table["derivative"][0] == pytest.approx(0.1, rel=1e-9)


def test_what_cannot_be_varied_by_a_part_of_itself_is_left_out_or_given_a_step():
    scene = grazing(0.05)
    elastic = replace(scene, contacts=(replace(scene.contacts[0], restitution=1.0),))
    keys = set(sensitivities(elastic, duration=1.0)["to"])
    assert keys == {"body.a.mass", "body.a.velocity", "spring.s.stiffness", "contact.c.gap"}
    step = {"body.a.displacement": "0.1 mm"}
    away = sensitivities(scene, to=step, of=["peaks.a.max"], duration=1.0)
    assert away["derivative"].tolist() == pytest.approx([0.0], abs=1e-9)


def test_a_number_that_is_named_twice_has_one_row():
    table = sensitivities(grazing(0.05), to=["body.a.mass"] * 2, of=["peaks.a.min"], duration=1.0)
    assert len(table) == 1
    assert np.isfinite(table["derivative"]).all()


def test_without_contact_the_peak_of_a_swing_follows_its_speed_and_mass():
    # v sqrt(m/k) = 0.1 m, with and without a gap of half of it.
    free, keys = "free.peaks.a.max", ["body.a.velocity", "body.a.mass", "contact.c.gap"]
    table = sensitivities(grazing(0.05), to=keys, of=[free], duration=1.0)
    assert_allclose(table["value"], 0.1, rtol=1e-9)
    assert_allclose(column(table, free, "derivative", keys), [0.1, 0.05, 0.0], atol=1e-8)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"to": ["contact.d.gap"]}, "to: contact.d.gap: unknown key; accepted: body.a.mass"),
        ({"to": ["body.a.displacement"]}, "to: body.a.displacement: found 0, which has no part"),
        ({"to": {"contact.c.restitution": 0.4}}, "to: contact.c.restitution: value -0.3"),
        ({"to": {"contact.c.gap": "-1 mm"}}, "to: contact.c.gap: step: found"),
        ({"of": ["impacts"]}, "of: 'impacts' is a count, and has no derivative"),
        ({"of": ["peaks.b.max"]}, "of: found 'peaks.b.max'"),
        ({"of": []}, "of: found []; accepted: at least one quantity"),
    ],
)
def test_what_is_refused(options, said):
    with pytest.raises(InputError, match=re.escape(said)):
        sensitivities(grazing(0.05), duration=1.0, **options)


def test_the_command_writes_the_table_and_a_tornado(tmp_path, capsys):
    words = ["study", "sensitivities", str(BRIDGE), "--to", "contact.joint.gap"]
    assert main([*words, "--of", "peaks.segment1.abs_max", "--out", str(tmp_path)]) == 0
    assert "contact.joint.gap         +0.1099" in capsys.readouterr().out
    written = read_columns(tmp_path / "sensitivities.csv")
    assert float(written["elasticity"][0]) == pytest.approx(0.10994, rel=1e-3)
    assert (tmp_path / "sensitivities.png").stat().st_size > 0
    assert main([*words, "--of", "impacts", "--out", str(tmp_path / "none")]) == 2
    assert not (tmp_path / "none").exists()
    capsys.readouterr()
    # Before anything is run: the quantity is not looked at.
    beyond = tmp_path / "sensitivities.csv" / "none"
    assert main([*words, "--of", "impacts", "--out", str(beyond)]) == 2
    assert "cannot be written to" in capsys.readouterr().err


def test_a_tornado_has_a_bar_for_each_number_and_a_cross_where_there_is_no_derivative():
    rows = [("a", 2.0, ""), ("b", -0.5, ""), ("c", 9.0, "0 to 1 impacts of c within the steps")]
    table = pd.DataFrame(
        [
            {"quantity": "peaks.x.max", "value": 1.0, "to": f"body.{name}.mass", "at": 2.0,
             "derivative": size / 2.0, "error": 0.01, "elasticity": size, "note": note}
            for name, size, note in rows
        ]
    )  # fmt: skip
    figure = tornado_figure(table)
    (axes,) = figure.axes
    assert [bar.get_width() for bar in axes.patches] == [2.0, -0.5, 0.0]
    (cross,) = [line for line in axes.get_lines() if line.get_marker() == "x"]
    assert cross.get_xydata().tolist() == [[0.0, 2.0]]
    assert [text.get_text() for text in axes.get_yticklabels()] == [
        "mass of a",
        "mass of b",
        "mass of c",
    ]
    assert tornado_figure(table.assign(elasticity=np.nan)) is None
