"""Signals, full disks, vanishing files, two runs at once: whole files or none, the right code."""

import itertools
import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

import eventpound.cli.arguments
import eventpound.response
import eventpound.results.files
from eventpound import Scene, results
from eventpound.cli import main, progress
from eventpound.cli.progress import Watch
from tests.motion.readers.writers import at2, motion

DECK = """\
[[body]]
name = "deck"
mass = "1000 t"
[[spring]]
between = ["ground", "deck"]
name = "piers"
law = "linear"
period = "0.5 s"
[[contact]]
between = ["deck", "barrier"]
name = "joint"
gap = "1 cm"
restitution = 0.7
"""
ENDLESS = f"""\
title = "longer than anybody waits"
[excitation]
kind = "harmonic"
amplitude = "0.4 g"
period = "0.8 s"
{DECK}[run]
duration = "{{duration}} s"
output_step = "0.1 s"
avoiding_gap = {{avoiding_gap}}
"""
SET = ["events.csv", "history.csv", "manifest.json", "summary.json"]
SIGNALS = [signal.SIGINT, signal.SIGTERM]


def written(tmp_path: Path, duration: float = 1e5, avoiding_gap: str = "false") -> Path:
    """A case, and where its results will be."""
    text = ENDLESS.format(duration=duration, avoiding_gap=avoiding_gap)
    (tmp_path / "case.toml").write_text(text)
    return tmp_path / "results"


def run(tmp_path: Path, *words: str) -> int:
    return main(["run", str(tmp_path), "--no-figures", *words])


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir()) if folder.exists() else []


def complete(folder: Path) -> object:
    results.read(folder)  # refuses a set whose hashes differ
    return json.loads((folder / "manifest.json").read_text())["complete"]


def at_call(number: int, act: Callable[[], object], function: Callable) -> Callable:
    """A function that does something else, too, when it is called the n-th time."""
    calls = []

    def called(*arguments: object, **options: object) -> object:
        calls.append(arguments)
        if len(calls) == number:
            act()
        return function(*arguments, **options)

    return called


@pytest.mark.parametrize("number", SIGNALS)
def test_interrupted_while_loading(number, tmp_path, monkeypatch, capsys):
    folder = written(tmp_path)
    act = at_call(1, lambda: signal.raise_signal(number), eventpound.cli.arguments.loaded_case)
    monkeypatch.setattr(eventpound.cli.arguments, "loaded_case", act)
    assert run(tmp_path) == 130
    assert names(folder) == []
    assert "interrupted" in capsys.readouterr().err


@pytest.mark.parametrize("number", SIGNALS)
def test_interrupted_while_computing(number, tmp_path, monkeypatch, capsys):
    folder = written(tmp_path)
    act = at_call(200, lambda: signal.raise_signal(number), Watch.__call__)
    monkeypatch.setattr(Watch, "__call__", act)
    assert run(tmp_path) == 130
    assert names(folder) == SET
    assert complete(folder) is False
    stored = results.read(folder)
    assert len(stored.history) > 10
    assert stored.summary["t_final"] > 1.0
    assert "interrupted" in stored.summary["message"]
    assert "marked incomplete" in capsys.readouterr().err


def test_what_is_kept_is_what_a_shorter_run_computes(tmp_path, monkeypatch):
    folder = written(tmp_path)
    act = at_call(200, lambda: signal.raise_signal(signal.SIGINT), Watch.__call__)
    monkeypatch.setattr(Watch, "__call__", act)
    assert run(tmp_path) == 130
    kept = results.read(folder).history
    monkeypatch.undo()
    written(tmp_path, duration=1e5)
    whole = tmp_path / "whole"
    (tmp_path / "case.toml").write_text(
        ENDLESS.format(duration=float(kept["t"].iloc[-1]) + 1.0, avoiding_gap="false")
    )
    assert run(tmp_path, "--out", str(whole)) == 0
    longer = results.read(whole).history.iloc[: len(kept)]
    size = longer["u.deck"].abs().max()
    # Two runs of one tolerance, 1e-9, over a few periods.
    assert (kept["u.deck"] - longer["u.deck"]).abs().max() < 1e-6 * size


def test_a_second_signal_does_not_wait(tmp_path, monkeypatch):
    folder = written(tmp_path)

    def twice() -> None:
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Watch, "__call__", at_call(20, twice, Watch.__call__))
    assert run(tmp_path) == 130
    assert names(folder) == []


def test_interrupted_after_the_run_keeps_it(tmp_path, monkeypatch):
    """In the second run, which finds the gap that would have avoided the contact."""
    folder = written(tmp_path, 5.0, "true")

    def interrupted(scene: Scene, widened: Sequence[int], run: Callable[[Scene], object]) -> None:
        signal.raise_signal(signal.SIGTERM)
        run(scene)

    monkeypatch.setattr(eventpound.response, "avoiding_gaps", interrupted)
    assert run(tmp_path) == 130
    assert complete(folder) is False
    stored = results.read(folder)
    assert stored.summary["t_final"] == 5.0
    assert "the run is whole" in stored.summary["message"]


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize("at", [1, 4])
@pytest.mark.parametrize("step", ["_write_through", "replace"])
def test_interrupted_while_writing(step, at, number, tmp_path, monkeypatch):
    """A signal waits until the set is whole; an old one does not lose some of its files."""
    folder = written(tmp_path, 5.0)
    owner = Path if step == "replace" else eventpound.results.files
    act = at_call(at, lambda: signal.raise_signal(number), getattr(owner, step))
    monkeypatch.setattr(owner, step, act)
    assert run(tmp_path) == 130
    assert names(folder) == SET
    assert complete(folder) is True


BEGUN = """\
import sys
from eventpound.cli import main
from eventpound.cli.progress import Watch
called = Watch.__call__
def first(watch, t):
    print("computing", flush=True)
    Watch.__call__ = called
Watch.__call__ = first
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize(
    "number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.sweep)]
)
def test_a_process_of_its_own(number, tmp_path):
    folder = written(tmp_path, 1e7)
    (tmp_path / "case.toml").write_text(
        (tmp_path / "case.toml").read_text().replace('"0.1 s"', '"100 s"')
    )
    words = [sys.executable, "-c", BEGUN, "run", str(tmp_path), "--no-figures"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"computing\n"
        process.send_signal(number)
        _, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert b"Traceback" not in err
    assert complete(folder) is False


def test_time_limit(tmp_path, capsys):
    folder = written(tmp_path)
    assert run(tmp_path, "--time-limit", "0.05") == 1
    assert complete(folder) is False
    assert "time limit of 0.05 s" in capsys.readouterr().err
    assert "time limit" in results.read(folder).summary["message"]


@pytest.mark.parametrize("solver", ["fast", "moreau"])
def test_every_solver_hands_over_what_it_has(solver, tmp_path, monkeypatch):
    folder = written(tmp_path)
    act = at_call(3, lambda: signal.raise_signal(signal.SIGTERM), Watch.__call__)
    monkeypatch.setattr(Watch, "__call__", act)
    text = (tmp_path / "case.toml").read_text()
    steps = "" if solver == "fast" else '[solver]\ntime_step = "2 ms"\n'
    (tmp_path / "case.toml").write_text(text + steps)
    assert run(tmp_path, "--solver", solver) == 130
    assert complete(folder) is False
    stored = results.read(folder)
    assert 0.0 < stored.history["t"].iloc[-1] <= stored.summary["t_final"] < 1e5


def test_time_limit_that_is_not_reached(tmp_path):
    folder = written(tmp_path, 5.0)
    assert run(tmp_path, "--time-limit", "1000") == 0
    assert complete(folder) is True


def fixed_step(tmp_path: Path, solver: str) -> Path:
    """The endless case on a solver of fixed steps of 2 ms."""
    folder = written(tmp_path)
    case = tmp_path / "case.toml"
    case.write_text(case.read_text() + f'[solver]\nname = "{solver}"\ntime_step = "2 ms"\n')
    return folder


@pytest.mark.parametrize(
    ("solver", "steps"), [("moreau", 1), ("moreau", 777), ("moreau", 40_000), ("penalty", 777)]
)
def test_max_steps_of_fixed_length(solver, steps, tmp_path, capsys):
    """So many steps are taken and kept: their number is the time reached."""
    folder = fixed_step(tmp_path, solver)
    assert run(tmp_path, "--max-steps", str(steps)) == 1
    assert complete(folder) is False
    stored = results.read(folder)
    assert stored.summary["work"]["steps"] == steps
    # Equal steps: the step is 1e5 s over a whole number, 2 ms to 1e-7.
    assert stored.summary["t_final"] == pytest.approx(0.002 * steps, rel=1e-6)
    err = capsys.readouterr().err
    assert f"the limit of {steps} steps is reached" in err
    assert "at t = " in err


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
@pytest.mark.parametrize("steps", [1, 2, 300, 5000])
def test_max_steps_between_events(steps, solver, tmp_path, capsys):
    """No more than so many are taken, and as many but for the last of a batch."""
    folder = written(tmp_path)
    assert run(tmp_path, "--solver", solver, "--max-steps", str(steps)) == 1
    assert complete(folder) is False
    stored = results.read(folder)
    assert stored.summary["work"]["steps"] == steps
    assert f"the limit of {steps} steps is reached" in capsys.readouterr().err
    # Nothing in the record is later than the state that is kept with it.
    assert stored.history["t"].max() <= stored.summary["t_final"] < 1e5
    assert stored.events["t"].max() <= stored.summary["t_final"] or stored.events.empty


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_max_steps_that_just_suffice(solver, tmp_path):
    folder = written(tmp_path, 5.0)
    assert run(tmp_path, "--solver", solver) == 0
    steps = results.read(folder).summary["work"]["steps"]
    assert run(tmp_path, "--solver", solver, "--max-steps", str(steps)) == 0
    assert complete(folder) is True
    assert results.read(folder).summary["work"]["steps"] == steps
    assert run(tmp_path, "--solver", solver, "--max-steps", str(steps - 1)) == 1
    assert complete(folder) is False


def test_max_steps_of_a_solver_that_does_not_count(tmp_path, monkeypatch, capsys):
    from eventpound.solvers.moreau.solver import Moreau

    monkeypatch.setattr(Moreau, "counts_steps", False)
    folder = fixed_step(tmp_path, "moreau")
    assert run(tmp_path, "--max-steps", "5") == 2
    assert names(folder) == []
    assert "does not count its steps" in capsys.readouterr().err


@pytest.mark.parametrize("word", ["0", "-3", "1e6", "nan", "1.5", ""])
def test_max_steps_that_is_no_number(word, tmp_path, capsys):
    written(tmp_path)
    with pytest.raises(SystemExit) as ended:
        run(tmp_path, "--max-steps", word)
    assert ended.value.code == 2
    assert "a whole number from 1" in capsys.readouterr().err


def test_a_run_of_hours_says_so(tmp_path, monkeypatch, capsys):
    """In a world where every look at the clock finds a minute gone."""
    minutes = itertools.count()
    monkeypatch.setattr(progress.time, "monotonic", lambda: 60.0 * next(minutes))
    written(tmp_path)
    act = at_call(20, lambda: signal.raise_signal(signal.SIGINT), Watch.__call__)
    monkeypatch.setattr(Watch, "__call__", act)
    assert run(tmp_path) == 130
    err = capsys.readouterr().err
    assert err.count("at this rate") == 1
    assert "days" in err
    assert "--max-steps" in err


def test_forecast(monkeypatch, capsys):
    """A tenth of a run of 100 s in 10 s of wall time, then the rate falls tenfold."""
    now = [1000.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    of_run = progress.Forecast(50.0, 150.0)
    assert of_run.left(50.0) is None  # the clock starts here
    now[0] += 10.0
    assert of_run.left(60.0) == pytest.approx(90.0)
    of_run.warn(60.0)
    assert capsys.readouterr().err == ""
    now[0] += 90.0
    assert of_run.left(61.0) == pytest.approx(89.0 * 100.0 / 11.0)
    of_run.warn(61.0)
    of_run.warn(61.0)
    assert capsys.readouterr().err.count("0.11 of the run is done") == 1
    # A second run, as for avoiding_gap, is judged by its own rate.
    assert of_run.left(50.5) is None
    now[0] += 10.0
    assert of_run.left(52.5) == pytest.approx(97.5 * 10.0 / 2.0)


def test_handlers_are_as_before(tmp_path):
    before = [signal.getsignal(number) for number in SIGNALS]
    written(tmp_path, 5.0)
    assert run(tmp_path) == 0
    assert [signal.getsignal(number) for number in SIGNALS] == before


def test_full_disk(tmp_path, capsys):
    """A limit on the size of files stands for the end of the disk."""
    folder = written(tmp_path, 100.0)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limits[1]))
    try:
        assert run(tmp_path) == 2
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert names(folder) == []
    assert "cannot be written to: File too large" in capsys.readouterr().err


def test_full_disk_where_a_run_ended_early(tmp_path, monkeypatch, capsys):
    """What ended the run is reported with its code, and that nothing could be kept."""
    folder = written(tmp_path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(eventpound.results.files, "_write_through", full)
    assert run(tmp_path, "--time-limit", "0.05") == 1
    assert names(folder) == []
    err = capsys.readouterr().err
    assert "No space left on device" in err
    assert "time limit" in err
    assert "what was computed so far" not in err


def test_full_disk_while_figures_are_written(tmp_path, monkeypatch, capsys, undrawn):
    """The tables are whole and stay."""
    folder = written(tmp_path, 5.0)

    def full(path: Path, content: bytes) -> None:
        if path.name.endswith(f".png.{os.getpid()}.partial"):
            raise OSError(28, "No space left on device")
        write(path, content)

    write = eventpound.results.files._write_through
    monkeypatch.setattr(eventpound.results.files, "_write_through", full)
    assert main(["run", str(tmp_path)]) == 2
    assert names(folder) == SET
    assert complete(folder) is True
    assert "No space left on device" in capsys.readouterr().err


def test_a_place_where_nothing_can_be_written(tmp_path, capsys):
    """Where not even root may."""
    written(tmp_path, 1.0)
    assert run(tmp_path, "--out", "/proc/eventpound/results") == 2
    assert "/proc/eventpound/results: cannot be written to" in capsys.readouterr().err


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_results_without_permission(tmp_path, capsys):
    folder = written(tmp_path, 1.0)
    folder.mkdir(mode=0o500)
    assert run(tmp_path) == 2
    assert names(folder) == []
    assert "no permission" in capsys.readouterr().err


def test_a_record_that_vanishes(tmp_path, monkeypatch, capsys):
    from eventpound.case import record_file

    folder = written(tmp_path, 1.0)
    record = tmp_path / "made.AT2"
    record.write_text(at2(motion(60, 0.1), 0.1).text)
    case = tmp_path / "case.toml"
    rest = case.read_text().partition("[[body]]")[2]
    case.write_text('[excitation]\nkind = "record"\nfile = "made.AT2"\n[[body]]' + rest)
    monkeypatch.setattr(
        "eventpound.case.excitation.find_record",
        lambda *words: (record_file.find_record(*words), record.unlink())[0],
    )
    assert run(tmp_path) == 2
    assert names(folder) == []
    assert "made.AT2: the record cannot be read" in capsys.readouterr().err


WRITER = """\
import sys
from eventpound.results import write_together
for i in range(60):
    tag = f"{sys.argv[2]} {i}".encode()
    write_together(sys.argv[1], {name: tag for name in ("a", "b", "c", "d", "last")})
"""


def test_two_programs_that_write_the_same_results(tmp_path):
    """The set that stays is of one of them."""
    words = [sys.executable, "-c", WRITER, str(tmp_path)]
    both = [subprocess.Popen([*words, name]) for name in ("one", "other")]
    assert [process.wait(timeout=120) for process in both] == [0, 0]
    assert names(tmp_path) == ["a", "b", "c", "d", "last"]
    assert len({path.read_bytes() for path in tmp_path.iterdir()}) == 1


def test_compilation_says_nothing_of_the_time_left(monkeypatch):
    """The first minutes of a first run are those of the compiler."""
    now, compiled = [0.0], [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(
        progress.Stopwatch, "compilation", property(lambda _: compiled[0] if now[0] else 0.0)
    )
    of_run = progress.Forecast(0.0, 100.0)
    assert of_run.left(0.0) is None
    now[0], compiled[0] = 300.0, 299.0
    assert of_run.left(1.0) is None
    now[0] = 310.0
    assert of_run.left(11.0) == pytest.approx(89.0)
