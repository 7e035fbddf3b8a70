"""Compute a case, write its results and figures.

Examples
--------
  eventpound run pulse
  eventpound run pulse --solver cvode:method=BDF --rtol 1e-11 --out fine
  eventpound run pulse --suite "folder/*.AT2"     a row a record, a line on what failed
  eventpound run pulse --export matrices          for another program; computes nothing
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.progress import Progress, Watch
from eventpound.cli.suite_run import run_and_tell_suite
from eventpound.cli.talk import complain, tell_step
from eventpound.errors import ComputationError, InputError

if TYPE_CHECKING:
    from eventpound.case import Case
    from eventpound.response import Response

_WORTH_A_LINE = 2.0
"""Seconds of compilation; kept kernels take less to load."""
_DEMANDS = {
    "contacts.<>.largest_gap": ("opening", "m"),
    "contacts.<>.seat_used": ("seat", "m"),
    "contacts.<>.max_impulse": ("impulse", "N s"),
    "springs.<>.ductility": ("ductility", ""),
    "springs.<>.stiffness_lost": ("stiffness lost", ""),
    "springs.<>.slip_path": ("slip path", "m"),
    "springs.<>.passive_force": ("passive force", "N"),
    "springs.<>.residual_gap": ("residual gap", "m"),
}
"""Quantities of contacts and springs that are printed: words and units (SI)."""
_MOST_DEMANDS = 12
"""Contacts and springs with a line."""


def add_run(commands: Commands) -> None:
    """Add the command to the parser."""
    run = add_command(commands, "run", _run, __doc__)
    run.case()
    solver = "instead of the case's own, perhaps with settings: moreau:theta=1"
    run.option("--solver NAME[:KEY=VALUE...]", solver)
    run.option("--rtol X", "relative tolerance, instead of the case's own", arguments.tolerance)
    run.out("where the results go (CASE/results)")
    estimate = "estimate the error by a second run, whatever it costs; of every record of a suite"
    run.option("--error-estimate", estimate)
    ends = "end the computation after so {}, keep what there is, marked incomplete"
    run.option("--time-limit SECONDS", ends.format("long"), arguments.seconds)
    run.option("--max-steps N", ends.format("many steps"), arguments.count_argument)
    run.option("--no-figures", "write the tables only")
    run.group("a case with a suite of records")
    files = 'other records: "folder/*.AT2", in quotes, or a list of files (CSV, column file)'
    run.option("--suite FILES", files)
    run.option("--histories", "write the results of every record, too")
    run.group("other programs")
    run.option("--export DIR", "write matrices and motion there, and compute nothing", Path)


def _run(options: Options) -> int:
    if options.export is not None:
        return _export(options)
    one, suite = partial(_run_one, options), partial(_run_suite, options)
    return arguments.by_kind(options.case, one, suite=suite, records=options.suite)


def _in_file(options: Options) -> bool:
    """Whether the solver and its tolerance are those of the file."""
    return options.solver is None and options.rtol is None


def _run_suite(options: Options, case: Case) -> int:
    from eventpound.results import check_writable

    case, told = _with_solver(case, options), arguments.file_of(case) if _in_file(options) else ""
    check_writable(options.results)
    why = "is for a single run; this case has a suite of records"
    options.refuse(["--time-limit", "--max-steps"], why)
    return run_and_tell_suite(case, options, options.results, told)


def _run_one(options: Options, case: Case) -> int:
    from eventpound.results import check_writable

    case, out = _with_solver(case, options), options.results
    arguments.check_solver_of(case, _in_file(options))
    check_writable(out)
    options.refuse(["--histories"], "is for a case with a suite of records")
    response, estimate = _compute(case, options, out)
    print("\n".join(_summary(response)))
    _say(estimate)
    print(f"results   {out}")
    if not options.no_figures:
        from eventpound.report.run_figures import plot

        tell_step("draw the figures")
        # The same without contact was computed where its numbers are asked for.
        free = vars(response).get("without_contact")
        beside = None if free is None else (free, "without contact")
        drawn = plot(out, out, beside=beside, pi=case.pi is not None)
        print("figures   " + ", ".join(path.name for path in drawn))
    return 0


def _export(options: Options) -> int:
    """Write matrices and motion for other programs."""
    options.refuse_others("--export", "is not for --export, which computes nothing")
    from eventpound.results import export

    export(arguments.loaded_case(options.case), options.export)
    print(f"wrote {options.export}")
    return 0


def _with_solver(case: Case, options: Options) -> Case:
    """The case with the solver and the tolerance of the command line."""
    from eventpound.case.solver_options import solver_given

    given = solver_given(case.solver, options.solver, options.rtol, "--solver")
    return replace(case, solver=given)


def _compute(case: Case, options: Options, out: Path) -> tuple[Response, dict[str, Any] | None]:
    """Compute what is asked for and write it; where it ends early, what there is of it."""
    from eventpound import results
    from eventpound.accuracy.estimate import estimate_of
    from eventpound.simulation import response_of

    started = datetime.now(UTC)
    bounded = options.time_limit is not None or options.max_steps is not None
    response = estimate = None
    try:
        progress = Progress(case)
        shows = [progress] if bounded else [progress, progress.forecast.warn]
        with progress, Watch(options.time_limit, *shows) as watch:
            tell_step(f"solve by {case.solver.name}, rtol {case.solver.rtol:g}")
            response = response_of(case, progress=watch, max_steps=options.max_steps)
            tell_step(f"solved: {response.message}, {response.work.steps} steps")
            # Computed here, where it can be interrupted; kept with the response.
            progress.begins("again, for the quantities named")
            _ = response.named, response.shock_rows
            progress.begins("again, for the error")
            asked = True if options.error_estimate else case.run.error_estimate
            estimate = estimate_of(response, asked=asked, progress=watch)
    except (ComputationError, KeyboardInterrupt) as error:
        _keep_partial(case, error, response, out)
        raise
    tell_step(f"write results to {out}")
    results.write(response, out, case=case, error_estimate=estimate, started=started)
    arguments.show_warnings(response.warnings)
    return response, estimate


def _say(estimate: dict[str, Any] | None) -> None:
    """The largest error in a line, and warnings."""
    if estimate is None:
        return
    from eventpound.accuracy.judge import error_words

    print(f"error     {error_words(estimate)}")
    arguments.show_warnings(estimate.get("warnings", ()))


def _keep_partial(case: Case, error: BaseException, response: Response | None, out: Path) -> None:
    """Write what a run that ended early had computed, marked incomplete."""
    if response is not None:
        why = f"the run is whole, what follows it is not: {error or 'interrupted'}"
        recording = replace(response.recording, success=False, message=why)
    elif isinstance(error, ComputationError) and error.recording is not None:
        recording = error.recording
    else:
        complain("nothing was computed that could be kept")
        return
    from eventpound import results
    from eventpound.case.run_options import DEFAULTS
    from eventpound.response import Response
    from eventpound.simulation import task_of

    try:
        # Named quantities would take further runs.
        stated = replace(DEFAULTS, events=case.run.stated.events)
        partial = Response(task_of(case), case.solver.name, recording, stated=stated)
        results.write(partial, out, case=case)
    except InputError as unwritten:
        # What ended the run is what gets reported.
        complain(f"{unwritten}")
        return
    complain(f"what was computed so far is in {out}, marked incomplete")


def _summary(response: Response) -> Iterator[str]:
    """Contacts and what they need, peaks and cost of a run, to be read."""
    from eventpound.quantities.decks import rotation_of, translates
    from eventpound.results.tables import aligned

    recording, scene = response.recording, response.scene
    if scene.contacts:
        resting = float(sum(recording.resting_time))
        # Some solvers do not know it.
        rested = "" if math.isnan(resting) else f"; resting {resting:.4f} s in all contacts"
        faster = response.runs.contact_numbers.impacts_faster.sum()
        counted = f"{response.impacts}, {faster:.0f} {response.stated.faster}"
        yield f"impacts   {counted}{rested}"
    yield from _demands(response)
    x = recording.displacement
    moved = [(b.name, x.at(i)) for i, b in enumerate(scene.bodies) if translates(scene, i)]
    turned = [(d.name, rotation_of(response.runs, i).at((0, 0))) for i, d in enumerate(scene.decks)]
    for kind, unit, found in (("body", "m", moved), ("deck", "rad", turned)):
        rows = [
            (name, f"{e.maximum:.6e}", f"{e.time_of_maximum:.4f}", f"{e.minimum:.6e}",
             f"{e.time_of_minimum:.4f}")
            for name, e in found
        ]  # fmt: skip
        if rows:
            yield aligned((kind, f"max ({unit})", "at (s)", f"min ({unit})", "at (s)"), rows, {0})
    for shock in response.shock_rows:
        told = shock["failed"]
        if not told:
            peak = max(shock[f"peaks.{body.name}.abs_max"] for body in scene.bodies)
            told = f"largest |u| {peak:.6e} m, {shock['impacts']:.0f} impacts"
        of = f", {shock['record']} times {shock['scale']:.3g}" if "record" in shock else ""
        yield f"shock {shock['shock']:<3} from {shock['start']:.6g} s{of}: {told}"
    work = response.work
    by = f"({response.solver}, rtol {response.task.rtol:g})"
    yield f"work      {work.steps} steps, {work.rhs} right-hand sides, {work.seconds:.3f} s {by}"
    if work.compilation >= _WORTH_A_LINE:
        yield f"compiled  {work.compilation:.0f} s, not needed by later runs"


def _demands(response: Response) -> Iterator[str]:
    """What contacts and yielding springs need, a line each, in units of the trade."""
    from eventpound.results.shown_units import units_of_scene

    units, numbers = units_of_scene(response.scene, response.stated), response.numbers()
    parts: dict[str, list[str]] = {}
    for path, (word, unit) in _DEMANDS.items():
        kind, _, quantity = path.partition(".<>.")
        for name, value in numbers.items():
            owner = name.removeprefix(f"{kind}.").removesuffix(f".{quantity}")
            if name == f"{kind}.{owner}.{quantity}" and value is not None:
                parts.setdefault(owner, []).append(f"{word} {units.words(abs(value), unit, name)}")
    shown = list(parts.items())[:_MOST_DEMANDS]
    yield from (f"{owner:<16} {', '.join(texts)}" for owner, texts in shown)
    if len(parts) > len(shown):
        yield f"{'':<16} and {len(parts) - len(shown)} more; `eventpound report` has all"
