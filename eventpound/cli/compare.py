"""``eventpound compare``: speed against error of solvers and of other programs."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, add_case, add_command, add_out, load, tolerance
from eventpound.cli.talk import say
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.accuracy.compare import Comparison

_TEXT = """\
Run a case by several solvers at several tolerances or time steps, and by any other
program whose history is at hand, and report speed against error.
"""
_EXAMPLES = """\
examples:
  eventpound compare pulse
  eventpound compare pulse --solvers fast,cvode,cvode:method=BDF --rtol 1e-4,1e-6,1e-8
  eventpound compare pulse --solvers fast,penalty:contact=hertz:contact_stiffness=1e9 \\
      --steps 0.01,0.001
  eventpound compare pulse --against other.csv --columns t=time,u.deck=disp1

A solver's settings follow its name, NAME:key=value:key=value, as they stand in [solver];
`eventpound solvers` lists them. --rtol holds for solvers without a setting time_step,
--steps for those that have it.

A history has the columns of results/history.csv (t and u.<body>; v.<body> and z.<spring>
where known); --columns says what they are called in it. Impacts are read off the
velocities, unless X.events.csv (or events.csv beside history.csv) lists them.

Errors are held against the case's certificate.json where there is one, else against cvode
at rtol 1e-13, checked by the fast solver. Where contacts have laws of their own, columns
"rigid ..." hold the runs against Newton's law, too. What is measured: docs/compare.md.
"""
_NO_SOLVER = "none"
_DEFAULT_SOLVERS, _DEFAULT_RTOL = "cvode,fast", "1e-4,1e-6,1e-8,1e-10"


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    compare = add_command(
        commands, "compare", _compare, "report speed against error of solvers", _TEXT, _EXAMPLES
    )
    add_case(compare)
    compare.add_argument(
        "--solvers",
        metavar="A,B,...",
        help=f"solvers with their settings ({_DEFAULT_SOLVERS}; with --against it may be the word "
        "none, which is then the default)",
    )
    compare.add_argument(
        "--rtol",
        metavar="X,Y,...",
        type=_list_of(tolerance),
        default=_DEFAULT_RTOL,
        help=f"relative tolerances ({_DEFAULT_RTOL})",
    )
    compare.add_argument(
        "--steps", metavar="X,Y,...", type=_list_of(_step), default=[], help="time steps (s)"
    )
    compare.add_argument(
        "--against", metavar="CSV", type=Path, nargs="+", default=[], help="histories to judge"
    )
    compare.add_argument(
        "--columns", metavar="OURS=THEIRS,...", default="", help="what their columns are called"
    )
    compare.add_argument(
        "--repeats", metavar="N", type=_count, default=5, help="runs of which the median counts (5)"
    )
    compare.add_argument(
        "--restitution",
        metavar="E",
        type=_restitution,
        help="of the rigid law beside contacts with laws of their own (what each stands for)",
    )
    add_out(compare, "where the tables and the diagram go (CASE/comparison)")


def _list_of(read: Callable[[str], float]) -> Callable[[str], list[float]]:
    def several(text: str) -> list[float]:
        return [read(word) for word in text.split(",")]

    return several


def _step(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (0.0 < value < math.inf):
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: positive times (s)")
    return value


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a whole number from 1")
    return int(text)


def _restitution(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (0.0 <= value <= 1.0):
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a number from 0 to 1")
    return value


def _columns(text: str) -> dict[str, str]:
    pairs = [pair.partition("=") for pair in text.split(",") if pair]
    wrong = ["".join(pair) for pair in pairs if not (pair[0] and pair[2])]
    if wrong:
        raise InputError(f"--columns: found {', '.join(wrong)}; accepted: u.deck=disp1,t=time")
    return {ours.strip(): theirs.strip() for ours, _, theirs in pairs}


def _chosen(words: str | None, against: bool) -> list[tuple[str, Mapping[str, object]]]:
    """Solvers that were asked for."""
    from eventpound.case.solver_words import solver_words

    if words is None:
        words = _NO_SOLVER if against else _DEFAULT_SOLVERS
    if words.strip() != _NO_SOLVER:
        return solver_words(words)
    if not against:
        raise InputError("--solvers: found 'none'; accepted: that with --against CSV only")
    return []


def _compare(options: argparse.Namespace) -> int:
    chosen = _chosen(options.solvers, bool(options.against))
    columns = _columns(options.columns)
    case = load(options.case)
    from eventpound.accuracy.compare import ComparisonInterrupted, compare, entries
    from eventpound.results import check_writable

    out = options.out or case.directory / "comparison"
    check_writable(out)
    asked = entries(chosen, options.rtol, options.steps)
    try:
        comparison = compare(
            case,
            asked,
            options.against,
            columns,
            repeats=options.repeats,
            restitution=options.restitution,
            progress=_say,
        )
    except ComparisonInterrupted as interrupt:
        kept = interrupt.comparison
        _say("")
        _write(kept, out)
        total = len(asked) + len(options.against)
        print(f"eventpound: {len(kept.runs)} of {total} runs are in {out}", file=sys.stderr)
        raise
    _say("")
    _write(comparison, out)
    return 0


def _write(comparison: Comparison, out: Path) -> None:
    """Write the tables and the diagram, and print the table of the runs."""
    from eventpound.accuracy.comparison_tables import table_files, text_table
    from eventpound.report.comparison_page import comparison_page
    from eventpound.report.html import PAGE
    from eventpound.report.work_precision import timed, work_precision_png
    from eventpound.results import write_together

    diagram = {"work-precision.png": work_precision_png(comparison)} if timed(comparison) else {}
    tables = table_files(comparison)
    page = {PAGE: comparison_page(comparison, tables)}
    write_together(out, diagram | tables | page)
    print(text_table(comparison), end="")
    print(f"\nresults   {out}")


def _say(what: str) -> None:
    """Say what is being done, on a terminal."""
    if what:
        say(what)
    if sys.stderr.isatty():
        print(f"\r\033[K{what}", end="", file=sys.stderr, flush=True)
