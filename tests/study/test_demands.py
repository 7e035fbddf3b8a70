"""What is decided by a scene: elements by kind, seats, capacities; beside SciPy and by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

from eventpound import Cosine, InputError, design_numbers, load_case, simulate, simulate_suite
from eventpound.case import read_case
from eventpound.cli import main
from eventpound.scene import (
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Dashpot,
    Linear,
    Scene,
    Seat,
    Spring,
)
from eventpound.study.design import design_of_run
from tests.study.test_suite import CASE, time_series

M_P, M_D, K, Q, UY, K_B, K_C, SLACK, C = 1e5, 6e5, 2e6, 1.2e6, 0.01, 8e6, 2e7, 0.03, 3e5
PERIOD, END = 0.9, 5.0
MOTION = Cosine(amplitude=4.0, period=PERIOD)


def bridge() -> Scene:
    """A deck on a bearing on a pier that yields, with a cable to the ground."""
    return Scene(
        (Body("pier", M_P), Body("deck", M_D)),
        (
            Spring("column", (GROUND, "pier"), BoucWen(K, Q, UY, exponent=3.0)),
            Spring("bearing", ("pier", "deck"), Linear(K_B)),
            Spring("cable", (GROUND, "deck"), BilinearElastic(0.0, K_C, SLACK)),
        ),
        (Dashpot((GROUND, "pier"), C),),
        motion=MOTION,
        seats=(Seat("abutment", (GROUND, "deck")), Seat("ledge", ("deck", "pier"))),
    )


def forces(u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of column, bearing and cable, of u_pier, u_deck, their rates and z (N)."""
    pier, deck, z = u[0], u[1], u[4]
    return K * pier + Q * z, K_B * (deck - pier), K_C * np.maximum(deck - SLACK, 0.0)


def rates(t: float, u: np.ndarray, amplitude: float) -> np.ndarray:
    """The equations of motion, written out."""
    ground = amplitude * np.cos(2.0 * np.pi / PERIOD * t)
    column, bearing, cable = forces(u)
    v, z = u[2], u[4]
    pier = (bearing - column - C * v) / M_P - ground
    deck = -(bearing + cable) / M_D - ground
    # n = 3, beta = gamma = 1/2.
    z_rate = (v - 0.5 * abs(v) * z * z**2 - 0.5 * v * abs(z) ** 3) / UY
    return np.array((v, u[3], pier, deck, z_rate))


def by_scipy() -> dict[str, float]:
    """The same numbers by SciPy, from rows every 0.1 ms."""
    u, parts = np.zeros(5), []
    for low, high, amplitude in ((0.0, PERIOD, 4.0), (PERIOD, END, 0.0)):
        times = np.linspace(low, high, round((high - low) / 1e-4) + 1)
        tight = {"rtol": 1e-10, "atol": 1e-12, "max_step": 1e-3}
        span = (low, high)
        found = solve_ivp(rates, span, u, "DOP853", times, args=(amplitude,), **tight)
        u = found.y[:, -1]
        parts.append(found.y)
    y = np.concatenate(parts, axis=1)
    column, bearing, cable = forces(y)
    return {
        "springs.column.abs_max_force": np.abs(column).max(),
        "springs.column.ductility": np.abs(y[0]).max() / UY,
        "springs.column.residual_elongation": abs(y[0, -1]),
        "springs.bearing.abs_max_force": np.abs(bearing).max(),
        "springs.bearing.abs_max_elongation": np.abs(y[1] - y[0]).max(),
        "springs.cable.abs_max_force": cable.max(),
        "springs.cable.slack_left": max(SLACK - y[1].max(), 0.0),
        "seats.abutment.max_opening": y[1].max(),
        "seats.ledge.max_opening": (y[0] - y[1]).max(),
        "base_shear.abs_max": np.abs(column + C * y[2] + cable).max(),
    }


def test_forces_seats_and_shears_are_those_of_an_independent_program():
    run = simulate(bridge(), "fast", rtol=1e-10, duration=END)
    table = design_of_run(run).set_index("quantity")
    for name, value in by_scipy().items():
        # Rows of SciPy miss a peak by a part (omega dt)^2/8 of it, some 1e-6.
        assert table.loc[name, "value"] == pytest.approx(value, rel=2e-5, abs=1e-9), name
    kinds = table["kind"].to_dict()
    assert kinds["springs.cable.abs_max_force"] == "Restrainers"
    assert kinds["springs.bearing.abs_max_force"] == "Bearings and other elastic springs"
    assert kinds["springs.column.ductility"] == "Piers and other yielding springs"
    assert kinds["seats.ledge.max_opening"] == "Seats"


def test_slack_that_is_left_is_told_by_what_keeps_least(tmp_path):
    cable = (
        '[[spring]]\nname = "cable"\nbetween = ["ground", "deck"]\nlaw = "bilinear-elastic"\n'
        'compression = 0\nextension = "1 kN/m"\noffset = "2 m"\n'
    )
    for name, amplitude in (("a", 0.1), ("b", 0.3), ("c", 0.5)):
        (tmp_path / f"{name}.txt").write_text(time_series(amplitude))
    text = CASE.format('suite = "?.txt"\nunits = "g"\ntime_step = "0.02 s"')
    (tmp_path / "case.toml").write_text(text.replace("[[contact]]", f"{cable}[[contact]]"))
    table = design_numbers(load_case(tmp_path)).set_index("quantity")
    left, opening = table.loc["springs.cable.slack_left"], table.loc["springs.frame.ductility"]
    runs = simulate_suite(load_case(tmp_path))
    kept = sorted(runs["springs.cable.slack_left"])
    # 84 % keep at least the fractile of 16 %, at 0.16 of two distances between three values.
    assert left["84 %"] == pytest.approx(kept[0] + 0.32 * (kept[1] - kept[0]), rel=1e-9)
    assert left["50 %"] == pytest.approx(kept[1], rel=1e-9)
    assert left["largest"] == kept[0]
    assert left["under"] == runs["record"][runs["springs.cable.slack_left"].idxmin()]
    assert opening["50 %"] < opening["84 %"] < opening["largest"]


FRAME = """\
title = "two storeys"
[excitation]
kind = "sine"
amplitude = "0.3 g"
period = "0.7 s"
[[building]]
name = "A"
storeys = 2
mass = "200 t"
stiffness = ["200 MN/m", "90 MN/m"]
height = "3 m"
capacity = { drift = 0.004 }
[run]
duration = "3 s"
"""


def test_a_building_has_shear_roof_and_the_storey_of_its_largest_drift(tmp_path):
    (tmp_path / "case.toml").write_text(FRAME)
    case = load_case(tmp_path)
    assert dict(case.run.stated.capacities) == {
        "springs.storey-A1.drift_ratio": 0.004,
        "springs.storey-A2.drift_ratio": 0.004,
    }
    run = simulate(case, rtol=1e-9)
    table = design_numbers(case).set_index("quantity")
    roof = table.loc["structures.A.roof_drift", "value"]
    assert roof == pytest.approx(run.peaks.loc["A2", "abs_max"], rel=1e-12)
    drifts = [run.quantity(f"springs.storey-A{i}.drift_ratio") for i in (1, 2)]
    largest = table.loc["structures.A.storey_drift_ratio"]
    assert largest["value"] == max(drifts)
    assert largest["at"] == f"storey-A{1 + int(np.argmax(drifts))}"
    for i, drift in enumerate(drifts, 1):
        row = table.loc[f"springs.storey-A{i}.drift_ratio"]
        assert row["demand/capacity"] == pytest.approx(drift / 0.004, rel=1e-12)
        assert row["passes"] == ("yes" if drift <= 0.004 else "no")
    assert run.quantity("demand_over_capacity") == pytest.approx(max(drifts) / 0.004, rel=1e-12)
    # As it was understood it is the same case.
    again = read_case(case.understood, tmp_path / "case.toml")
    assert again.run.stated == case.run.stated


def suite_with(tmp_path: Path, capacity: str, more: str = "") -> pd.DataFrame:
    for name, amplitude in (("a", 0.1), ("b", 0.2), ("c", 0.5), ("d", 0.8)):
        (tmp_path / f"{name}.txt").write_text(time_series(amplitude))
    text = CASE.format('suite = "?.txt"\nunits = "g"\ntime_step = "0.02 s"')
    text = text.replace('name = "frame"', f'name = "frame"\ncapacity = {capacity}')
    (tmp_path / "case.toml").write_text(text + more)
    return design_numbers(load_case(tmp_path)).set_index("quantity")


def test_a_demand_is_held_at_the_fractile_that_is_stated(tmp_path):
    more = '[[seat]]\nname = "end"\nbetween = ["ground", "deck"]\ncapacity = { length = "1 m" }\n'
    more += "[capacity]\nfractile = 60\n"
    table = suite_with(tmp_path, "{ ductility = 3 }", more)
    case = load_case(tmp_path)
    runs = simulate_suite(case)
    values = sorted(runs["springs.frame.ductility"])
    # At 0.6 of three distances between four values.
    held = values[1] + 0.8 * (values[2] - values[1])
    row = table.loc["springs.frame.ductility"]
    assert row["demand/capacity"] == pytest.approx(held / 3.0, rel=1e-6)
    assert table.loc["seats.end.max_opening", "passes"] == "yes"
    ratios = np.maximum(runs["springs.frame.ductility"] / 3.0, runs["seats.end.max_opening"])
    assert runs["demand_over_capacity"].to_numpy() == pytest.approx(ratios.to_numpy(), rel=1e-12)


def test_what_has_to_be_left_is_held_from_below(tmp_path):
    more = '[[spring]]\nname = "cable"\nbetween = ["ground", "deck"]\nlaw = "bilinear-elastic"\n'
    more += "compression = 0\nextension = 1e3\noffset = 10\n"
    name = "springs.cable.slack_left"
    table = suite_with(tmp_path, "{ ductility = 1e6 }", f'{more}[capacity]\n"{name}" = 9.99\n')
    runs = simulate_suite(load_case(tmp_path))
    left = sorted(runs[name])
    # What 84 % keep: at 0.16 of three distances.
    held = left[0] + 0.48 * (left[1] - left[0])
    assert table.loc[name, "demand/capacity"] == pytest.approx(9.99 / held, rel=1e-9)
    assert table.loc[name, "passes"] == "no"
    assert runs["demand_over_capacity"].to_numpy() == pytest.approx(9.99 / runs[name], rel=1e-12)


def test_quantities_of_the_case_stand_in_its_report(tmp_path):
    words = '["velocity.<body>.abs_max", "free.peaks.deck.abs_max", "impacts"]'
    table = suite_with(tmp_path, "{ ductility = 9 }", f"[run]\nquantities = {words}\n")
    asked = table[table["kind"] == "Asked for in the case"]
    runs = simulate_suite(load_case(tmp_path))
    names = ["velocity.deck.abs_max", "free.peaks.deck.abs_max", "impacts"]
    assert asked.index.tolist() == names
    assert asked["largest"].to_numpy() == pytest.approx([runs[n].max() for n in names], rel=1e-12)
    assert asked["demand"].iloc[1] == "peak displacement without contact"
    # Counts are whole.
    fractiles = np.percentile(runs["impacts"], [50.0, 84.0])
    assert (fractiles % 1.0).any(), runs["impacts"]
    assert asked.loc["impacts", ["50 %", "84 %"]].tolist() == np.ceil(fractiles).tolist()


def test_a_pier_with_a_height_is_no_storey():
    scene = bridge()
    pier = replace(scene.springs[0], height=7.0)
    scene = replace(scene, springs=(pier, *scene.springs[1:]))
    response = simulate(scene, "fast", duration=1.0)
    assert "max_drift" not in response.summary
    table = design_of_run(response).set_index("quantity")
    assert table.loc["springs.column.drift_ratio", "kind"] == "Piers and other yielding springs"
    assert "Storeys" not in set(table["kind"])
    assert not [name for name in table.index if name.startswith("structures.")]


def test_where_a_record_failed_nobody_knows_whether_all_would_pass(tmp_path):
    (tmp_path / "e.txt").write_text("0.1\nNaN\n")
    table = suite_with(tmp_path, '{ ductility = 1e6, force = "1 kN" }')
    assert table.loc["springs.frame.ductility", "passes"] == "not known"
    assert table.loc["springs.frame.abs_max_force", "passes"] == "no"


@pytest.mark.parametrize(
    ("capacity", "more", "said"),
    [
        ("{ ductilty = 3 }", "", "capacity.ductilty: unknown key, did you mean 'ductility'?"),
        ("{ ductility = 0 }", "", "capacity.ductility: found 0; accepted: a positive capacity"),
        ('{ force = "3 mm" }', "", "capacity.force: found '3 mm'"),
        ("3", "", "capacity: found 3; accepted: a table"),
        ("{ drift = 0.1 }", "", "capacity: found 'springs.frame.drift_ratio'"),
        ("{}", "[capacity]\nfractile = 0\n", "[capacity]: fractile: found 0; accepted: per cent"),
        (
            "{}",
            '[capacity]\n"acceleration.deck.abs_max" = "5 cm"\n',
            "acceleration.deck.abs_max: found a unit of length; accepted: an acceleration",
        ),
        (
            "{}",
            '[capacity]\n"acceleration.deck.abs_max" = "5 quux"\n',
            "acceleration.deck.abs_max: found '5 quux'; accepted: a number (SI), or",
        ),
        ("{}", '[[seat]]\nbetween = ["ground", "dek"]\n', "between: found ['ground', 'dek']"),
    ],
)
def test_what_no_capacity_or_seat_is_is_refused(tmp_path, capsys, capacity, more, said):
    (tmp_path / "a.txt").write_text(time_series(0.2))
    text = CASE.format('suite = "?.txt"\nunits = "g"\ntime_step = "0.02 s"')
    text = text.replace('name = "frame"', f'name = "frame"\ncapacity = {capacity}') + more
    (tmp_path / "case.toml").write_text(text)
    assert main(["report", str(tmp_path)]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert "case.toml" in err
    assert not (tmp_path / "results").exists()


def test_a_seat_of_python_is_checked():
    scene = Scene((Body("deck", 1e5),), seats=(Seat("end", (GROUND, "pier")),))
    with pytest.raises(InputError, match=r"seat 1 \(end\): between"):
        simulate(scene, duration=1.0)


def test_curves_by_an_axis_are_those_of_its_values(tmp_path, capsys):
    rng, rows = np.random.default_rng(4), ["pga,gap,demand,success,message"]
    for gap in (0.01, 0.02):
        for pga in np.repeat([1.0, 2.0, 3.0, 4.0], 20):
            demand = pga * gap * np.exp(0.4 * rng.normal())
            rows.append(f"{pga},{gap},{demand},True,")
    (tmp_path / "study.csv").write_text("\n".join(rows) + "\n")
    words = ["study", "fragility", str(tmp_path), "--measure", "pga", "--demand", "demand"]
    words += ["--limit", "0.04", "--counts", "--out", str(tmp_path)]
    assert main([*words, "--by", "gap"]) == 0
    both = pd.read_csv(tmp_path / "fragility.csv")
    assert both["gap"].tolist() == [0.01, 0.02]
    for i, gap in enumerate((0.01, 0.02)):
        assert main([*words, "--where", f"gap={gap}"]) == 0
        alone = pd.read_csv(tmp_path / "fragility.csv")
        for key in ("theta", "beta", "exceeded", "count"):
            assert alone[key].tolist() == [both[key][i]]
    capsys.readouterr()
    assert main([*words, "--by", "gab"]) == 2
    assert "--by: found 'gab'; accepted: of" in capsys.readouterr().err
