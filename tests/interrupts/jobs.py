"""What is interrupted: commands of the command line and calls of the package."""

import shutil
import threading
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

CASE = """
body = [{{ name = "left", mass = "1301 t" }}, {{ name = "right", mass = "3210 t" }}]
contact = [{{ between = ["left", "right"], name = "joint", gap = "1 cm", restitution = 0.6 }}]
[excitation]
kind = "record"
file = "record.txt"
units = "m/s2"
time_step = "0.02 s"
[run]
duration = "{duration}"
[[spring]]
between = ["ground", "left"]
name = "frame1"
law = "bouc-wen"
initial_stiffness = "233443 kN/m"
yield_force = "3621 kN"
hardening = 0.05
[[spring]]
between = ["ground", "right"]
name = "frame2"
law = "bouc-wen"
initial_stiffness = "101048 kN/m"
yield_force = "3794 kN"
hardening = 0.05
"""
STUDY = """
[solver]
name = "{solver}"
rtol = 1e-10

[study]
quantities = ["peaks.left.abs_max", "impacts"]
[[study.axis]]
key = "contact.joint.gap"
from = "0.5 cm"
to = "3 cm"
count = {count}
"""
FIGURE = """
[figure]
name = "peaks"
x = "contact.joint.gap"
y = "peaks.left.abs_max"
"""
INTERRUPTED = 130


class Job(NamedTuple):
    """One thing to interrupt.

    command: a command of the command line, or a call of the package. solver: by which solver.
    do: does it in a folder, and returns an exit code.
    """

    command: str
    solver: str
    do: Callable[[Path], int]


def prepare(folder: Path) -> None:
    """Write the cases: a record of 15 s, two yielding structures that pound."""
    t = 0.02 * np.arange(750)
    shaking = np.exp(-((t - 5.0) ** 2) / 8.0) * np.random.default_rng(7).standard_normal(t.size)
    for name, study in (
        ("case", ""),
        ("study-fast", STUDY.format(solver="fast", count=3000)),
        ("study-cvode", STUDY.format(solver="cvode", count=12)),
    ):
        made = folder / name
        made.mkdir(parents=True)
        np.savetxt(made / "record.txt", 9.0 * shaking)
        (made / "case.toml").write_text(CASE.format(duration="15 s") + study)
    drawn = folder / "drawn" / "study"
    drawn.mkdir(parents=True)
    np.savetxt(drawn / "record.txt", 9.0 * shaking)
    study = STUDY.format(solver="fast", count=300) + FIGURE
    (drawn / "case.toml").write_text(CASE.format(duration="15 s") + study)
    records = folder / "case" / "records"
    records.mkdir()
    for i in range(4):
        np.savetxt(records / f"{i}.txt", (2.0 + i) * shaking)


def _command(*words: str) -> Callable[[Path], int]:
    """A command; its first word after the name is a folder or file of those prepared."""

    def do(folder: Path) -> int:
        from eventpound.cli import main

        return main([words[0], str(folder / words[1]), *words[2:]])

    return do


def _call(solver: str, **options: object) -> Callable[[Path], int]:
    """`simulate` from Python."""

    def do(folder: Path) -> int:
        from eventpound import load_case, simulate

        simulate(load_case(folder / "case"), solver, 1e-11, **options)
        return 0

    return do


def _many(folder: Path) -> int:
    from eventpound import load_case, simulate_many

    gaps = np.linspace(0.005, 0.03, 3000)
    simulate_many(load_case(folder / "case"), {"contact.joint.gap": gaps}, rtol=1e-9)
    return 0


def _suite(folder: Path) -> int:
    from eventpound.cli import main

    records = str(folder / "case" / "records" / "*.txt")
    return main(["run", str(folder / "case"), "--suite", records, "--no-figures"])


def _study(name: str) -> Callable[[Path], int]:
    """A study, which goes on from where an interrupt left it."""

    def do(folder: Path) -> int:
        from eventpound.cli import main

        results = folder / name / "results"
        if (results / "manifest.json").exists():
            shutil.rmtree(results)
        return main(["study", str(folder / name), "--no-figures"])

    return do


def _figures(folder: Path) -> int:
    from eventpound.cli import main

    shutil.rmtree(folder / "figures", ignore_errors=True)
    return main(["plot", str(folder / "drawn"), "--out", str(folder / "figures")])


def _certify(folder: Path) -> int:
    from eventpound import load_case, verify

    verify(load_case(folder / "case"), 1e-11)
    return 0


def _in_a_thread(solver: str) -> Callable[[Path], int]:
    """`simulate` in another thread, which an interrupt of the main one must leave alone."""

    def do(folder: Path) -> int:
        failed: list[BaseException] = []

        def work() -> None:
            try:
                _call(solver)(folder)
            except BaseException as error:
                failed.append(error)

        thread = threading.Thread(target=work)
        thread.start()
        interrupted = False
        while thread.is_alive():
            try:
                thread.join()
            except KeyboardInterrupt:
                interrupted = True
        if failed:
            raise RuntimeError("the other thread failed") from failed[0]
        return INTERRUPTED if interrupted else 0

    return do


def _through_scikit_sundae(folder: Path) -> int:
    """The fallback of cvode, whose callbacks run Python."""
    from eventpound import load_case
    from eventpound.simulation import task_of
    from eventpound.solvers.events.loop import EventLoop
    from eventpound.solvers.sundials.wrapped import WrappedCvode

    task = task_of(load_case(folder / "case"), 1e-6)
    EventLoop(task, WrappedCvode(task.rtol, "Adams")).run()
    return 0


STEP = {"settings": {"time_step": 1e-4}}
JOBS = (
    Job("verify", "all", _command("verify", "case", "--no-figures")),
    Job("compare", "cvode", _command("compare", "case", "--solvers", "cvode")),
    Job("compare", "ida", _command("compare", "case", "--solvers", "ida")),
    Job("compare", "fast", _command("compare", "case", "--solvers", "fast")),
    Job("run", "cvode", _command("run", "case", "--rtol", "1e-12", "--no-figures")),
    Job("run", "ida", _command("run", "case", "--solver", "ida", "--no-figures")),
    Job("run", "fast", _command("run", "case", "--solver", "fast")),
    Job("run", "penalty", _command("run", "case", "--solver", "penalty", "--no-figures")),
    Job("run --suite", "fast", _suite),
    Job("study", "fast", _study("study-fast")),
    Job("study", "cvode", _study("study-cvode")),
    Job("record", "none", _command("records", "case/record.txt", "--units", "m/s2",
                                   "--time-step", "0.02")),
    Job("figures", "fast", _figures),
    Job("verify()", "all", _certify),
    Job("simulate", "cvode", _call("cvode")),
    Job("simulate", "cvode, scikit-sundae", _through_scikit_sundae),
    Job("simulate", "ida", _call("ida")),
    Job("simulate", "fast", _call("fast")),
    Job("simulate", "moreau", _call("moreau", **STEP)),
    Job("simulate", "penalty", _call("penalty", **STEP)),
    Job("simulate, thread", "cvode", _in_a_thread("cvode")),
    Job("simulate, thread", "ida", _in_a_thread("ida")),
    Job("simulate_many", "fast", _many),
)  # fmt: skip
