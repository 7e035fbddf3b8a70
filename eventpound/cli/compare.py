r"""Report speed against error of solvers, and of other programs.

Run a case by several solvers at several tolerances or time steps, and by any other
program whose history is at hand, and report speed against error.

A solver's settings follow its name, NAME:key=value:key=value, as they stand in [solver];
`eventpound solvers` lists them. --rtol holds for solvers without a setting time_step,
--steps for those that have it.

A history has the columns of results/history.csv (t and u.<body>; v.<body> and z.<spring>
where known); --columns says what they are called in it, or their numbers. Impacts are read off the
velocities, unless X.events.csv (or events.csv beside history.csv) lists them.

Errors are held against the case's certificate.json where there is one, else against cvode
at rtol 1e-13, checked by the fast solver. Where contacts have laws of their own, columns
"rigid ..." hold the runs against Newton's law, too. What is measured: the page "compare"
of the documentation.

Examples
--------
  eventpound compare pulse
  eventpound compare pulse --solvers fast,cvode,cvode:method=BDF --rtol 1e-4,1e-6,1e-8
  eventpound compare pulse --solvers fast,moreau:theta=1 \
      --steps 0.01,0.001
  eventpound compare pulse --against other.csv --columns t=time,u.deck=disp1
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.progress import Doing
from eventpound.cli.talk import complain
from eventpound.errors import InputError
from eventpound.tolerances import COMPARED, REPEATS

if TYPE_CHECKING:
    from eventpound.accuracy.compare import Comparison
    from eventpound.scene.scene import Scene

_NO_SOLVER = "none"
_DEFAULT_RTOL = ",".join(f"{size:.0e}".replace("e-0", "e-") for size in COMPARED)


def add_compare(commands: Commands) -> None:
    """Add the command to the parser."""
    command = add_command(commands, "compare", _compare, __doc__)
    command.case()
    solvers = "with their settings (cvode,fast if it takes the scene; with --against none)"
    command.option("--solvers A,B,...", solvers)
    rtol, rtols = (
        f"relative tolerances ({_DEFAULT_RTOL})",
        arguments.comma_list(arguments.tolerance),
    )
    command.option("--rtol X,Y,...", rtol, rtols, default=_DEFAULT_RTOL)
    steps = arguments.comma_list(arguments.seconds)
    command.option("--steps X,Y,...", "time steps (s)", steps, default=[])
    command.option("--against CSV", "histories to judge", Path, nargs="+", default=[])
    command.option(
        "--columns OURS=THEIRS,...", "what their columns are called, or their numbers", default=""
    )
    count = arguments.count_argument
    command.option("--repeats N", f"the median of N counts ({REPEATS})", count, default=REPEATS)
    rigid = "of the rigid law beside contacts with laws of their own (what each stands for)"
    command.option("--restitution E", rigid, arguments.restitution)
    command.out("where the tables and the diagram go (CASE/comparison)")


def _columns(text: str) -> dict[str, str]:
    pairs = [pair.partition("=") for pair in text.split(",") if pair]
    wrong = ["".join(pair) for pair in pairs if not (pair[0] and pair[2])]
    if wrong:
        raise InputError(f"--columns: found {', '.join(wrong)}; accepted: u.deck=disp1,t=time")
    return {ours.strip(): theirs.strip() for ours, _, theirs in pairs}


def _chosen(
    words: str | None, against: bool, scene: Scene
) -> list[tuple[str, Mapping[str, object]]]:
    """Solvers that were asked for, else those that run the scene once and many times."""
    from eventpound.case.solver_options import default_solver, solver_words

    if words is None:
        ours = dict.fromkeys(default_solver([scene], many=many) for many in (False, True))
        words = _NO_SOLVER if against else ",".join(ours)
    if words.strip() != _NO_SOLVER:
        return solver_words(words)
    if not against:
        raise InputError("--solvers: found 'none'; accepted: that with --against CSV only")
    return []


def _compare(options: Options) -> int:
    columns = _columns(options.columns)
    case = arguments.loaded_case(options.case)
    chosen = _chosen(options.solvers, bool(options.against), case.scene)
    from eventpound.accuracy.compare import ComparisonInterrupted, entries, judge_entries
    from eventpound.results import check_writable

    out = options.out or case.directory / "comparison"
    check_writable(out)
    asked = entries(chosen, options.rtol, options.steps)
    try:
        with Doing() as doing:
            comparison = judge_entries(
                case,
                asked,
                options.against,
                columns,
                repeats=options.repeats,
                restitution=options.restitution,
                progress=doing,
            )
    except ComparisonInterrupted as interrupt:
        kept = interrupt.comparison
        _write(kept, out)
        total = len(asked) + len(options.against)
        complain(f"{len(kept.runs)} of {total} runs are in {out}")
        raise
    _write(comparison, out)
    return 0


def _write(comparison: Comparison, out: Path) -> None:
    """Write the tables and the diagram, and print the table of the runs."""
    from eventpound.accuracy.comparison_tables import text_table
    from eventpound.report.compared import comparison_files
    from eventpound.results import write_together

    write_together(out, comparison_files(comparison))
    print(text_table(comparison), end="")
    print(f"\nresults   {out}")
