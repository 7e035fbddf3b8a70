"""A suite: its rows are those of single runs, and nothing stops it."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eventpound import InputError, Ricker, Study, Support, load_case, simulate, simulate_suite
from eventpound.case.case import member_case
from eventpound.case.loading import read_case
from eventpound.cli import main
from eventpound.motion.intensity import intensity
from eventpound.scene.periods import longest_period
from eventpound.study.response_spectrum import response_spectrum
from eventpound.study.table import read_suite

CASE = """\
title = "a deck beside a barrier"
[excitation]
kind = "record"
{}
[[body]]
name = "deck"
mass = "1301 t"
[[spring]]
between = ["ground", "deck"]
name = "frame"
law = "bouc-wen"
initial_stiffness = "233443 kN/m"
yield_force = "3621 kN"
hardening = 0.05
[[contact]]
between = ["deck", "barrier"]
name = "joint"
gap = "1.27 cm"
restitution = 0.7
"""


def time_series(amplitude: float) -> str:
    t = np.arange(0.0, 4.0, 0.02)
    values = amplitude * np.sin(7.0 * t) * np.exp(-((t - 2.0) ** 2))
    return "\n".join(f"{a:.6f}" for a in values)


@pytest.fixture
def case_folder(tmp_path):
    for name, amplitude in (("a", 0.2), ("b", 0.5), ("d", 0.8)):
        (tmp_path / f"{name}.txt").write_text(time_series(amplitude))
    (tmp_path / "c.txt").write_text("0.1\n0.2\nNaN\n0.1\n")
    excitation = 'suite = "?.txt"\nunits = "g"\ntime_step = "0.02 s"'
    (tmp_path / "case.toml").write_text(CASE.format(excitation))
    return tmp_path


def test_rows_are_single_runs(case_folder):
    case = load_case(case_folder)
    table = simulate_suite(case)
    assert list(table["record"]) == ["a.txt", "b.txt", "c.txt", "d.txt"]
    for member in case.suite.members(case.directory):
        if member.name == "c.txt":
            continue
        one = member_case(case, member, member.read())
        response = simulate(one)
        row = table[table["record"] == member.name].iloc[0]
        # The rows of the history do not enter the steps of the fast solver.
        assert row["peaks.deck.abs_max"] == response.peaks.loc["deck", "abs_max"]
        assert row["peaks.deck.t_min"] == response.peaks.loc["deck", "t_min"]
        assert row["impacts"] == response.impacts
        assert row["contacts.joint.resting_time"] == response.recording.resting_time[0]
        scales = one.scene.motion.scales()
        assert (row["PGA"], row["T_m"], row["L_e"]) == (scales.a_g, scales.period, scales.length)
    assert table["impacts"].max() > 0


def test_threads_change_nothing(case_folder):
    case = load_case(case_folder)
    one, two = (simulate_suite(case, workers=workers) for workers in (1, 2))
    drop = ["seconds.read", "seconds.solve"]
    pd.testing.assert_frame_equal(one.drop(columns=drop), two.drop(columns=drop), check_exact=True)


def test_a_bad_file_is_a_row_with_its_reason(case_folder):
    table = simulate_suite(load_case(case_folder))
    bad = table.iloc[2]
    assert "line 3" in bad["failed"]
    assert np.isnan(bad["peaks.deck.max"])
    assert (table["failed"].drop(index=2) == "").all()


def test_progress_and_kept_responses(case_folder):
    kept, counts = {}, []
    simulate_suite(
        load_case(case_folder),
        progress=lambda done, total: counts.append((done, total)),
        keep=lambda name, case, response: kept.update({name: (case, response)}),
    )
    assert counts == [(0, 4), (1, 4), (2, 4), (3, 4), (4, 4)]
    assert sorted(kept) == ["a.txt", "b.txt", "d.txt"]
    case, response = kept["a.txt"]
    assert len(response.history) > 200
    assert case.record is not None


def test_error_estimate_bounds_the_difference_from_another_solver(case_folder):
    case = load_case(case_folder)
    table = simulate_suite(case, rtol=1e-5, error_estimate=True)
    for member in case.suite.members(case.directory)[:2]:
        one = member_case(case, member, member.read())
        reference = simulate(one, "cvode", 1e-11).peaks.loc["deck", "abs_max"]
        row = table[table["record"] == member.name].iloc[0]
        error = abs(row["peaks.deck.abs_max"] - reference) / reference
        # The estimate is the distance of the finer run, which errs by its own tolerance;
        # the reference errs by 1e-9.
        assert error <= row["error_estimate"] + 1e-7 + 1e-9


def test_an_error_estimate_is_never_of_a_run_beside_itself(case_folder):
    """At the smallest tolerance, and where the case asks for it."""
    # As it is, d has two runs that are the same to the last digit.
    (case_folder / "d.txt").write_text(time_series(0.9))
    case = load_case(case_folder)
    asking = replace(case, run=replace(case.run, error_estimate=True))
    table = simulate_suite(asking, rtol=1e-14)
    errors = table[table["failed"] == ""]["error_estimate"]
    assert (errors > 0.0).all()
    assert (errors < 1e-10).all()
    assert "error_estimate" not in simulate_suite(asking, error_estimate=False)
    with pytest.raises(InputError, match="'moreau' does not keep a tolerance"):
        simulate_suite(asking, solver="moreau")


def test_command_writes_a_table_a_manifest_and_a_figure(case_folder, capsys):
    assert main(["run", str(case_folder), "--histories"]) == 0
    out, err = capsys.readouterr()
    assert "records   3 of 4" in out
    assert "1 of 4 records failed" in err
    assert "c.txt: line 3" in err
    results = case_folder / "results"
    with (results / "suite.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["record"] for row in rows] == ["a.txt", "b.txt", "c.txt", "d.txt"]
    assert rows[2]["peaks.deck.max"] == ""
    manifest = json.loads((results / "suite.json").read_text())
    assert list(manifest["failed"]) == ["c.txt"]
    assert (results / "suite-spectrum.png").stat().st_size > 10_000
    stored = json.loads((results / "records" / "b.txt" / "summary.json").read_text())
    assert repr(stored["peaks"]["deck"]["max"]) == rows[1]["peaks.deck.max"]


def test_measures_of_intensity(case_folder):
    case = load_case(case_folder)
    plain, table = simulate_suite(case), simulate_suite(case, intensities=True)
    assert [c for c in table if c not in plain] == ["PGV", "Sa_T1"]
    period = np.array([longest_period(case.scene)])
    for member, (_, row) in zip(case.suite.members(case.directory), table.iterrows(), strict=True):
        if member.name == "c.txt":
            assert np.isnan(row["PGV"])
            continue
        motion = member.motion()
        assert row["PGV"] == intensity(motion).pgv
        spectrum = response_spectrum(motion, 0.05, period)
        # Two methods, each to 1e-8.
        assert row["Sa_T1"] == pytest.approx(spectrum["PSA"][0], rel=1e-7)


def test_command_writes_measures_of_intensity(case_folder):
    assert main(["run", str(case_folder), "--no-figures"]) == 0
    found = pd.read_csv(case_folder / "results" / "intensity.csv")
    assert found["measure"].tolist() == ["L_e", "PGA", "PGV", "Sa_T1"]
    assert (found["records"] == 3).all()
    # The three motions differ in size only, but for the sixth digit of 0.2 in their files.
    assert found["rank_correlation"].tolist() == [1.0] * 4
    assert np.ptp(found["dispersion"]) < 1e-5
    manifest = json.loads((case_folder / "results" / "suite.json").read_text())
    assert set(manifest["files"]) == {"suite.csv", "intensity.csv"}


def test_plot_draws_the_figure_again(case_folder, capsys):
    assert main(["run", str(case_folder), "--no-figures"]) == 0
    picture = case_folder / "results" / "suite-spectrum.png"
    assert not picture.exists()
    assert main(["plot", str(case_folder)]) == 0
    assert picture.is_file()
    table, _ = read_suite(case_folder / "results")
    assert (table["failed"] == "").sum() == 3
    case = load_case(case_folder)
    again = simulate_suite(case)
    assert table["peaks.deck.max"].to_numpy() == pytest.approx(
        again["peaks.deck.max"].to_numpy(), rel=1e-14, nan_ok=True
    )
    changed = case_folder / "results" / "suite.csv"
    changed.write_text(changed.read_text().replace("a.txt", "A.txt", 1))
    capsys.readouterr()
    assert main(["plot", str(case_folder)]) == 2
    assert "run the case again" in capsys.readouterr().err


def test_a_suite_of_nothing_readable_still_ends_well(tmp_path, capsys):
    (tmp_path / "a.txt").write_text("no numbers here\nat all\n")
    (tmp_path / "case.toml").write_text(CASE.format('suite = "a.txt"'))
    assert main(["run", str(tmp_path)]) == 0
    out, err = capsys.readouterr()
    assert "records   0 of 1" in out
    assert "a.txt" in err


def test_options_of_suites_are_for_suites(tmp_path, capsys):
    main(["new", str(tmp_path)])
    assert main(["run", str(tmp_path), "--histories"]) == 2
    assert main(["run", str(tmp_path), "--suite", "x"]) == 2
    assert 'kind = "record" only' in capsys.readouterr().err
    assert not (tmp_path / "results").exists()


def test_a_scale_of_the_case_is_said(case_folder, capsys):
    file = case_folder / "case.toml"
    for old, new, said in (
        ("[[body]]", "scale = 1.5\n[[body]]", "every record times 1.5 (scale in [excitation])"),
        ("scale = 1.5", 'pga = "0.2 g"', "every record to a PGA of 0.2 g (pga in"),
        ('pga = "0.2 g"', "scale = 1", ""),
    ):
        file.write_text(file.read_text().replace(old, new))
        capsys.readouterr()
        words = ["--suite", str(case_folder / "[ab].txt"), "--no-figures"]
        assert main(["run", str(case_folder), *words]) == 0
        assert main(["check", str(case_folder)]) == 0
        out = capsys.readouterr().out
        assert out.count("scaling") == (2 if said else 0)
        assert out.count(said) >= 2


PIER = """
[[support]]
name = "pier"
excitation = {{ kind = "record", suite = "{}", units = "g", time_step = "0.02 s" }}
[[support]]
name = "later"
delay = 0.1
[[spring]]
between = ["deck", "pier"]
name = "bearing"
law = "linear"
stiffness = "50000 kN/m"
[[spring]]
between = ["deck", "later"]
name = "cable"
law = "linear"
stiffness = "20000 kN/m"
"""


@pytest.fixture
def on_piers(case_folder):
    (case_folder / "c.txt").write_text(time_series(0.3))
    (case_folder / "piers").mkdir()
    for i, amplitude in enumerate((0.1, 0.6, 0.7, 0.4)):
        text = time_series(amplitude) if i != 2 else "0.1\nNaN\n"
        (case_folder / "piers" / f"{i}.txt").write_text(text)
    with (case_folder / "case.toml").open("a") as file:
        file.write(PIER.format("piers/*.txt"))
    return case_folder


def test_records_of_a_support_go_with_those_of_the_ground(on_piers, capsys):
    case = load_case(on_piers)
    table = simulate_suite(case, workers=2)
    assert list(table["file.pier"].map(lambda f: Path(f).name)) == [f"{i}.txt" for i in range(4)]
    failed = table["failed"].tolist()
    assert [bool(f) for f in failed] == [False, False, True, False]
    assert "support 'pier'" in failed[2]
    text = (on_piers / "case.toml").read_text()
    ground, pier = ("abd"[i] for i in (0, 1, 2)), (0, 1, 3)
    for record, i in zip(ground, pier, strict=True):
        own = text.replace("?.txt", f"{record}.txt").replace('suite = "', 'file = "')
        folder = on_piers / f"one-{i}"
        folder.mkdir()
        own = own.replace(f"{record}.txt", f"../{record}.txt").replace("piers/*", f"../piers/{i}")
        (folder / "case.toml").write_text(own)
        response = simulate(load_case(folder), solver="fast")
        row = table[table["record"] == f"{record}.txt"].iloc[0]
        assert row["peaks.deck.abs_max"] == response.peaks.loc["deck", "abs_max"]
        (own_motion,) = (x.motion for x in response.scene.supports if x.name == "pier")
        assert row["PGA.pier"] == np.abs(own_motion.values).max()
    member = case.suite.members(case.directory)[3]
    one = member_case(case, member, member.read())
    again = read_case(one.understood, on_piers / "case.toml")
    there, here = again.scene.supports[0].motion, one.scene.supports[0].motion
    assert np.array_equal(there.values, here.values)
    assert again.scene.supports[1].delay == 0.1
    assert main(["check", str(on_piers)]) == 0
    assert "4" in next(
        line for line in capsys.readouterr().out.splitlines() if line.split()[:1] == ["pier"]
    )


def test_unequal_numbers_are_one_message(on_piers):
    (on_piers / "piers" / "4.txt").write_text(time_series(0.2))
    with pytest.raises(InputError, match=r"support 'pier': found 5 records for the 4 of") as raised:
        load_case(on_piers)
    assert len(raised.value.problems) == 1


def test_no_records_of_a_support(on_piers):
    text = (on_piers / "case.toml").read_text()
    (on_piers / "case.toml").write_text(text.replace("piers/*", "pears/*"))
    with pytest.raises(InputError, match=r"\[\[support\]\] 1 \(pier\).*pears") as raised:
        load_case(on_piers)
    assert len(raised.value.problems) == 1


def test_an_axis_under_records_of_supports(on_piers):
    """Rows of a study are those of the suites of the single values."""
    case = load_case(on_piers)
    delays = [0.0, 0.1]
    study = Study(
        case,
        {"support.later.delay": delays},
        quantities=["peaks.deck.abs_max"],
        rtol=case.solver.rtol,
    )
    table = study.run().table
    assert len(table) == 8
    expected = simulate_suite(case)["peaks.deck.abs_max"].to_numpy()
    own = table[table["support.later.delay"] == 0.1]["peaks.deck.abs_max"].to_numpy()
    np.testing.assert_array_equal(own, expected)
    other = table[table["support.later.delay"] == 0.0]["peaks.deck.abs_max"].to_numpy()
    assert (other[[0, 1, 3]] != expected[[0, 1, 3]]).all()


def test_a_study_knows_its_supports(on_piers):
    """A study goes on where it stopped only if the supports move as they did."""
    scene = replace(load_case(on_piers).scene, motion=Ricker(1.0, 0.5))
    axis = {"body.deck.mass": [1.0e6, 1.2e6]}
    digests = set()
    for delay in (0.1, 0.2):
        supports = (Support("pier", delay), Support("later", 0.1))
        digests.add(Study(replace(scene, supports=supports), axis).plan.digest)
    assert len(digests) == 2
