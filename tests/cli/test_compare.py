"""``eventpound compare``: what it writes, and what it refuses."""

import csv
import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from scipy.optimize import brentq

import eventpound
from eventpound import InputError
from eventpound.accuracy import compare
from eventpound.cli import main
from tests.models import ROOT
from tests.plugged import plug_in

pytestmark = pytest.mark.usefixtures("undrawn")
OTHER = ROOT / "tests" / "accuracy" / "other_program.py"
COLUMNS = "t=time,u.deck=x,v.deck=speed"
# The other program's motion, as a solver plugged in.
PLUGGED = """
import numpy as np
from other_program import rows
from eventpound.solvers.from_samples import sampled_recording

class Heun:
    name, summary, settings = "heun", "Heun", {"time_step": "fixed, 2e-4 s"}

    def solve(self, task):
        t, u, v = np.array(list(rows())).T
        return sampled_recording(task, t, u, v)
"""


@pytest.fixture(scope="module")
def history(tmp_path_factory):
    """A history by another program."""
    file = tmp_path_factory.mktemp("other") / "other.csv"
    subprocess.run([sys.executable, str(OTHER), str(file)], check=True)
    return file


@pytest.fixture
def case(tmp_path):
    shutil.copytree(ROOT / "cases" / "elastic-barrier", tmp_path / "case")
    return tmp_path / "case"


def _rows(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_csv_is_judged_like_a_solver(monkeypatch, tmp_path, case, history):
    """The same rows give the same errors to the last bit, read from a file or computed."""
    sources = {"heun.py": PLUGGED, "other_program.py": OTHER.read_text()}
    plug_in(monkeypatch, tmp_path / "plugged", sources, {"heun": "heun:Heun"})
    words = ["--solvers", "heun", "--steps", "2e-4", "--repeats", "1"]
    words += ["--against", str(history), "--columns", COLUMNS]
    assert main(["compare", str(case), *words]) == 0
    by_solver, by_file = _rows(case / "comparison" / "comparison.csv")
    measured = [key for key in by_solver if "error" in key or "distance" in key or "impact" in key]
    assert len(measured) == 9
    for key in measured:
        assert by_solver[key] == by_file[key], key
    assert by_solver["impacts_matched"] == "5"
    assert 0.0 < float(by_solver["peak_error"]) < 1e-3
    assert by_file["remark"] == "peaks as sampled, impacts read off the velocities"
    rows = _rows(case / "comparison" / "quantities.csv")
    for one, other in zip(rows[: len(rows) // 2], rows[len(rows) // 2 :], strict=True):
        same = [{k: v for k, v in r.items() if k not in ("solver", "size")} for r in (one, other)]
        assert same[0] == same[1]
    for name in ("heun", "other_program"):
        sys.modules.pop(name, None)


def test_two_solvers(case, capsys):
    words = ["--solvers", "fast,cvode:method=BDF", "--rtol", "1e-4,1e-7", "--repeats", "1"]
    assert main(["compare", str(case), *words]) == 0
    out = capsys.readouterr().out
    assert "cvode at rtol 1e-13, checked by fast" in out
    folder = case / "comparison"
    assert (folder / "comparison.txt").read_text() in out
    assert sorted(path.name for path in folder.iterdir()) == [
        "comparison.csv", "comparison.txt", "impacts.csv", "quantities.csv", "report.html",
        "rests.csv", "work-precision.png",
    ]  # fmt: skip
    runs = _rows(folder / "comparison.csv")
    assert [(r["solver"], float(r["rtol"])) for r in runs] == [
        ("fast", 1e-4), ("fast", 1e-7), ("cvode method=BDF", 1e-4), ("cvode method=BDF", 1e-7),
    ]  # fmt: skip
    for run in runs:
        # A global error may be some hundred times the tolerance of a step.
        assert float(run["peak_error"]) < 1e3 * float(run["rtol"])
        assert float(run["graph_distance"]) < 1e3 * float(run["rtol"])
        # The velocity jumps by 1.7 of its largest value at almost, but not quite, one time.
        assert float(run["sup_distance"]) > 1.0
        assert run["impacts_matched"] == "5"
        assert float(run["seconds"]) > 0.0
    peaks = {r["quantity"]: r for r in _rows(folder / "quantities.csv") if r["solver"] == "fast"}
    minimum = peaks["peaks.deck.min"]
    error = abs(float(minimum["value"]) - float(minimum["reference"])) / float(minimum["scale"])
    assert float(minimum["error"]) == error


def test_a_history_alone_needs_no_solver_and_may_be_short(case, history, tmp_path):
    lines = history.read_text().splitlines()
    short = tmp_path / "short.csv"
    short.write_text("\n".join(["t,u.deck", *(row.rsplit(",", 1)[0] for row in lines[1:7502])]))
    (tmp_path / "short.events.csv").write_text("t,contact\n0.3636,joint\n0.5929,joint\n1.1,joint\n")
    assert main(["compare", str(case), "--solvers", "none", "--against", str(short)]) == 0
    (run,) = _rows(case / "comparison" / "comparison.csv")
    assert run["remark"] == "peaks as sampled, without v.deck, up to t = 1.5 s"
    # The reference has 0.36360, 0.59292, 1.03460 and 1.41926 s by then.
    assert (run["impacts_matched"], run["impacts_missed"]) == ("3", "1")
    assert float(run["peak_error"]) < 1e-3
    assert not (case / "comparison" / "work-precision.png").exists()


def test_a_suite_is_refused(capsys):
    assert main(["compare", str(ROOT / "cases" / "figure-12")]) == 2
    assert "the case holds a suite of records" in capsys.readouterr().err


def test_our_own_history_has_no_error(case, capsys):
    assert main(["run", str(case), "--rtol", "1e-13", "--no-figures"]) == 0
    assert main(["compare", str(case), "--against", str(case / "results" / "history.csv")]) == 0
    (run,) = _rows(case / "comparison" / "comparison.csv")
    assert float(run["graph_distance"]) == 0.0
    assert float(run["final_error"]) == 0.0
    assert (run["impacts_matched"], run["impact_shift"]) == ("5", "0.0")


def test_impacts_on_a_support_are_read_off(tmp_path):
    """A wall sets out, s' = (a/w) (1 - cos w t), and strikes a free ball: its only impact."""
    case, a, w, gap, e = tmp_path / "case", 1.0, math.pi, 0.2, 0.5
    case.mkdir()
    (case / "case.toml").write_text(
        f"""excitation = {{ kind = "none" }}
        run = {{ duration = 1.5 }}
        body = [{{ name = "ball", mass = 3.0 }}]
        [[support]]
        name = "wall"
        excitation = {{ kind = "sine", amplitude = {a}, period = {2.0 * math.pi / w} }}
        [[contact]]
        between = ["wall", "ball"]
        name = "face"
        gap = {gap}
        restitution = {e}"""
    )
    struck = brentq(lambda t: (a / w) * (t - math.sin(w * t) / w) - gap, 0.0, 1.0, xtol=1e-15)
    speed = (1.0 + e) * (a / w) * (1.0 - math.cos(w * struck))
    lines = [f"{struck * k / 100!r},0,0" for k in range(101)]
    times = [struck + (1.5 - struck) * k / 100 for k in range(101)]
    lines += [f"{t!r},{speed * (t - struck)!r},{speed!r}" for t in times]
    (tmp_path / "ball.csv").write_text("\n".join(["t,u.ball,v.ball", *lines]))
    words = ["--solvers", "none", "--against", str(tmp_path / "ball.csv")]
    assert main(["compare", str(case), *words]) == 0
    (run,) = _rows(case / "comparison" / "comparison.csv")
    found = [run[f"impacts_{word}"] for word in ("matched", "missed", "extra")]
    assert found == ["1", "0", "0"]
    assert max(float(run[key]) for key in ("impact_shift", "graph_distance")) < 1e-9


def test_rests_and_detachments_are_matched(tmp_path, capsys):
    """A body pressed to its wall, let go, bouncing to rest and let go again: twice each."""
    case = tmp_path / "case"
    shutil.copytree(ROOT / "cases" / "hard" / "starts-compressed", case)
    assert main(["run", str(case), "--solver", "fast", "--rtol", "1e-10", "--no-figures"]) == 0
    words = ["--solvers", "fast,moreau,penalty", "--rtol", "1e-6", "--steps", "1e-3"]
    words += ["--repeats", "1", "--against", str(case / "results" / "history.csv")]
    capsys.readouterr()
    assert main(["compare", str(case), *words]) == 0
    assert "detachments" in capsys.readouterr().out
    fast, moreau, penalty, file = _rows(case / "comparison" / "comparison.csv")
    for run, shift in ((fast, 1e-4), (moreau, 2e-2), (file, 1e-8)):
        for kind in ("rest", "detachment"):
            counts = [run[f"{kind}s_{word}"] for word in ("matched", "missed", "extra")]
            assert counts == ["2", "0", "0"], (run["solver"], kind)
            assert float(run[f"{kind}_shift"]) < shift
    # Its contact elements never rest.
    assert penalty["rests_missed"] == penalty["rest_shift"] == ""
    rests = _rows(case / "comparison" / "rests.csv")
    assert [r["kind"] for r in rests if r["solver"] == "fast"] == ["rest", "detachment"] * 2
    assert not [r for r in rests if r["solver"] == "penalty"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--solvers", "euler"], "solver = 'euler' is not known; accepted: cvode, "),
        (["--solvers", "fast,"], "--solvers: found ''; accepted: NAME"),
        (["--solvers", "cvode:method"], "found 'method'; accepted: key=value"),
        (["--solvers", "cvode:theta=1"], "theta is not a setting of cvode; accepted: method"),
        (["--solvers", "cvode:rtol=1e-4"], "rtol cannot stand here"),
        (["--solvers", "cvode:time_step=1"], "time_step cannot stand here; give it to --steps"),
        (["--solvers", "cvode:method=RK4"], "method = 'RK4'; accepted: Adams or BDF"),
        (["--solvers", "moreau:theta=7", "--steps", "1e-3"], "theta = 7; accepted: a number from"),
        (["--solvers", "penalty:contact=x", "--steps", "1"], "contact is not a setting of penal"),
        (["--solvers", "none"], "--solvers: found 'none'; accepted: that with --against CSV only"),
        (["--rtol", "1e-15"], "rtol: found 1e-15; accepted: a number from 1e-14 to 0.01"),
        (["--against", "nowhere.csv"], "nowhere.csv: cannot be read"),
        (["--columns", "t"], "--columns: found t; accepted: u.deck=disp1,t=time"),
        (
            ["--columns", "t=time"],
            "columns: found without against; accepted: beside a history alone",
        ),
    ],
)
def test_refused(case, capsys, words, message):
    assert main(["compare", str(case), *words]) == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.count("eventpound:") == 1
    assert not (case / "comparison").exists()


def test_a_setting_that_a_plug_in_misses_is_named(monkeypatch, tmp_path, case, capsys):
    source = PLUGGED.replace('"time_step": "fixed, 2e-4 s"', '"colour": "a word"').replace(
        "np.array(list(rows()))", 'np.array(task.settings["colour"])'
    )
    sources = {"heun.py": source, "other_program.py": OTHER.read_text()}
    plug_in(monkeypatch, tmp_path / "plugged", sources, {"heun": "heun:Heun"})
    assert main(["compare", str(case), "--solvers", "heun", "--rtol", "1e-4"]) == 2
    message = "[solver]: colour: missing, and the solver 'heun' has no default for it; accepted: a"
    assert message in capsys.readouterr().err
    assert not (case / "comparison").exists()


@pytest.mark.parametrize(
    "words",
    [["--steps", "0"], ["--steps", "x"], ["--rtol", "2"], ["--rtol", ""], ["--repeats", "0"]],
)
def test_numbers_that_are_none(case, capsys, words):
    with pytest.raises(SystemExit) as caught:
        main(["compare", str(case), *words])
    assert caught.value.code == 2
    assert "accepted" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "columns", "message"),
    [
        ("t,x\n0,0\n4,0\n", "", "no column u.deck; found t, x; accepted: t, u.deck, v.deck; --col"),
        (
            "t,x\n0,0\n4,0\n",
            "u.deck=y",
            "no column u.deck; found t, x; accepted: t, u.deck, v.deck; --col",
        ),
        ("0 0\n4 0\n", "t=1,u.deck=3", "no column u.deck; found 1, 2; accepted: t, u.deck"),
        ("t,x (m/s)\n0,0\n4,0\n", "u.deck=2", "'x (m/s)' is no u.deck, which is a displacement"),
        ("t,x\n0,0\n4,0\n", "u.dock=x", "u.dock is not known; accepted: t, u.deck, v.deck"),
        ("t,u.deck\n0,0\n4,\n", "", "row 2, column u.deck: found ''; accepted: a finite number"),
        ("t,u.deck\n0,0\n4,x\n", "", "row 2, column u.deck: found 'x'; accepted: a finite number"),
        ("t,u.deck\n0,0\n", "", "has 1 rows; at least two are needed"),
        ("t,u.deck\n0,0\n2,0\n1,0\n", "", "row 3: t goes back"),
        ("t,u.deck\n1,0\n2,0\n", "", "begins at t = 1 s, the case at 0 s"),
        ("t,u.deck\n0,0\n0,0\n", "", "all rows are of one time, 0 s"),
    ],
)
def test_histories_that_cannot_be_judged(case, tmp_path, capsys, text, columns, message):
    file = tmp_path / "other.csv"
    file.write_text(text)
    words = ["--columns", columns] if columns else []
    assert main(["compare", str(case), "--against", str(file), *words]) == 2
    assert message in capsys.readouterr().err
    assert not (case / "comparison").exists()


def test_a_recorder_without_names_is_judged_by_the_numbers_of_its_columns(case, history, tmp_path):
    named = tmp_path / "named"
    shutil.copytree(case, named)
    words = ["--against", str(history), "--columns", COLUMNS]
    assert main(["compare", str(named), *words]) == 0
    (tmp_path / "node.out").write_text(
        "".join(" ".join(row.values()) + "\n" for row in _rows(history))
    )
    order = list(_rows(history)[0])
    numbers = {ours: 1 + order.index(theirs) for ours, theirs in _pairs(COLUMNS)}
    words = ["--against", str(tmp_path / "node.out")]
    words += ["--columns", ",".join(f"{ours}={number}" for ours, number in numbers.items())]
    assert main(["compare", str(case), *words]) == 0
    ours, theirs = (_rows(each / "comparison" / "comparison.csv")[0] for each in (case, named))
    for key in theirs:
        if "error" in key or "distance" in key or "impact" in key:
            assert ours[key] == theirs[key], key


def _pairs(columns: str) -> list[tuple[str, str]]:
    return [(ours, theirs) for ours, _, theirs in (p.partition("=") for p in columns.split(","))]


def test_events_of_an_unknown_contact(case, tmp_path, capsys):
    (tmp_path / "other.csv").write_text("t,u.deck\n0,0\n4,0\n")
    (tmp_path / "other.events.csv").write_text("t,contact\n1,door\n")
    assert main(["compare", str(case), "--against", str(tmp_path / "other.csv")]) == 2
    assert "contact 'door' is not known; accepted: joint" in capsys.readouterr().err


def test_a_stepped_solver_needs_steps(monkeypatch, tmp_path, case, capsys):
    source = PLUGGED.replace("from other_program import rows\n", "")
    plug_in(monkeypatch, tmp_path / "plugged", {"heun2.py": source}, {"heun": "heun2:Heun"})
    assert main(["compare", str(case), "--solvers", "heun"]) == 2
    assert "--steps: heun takes fixed steps; give some" in capsys.readouterr().err


def test_a_run_that_fails_does_not_stop_the_others(monkeypatch, tmp_path, case, capsys):
    source = PLUGGED.replace("from other_program import rows\n", "").replace(
        "t, u, v = np.array(list(rows())).T", "raise RuntimeError('no licence')"
    )
    plug_in(monkeypatch, tmp_path / "plugged", {"heun3.py": source}, {"heun": "heun3:Heun"})
    words = ["--solvers", "heun,fast", "--steps", "0.01", "--rtol", "1e-5", "--repeats", "1"]
    assert main(["compare", str(case), *words]) == 0
    failed, done = _rows(case / "comparison" / "comparison.csv")
    assert failed["remark"] == "failed: RuntimeError: no licence"
    assert failed["peak_error"] == failed["seconds"] == ""
    assert float(done["peak_error"]) < 1e-2
    assert "no licence" in capsys.readouterr().out


def _certify(case: Path, folder: str, minimum: float) -> None:
    (case / folder).mkdir(exist_ok=True)
    (case / folder / "certificate.json").write_text(
        f'{{"quantities": [{{"quantity": "peaks.deck.min", "value": {minimum}, "bound": 7e-4,'
        ' "certified": true}, {"quantity": "final.deck.u", "value": 1.0, "bound": null,'
        ' "certified": false}]}'
    )


@pytest.mark.parametrize("folder", ["results", "."])
def test_the_certificate_is_the_reference(case, capsys, folder):
    # The true minimum is -0.040638 m.
    _certify(case, folder, -0.041)
    assert main(["compare", str(case), "--solvers", "fast", "--rtol", "1e-6"]) == 0
    assert "certificate.json, and for what it does not certify cvode" in capsys.readouterr().out
    rows = {r["quantity"]: r for r in _rows(case / "comparison" / "quantities.csv")}
    found = rows["peaks.deck.min"]
    assert (found["reference"], found["bound"]) == ("-0.041", "0.0007")
    assert abs(float(rows["final.deck.u"]["reference"])) < 0.1


def test_a_certificate_of_another_case(case, capsys):
    _certify(case, "results", -0.07)
    assert main(["compare", str(case), "--solvers", "fast"]) == 2
    assert "peaks.deck.min = -0.07 +- 7.0e-04, but the case" in capsys.readouterr().err


def test_a_certificate_of_another_form(case, capsys):
    (case / "certificate.json").write_text("{}")
    assert main(["compare", str(case), "--solvers", "fast"]) == 2
    assert "'quantities' must be a list" in capsys.readouterr().err


def test_an_interrupt_keeps_the_runs_that_are_done(monkeypatch, case, capsys):
    whole = compare.judge

    def judge(case, entry, reference, repeats):
        if entry.rtol == 1e-8:
            raise KeyboardInterrupt
        return whole(case, entry, reference, repeats)

    monkeypatch.setattr(compare, "judge", judge)
    words = ["--solvers", "fast", "--rtol", "1e-4,1e-6,1e-8,1e-10", "--repeats", "1"]
    assert main(["compare", str(case), *words]) == 130
    assert [row["rtol"] for row in _rows(case / "comparison" / "comparison.csv")] == [
        "0.0001",
        "1e-06",
    ]
    assert "2 of 4 runs are in" in capsys.readouterr().err


def test_beside_the_rigid_law(tmp_path, capsys):
    """A stiffer spring is nearer to the rigid law, and its stepper as near to its own model."""
    errors = {}
    for stiffness in ("1e6 kN/m", "1e10 kN/m"):
        case = tmp_path / stiffness.split()[0]
        shutil.copytree(ROOT / "cases" / "pair-with-law", case)
        text = (case / "case.toml").read_text()
        law = f'law = "kelvin-voigt"\nstiffness = "{stiffness}"\n'
        text = text.replace('law = "jankowski"\nstiffness = "2.75e6 kN/m^1.5"\n', law)
        (case / "case.toml").write_text(text)
        words = ["--solvers", "penalty,cvode", "--steps", "1e-4", "--rtol", "1e-9"]
        assert main(["compare", str(case), *words, "--repeats", "1"]) == 0
        out = capsys.readouterr().out
        assert "rigid law: Newton's with a restitution of joint 0.6; cvode at rtol 1e-13" in out
        stepper, cvode, alone = _rows(case / "comparison" / "comparison.csv")
        assert (alone["solver"], alone["peak_error"]) == ("(contact laws)", "")
        errors[stiffness] = float(alone["rigid_graph_distance"])
        # By its own model cvode has no error to speak of: what is left is the spring's.
        own = 1.1 * float(cvode["graph_distance"])
        assert own < 1e-6
        assert float(cvode["rigid_graph_distance"]) == pytest.approx(errors[stiffness], abs=own)
        # Distances of curves, but for the scales of the two models, obey the triangle's inequality.
        own = 1.1 * float(stepper["graph_distance"])
        assert float(stepper["rigid_graph_distance"]) == pytest.approx(errors[stiffness], abs=own)
    # A hundredth of the time in contact.
    soft, stiff = errors.values()
    assert stiff < 0.05 * soft


def test_another_restitution_of_the_rigid_law(case, capsys):
    words = ["--solvers", "fast", "--rtol", "1e-6", "--repeats", "1", "--restitution", "0.3"]
    assert main(["compare", str(case), *words]) == 2
    assert "no contact of the case has a law of its own" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["compare", str(case), "--restitution", "1.3"])
    assert "accepted: a number from 0 to 1" in capsys.readouterr().err


def test_a_rigid_law_that_cannot_be_had_is_said(tmp_path, capsys):
    case = tmp_path / "case"
    shutil.copytree(ROOT / "cases" / "pair-with-law", case)
    text = (case / "case.toml").read_text().replace('gap = "1 cm"', 'gap = "-1 mm"')
    (case / "case.toml").write_text(text)
    # Without --solvers it is cvode alone, which takes the scene.
    assert main(["compare", str(case), "--rtol", "1e-6", "--repeats", "1"]) == 0
    out = capsys.readouterr().out
    assert [row["solver"] for row in _rows(case / "comparison" / "comparison.csv")] == ["cvode"]
    assert "rigid law: not to be had: " in out
    assert "joint" in out.split("not to be had: ")[1].splitlines()[0]
    assert "rigid_peak_error" not in (case / "comparison" / "comparison.csv").read_text()


def test_python_writes_what_the_command_writes(case, history, tmp_path):
    """The same tables, diagram and page, of the same runs, where none are named."""
    words = ["--solvers", "fast", "--repeats", "1", "--against", str(history)]
    assert main(["compare", str(case), *words, "--columns", COLUMNS]) == 0
    out, columns = tmp_path / "python", dict(_pairs(COLUMNS))
    asked = {"against": [history], "columns": columns, "repeats": 1, "out": out}
    table = eventpound.compare(eventpound.load_case(case), ["fast"], **asked)
    assert table["rtol"].dropna().tolist() == [1e-4, 1e-6, 1e-8, 1e-10]
    theirs = case / "comparison"
    assert {f.name for f in out.iterdir()} == {f.name for f in theirs.iterdir()}
    assert (out / "work-precision.png").read_bytes()[:4] == b"\x89PNG"
    for name in ("quantities.csv", "impacts.csv"):
        assert (out / name).read_bytes() == (theirs / name).read_bytes()
    with pytest.raises(InputError, match="cannot be written to"):
        eventpound.compare(eventpound.load_case(case), ["fast"], out=history)
