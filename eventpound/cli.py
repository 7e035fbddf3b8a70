"""The command line: words to calls.

Exit codes: 0 done; 1 the computation failed; 2 the input is wrong (one message
on stderr, nothing written); 130 interrupted. Everything but the standard
library is imported by the command that needs it.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.errors import ComputationError, InputError

if TYPE_CHECKING:
    from eventpound.case import Case
    from eventpound.response import Response

_EXAMPLE = """\
an example:
  eventpound new pulse           write a commented case, pulse/case.toml, that runs
  eventpound check pulse         read it and say what was understood or is wrong
  eventpound run pulse           compute it; results and figures go to pulse/results/
  eventpound run pulse --rtol 1e-11 --out fine
  eventpound plot pulse          draw the figures again from pulse/results/

A case is a directory with a case.toml and the files of its records.
Exit codes: 0 done, 1 the computation failed, 2 the input is wrong, 130 interrupted.
"""
_INTERRUPTED = 130
_SECONDS_BETWEEN_REPORTS = 0.2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after ``eventpound``; those of the process by default.

    Returns
    -------
    int
        Exit code.
    """
    options = _parser().parse_args(arguments)
    try:
        command: Callable[[argparse.Namespace], int] = options.command
        return command(options)
    except (InputError, ComputationError) as error:
        print(f"eventpound: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        print("eventpound: interrupted", file=sys.stderr)
        return _INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="eventpound",
        description="Earthquake response of structures that collide, every impact located.",
        epilog=_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    run = _add(commands, "run", _run, "compute a case, write its results and figures")
    _add_case(run)
    run.add_argument("--solver", help="the solver, instead of the case's own")
    run.add_argument(
        "--rtol", type=_tolerance, help="relative tolerance, instead of the case's own"
    )
    _add_out(run, "where the results go (CASE/results)")
    run.add_argument("--no-figures", action="store_true", help="write the tables only")

    check = _add(commands, "check", _check, "read a case and say what was understood or is wrong")
    _add_case(check)

    new = _add(commands, "new", _new, "write a commented case that runs")
    new.add_argument("directory", metavar="DIR", type=Path, help="made where it is missing")

    plot = _add(commands, "plot", _plot, "draw the figures of results on disk")
    _add_case(plot)
    _add_out(plot, "where the results are and the figures go (CASE/results)")

    _add(commands, "solvers", _solvers, "list the solvers and their settings")

    export = _add(commands, "export", _export, "write matrices and motion for other programs")
    _add_case(export)
    _add_out(export, "where they go (CASE/export)")
    return parser


def _add(
    commands: argparse._SubParsersAction[argparse.ArgumentParser],
    name: str,
    command: Callable[[argparse.Namespace], int],
    text: str,
) -> argparse.ArgumentParser:
    parser = commands.add_parser(name, help=text, description=text)
    parser.set_defaults(command=command)
    return parser


def _add_case(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("case", metavar="CASE", type=Path, help="directory of the case")


def _add_out(parser: argparse.ArgumentParser, text: str) -> None:
    parser.add_argument("--out", metavar="DIR", type=Path, help=text)


class _Version(argparse.Action):
    """Print the version; looked up only when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"eventpound {version('eventpound')}")
        parser.exit()


def _tolerance(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < 1.0:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a number between 0 and 1")
    return value


def _load(path: Path) -> Case:
    """Load a case and show its warnings."""
    from eventpound.case import load_case

    case = load_case(path)
    for warning in case.warnings:
        print(f"eventpound: warning: {warning}", file=sys.stderr)
    return case


def _run(options: argparse.Namespace) -> int:
    case = _load(options.case)
    out = options.out or case.directory / "results"
    from eventpound import results

    results.check_writable(out)
    from eventpound.simulation import avoiding_gaps, simulate

    _announce_compilation(options.solver or case.solver.name)
    started = datetime.now(UTC)
    progress = _Progress(case) if sys.stderr.isatty() else None
    try:
        response = simulate(case, solver=options.solver, rtol=options.rtol, progress=progress)
    except ComputationError as error:
        _keep_partial(case, error, options, out)
        raise
    finally:
        if progress is not None:
            progress.clear()
    gaps = avoiding_gaps(case, options.rtol) if case.run.avoiding_gap else None
    results.write(response, out, case=case, avoiding_gap=gaps, started=started)
    print(_summary(response))
    print(f"results   {out}")
    if not options.no_figures:
        from eventpound.report import plot

        print("figures   " + ", ".join(path.name for path in plot(out, out)))
    return 0


def _announce_compilation(solver: str) -> None:
    """Say that the first run compiles, where no function of the solver is kept compiled."""
    from eventpound.solvers import solver_named

    kernels = Path(__file__).parent / "solvers" / solver_named(solver).kernels / "__pycache__"
    if not any(kernels.glob("*.nbi")):
        print(
            "eventpound: compiling for the first run, half a minute to two minutes", file=sys.stderr
        )


def _keep_partial(
    case: Case, error: ComputationError, options: argparse.Namespace, out: Path
) -> None:
    """Write what a failed run had computed, marked incomplete."""
    if error.recording is None:
        return
    from eventpound import results
    from eventpound.response import Response
    from eventpound.simulation import task_of

    task = task_of(case, rtol=options.rtol)
    solver = options.solver or case.solver.name
    results.write(Response(task, solver, error.recording), out, case=case)
    print(f"eventpound: what was computed so far is in {out}, marked incomplete", file=sys.stderr)


class _Progress:
    """The share of a run that is done, on one line of a terminal."""

    def __init__(self, case: Case) -> None:
        self._start, self._duration = case.run.start_time, case.run.duration
        self._last = -math.inf

    def __call__(self, t: float) -> None:
        now = time.monotonic()
        if now - self._last >= _SECONDS_BETWEEN_REPORTS:
            self._last = now
            share = (t - self._start) / self._duration
            print(f"\r{share:5.0%}  t = {t:.3f} s ", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Take the line away."""
        print("\r\033[K", end="", file=sys.stderr, flush=True)


def _summary(response: Response) -> str:
    """Peaks, contacts and cost of a run, to be read."""
    recording, scene = response.recording, response.scene
    lines = [f"{'body':<16} {'max (m)':>14} {'at (s)':>10} {'min (m)':>14} {'at (s)':>10}"]
    x = recording.displacement
    for i, body in enumerate(scene.bodies):
        lines.append(
            f"{body.name:<16} {x.maximum[i]:>14.6e} {x.time_of_maximum[i]:>10.4f} "
            f"{x.minimum[i]:>14.6e} {x.time_of_minimum[i]:>10.4f}"
        )
    if scene.contacts:
        resting = float(sum(recording.resting_time))
        lines.append(f"impacts   {response.impacts}; resting {resting:.4f} s in all contacts")
    work = response.work
    lines.append(
        f"work      {work.steps} steps, {work.rhs} right-hand sides, {work.seconds:.3f} s "
        f"({response.solver}, rtol {response.task.rtol:g})"
    )
    return "\n".join(lines)


def _check(options: argparse.Namespace) -> int:
    case = _load(options.case)
    scene, run = case.scene, case.run
    counts = {
        "bodies": scene.bodies,
        "springs": scene.springs,
        "dashpots": scene.dashpots,
        "contacts": scene.contacts,
    }
    print(f"case      {case.title}")
    print("scene     " + ", ".join(f"{what}: {len(some)}" for what, some in counts.items()))
    scales = scene.motion.scales()
    sizes = "" if scales is None else f", a_g = {scales.a_g:.6g} m/s^2, T_g = {scales.period:.6g} s"
    print(f"motion    {scene.motion.kind}{sizes}")
    print(
        f"run       {run.start_time:g} to {run.start_time + run.duration:.6g} s, "
        f"a row every {run.output_step:.6g} s"
    )
    print(f"solver    {case.solver.name}, rtol {case.solver.rtol:g}")
    return 0


def _new(options: argparse.Namespace) -> int:
    from eventpound.case import write_template

    print(f"wrote {write_template(options.directory)}")
    return 0


def _plot(options: argparse.Namespace) -> int:
    from eventpound.report import plot

    out = options.out or options.case / "results"
    for path in plot(out, out):
        print(path)
    return 0


def _solvers(_: argparse.Namespace) -> int:
    from eventpound.solvers import available

    for name, solver in available().items():
        print(f"{name:<10} {solver.summary}")
        for key, meaning in solver.settings.items():
            print(f"{'':<10}   {key}: {meaning}")
    return 0


def _export(options: argparse.Namespace) -> int:
    case = _load(options.case)
    from eventpound.results import export

    out = options.out or case.directory / "export"
    export(case, out)
    print(f"wrote {out}")
    return 0
