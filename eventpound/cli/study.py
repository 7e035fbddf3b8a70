"""``eventpound study``: make the runs of a case with a ``[study]``, their table and figures."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, add_case, add_command, add_out, show_warnings
from eventpound.cli.progress import StudyProgress

if TYPE_CHECKING:
    from eventpound.study.engines.base import Engine
    from eventpound.study.reading import StudyCase

_ABOUT = """\
Results go to CASE/results: study.csv, a row a run; study.parquet where pyarrow is
installed; manifest.json; the figures of the case. A study that was stopped goes on
where it was when the command is given again; one whose case has changed begins
afresh. The table is the same to the last byte however it was computed.

The fast solver makes its runs in this process, on all cores; another solver in
processes of its own, one run at a time each. With --scheduler or --workers a Dask
cluster makes them: one that runs already, or one on this machine for this study.
"""


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "make all the runs of a case with a [study], their table and figures"
    study = add_command(commands, "study", _study, text, examples=_ABOUT)
    add_case(study)
    where = study.add_mutually_exclusive_group()
    where.add_argument("--processes", metavar="N", type=_count, help="N processes of this machine")
    where.add_argument("--workers", metavar="N", type=_count, help="N Dask workers on this machine")
    where.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, tcp://HOST:8786")
    add_out(study, "where the results go (CASE/results)")
    study.add_argument("--no-figures", action="store_true", help="write the table only")


def _count(text: str) -> int:
    """Read a number of processes."""
    try:
        count = int(text)
    except ValueError:
        count = 0
    if count < 1:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a whole number, at least 1")
    return count


def _study(options: argparse.Namespace) -> int:
    from eventpound.study.reading import load_study

    case = load_study(options.case)
    show_warnings(case.warnings)
    out = options.out or case.directory / "results"
    from eventpound.study.running import run_study

    engine = _engine(options, case.study.solver)
    progress = StudyProgress(case.study.size) if sys.stderr.isatty() else None
    try:
        moved = run_study(case.study, out, engine, progress)
    except KeyboardInterrupt:
        print("\neventpound: the same command goes on with the rest", file=sys.stderr)
        raise
    finally:
        if progress is not None:
            progress.clear()
    if moved is not None:
        print(f"moved     what was in {out} before is in {moved}")
    print(f"runs      {case.study.size}, {_failures(out)} failed")
    print(f"results   {out}")
    if (case.figures or case.intensities) and not options.no_figures:
        print("figures   " + ", ".join(_draw(case, out)))
    return 0


def _engine(options: argparse.Namespace, solver: str) -> Engine:
    """What computes the chunks, by the options and the solver."""
    if options.scheduler or options.workers:
        from eventpound.study.engines.cluster import Cluster

        return Cluster(options.scheduler, options.workers or 1)
    from eventpound.study.engines.local import engine_of

    return engine_of(solver, options.processes)


def _failures(out: Path) -> int:
    """Rows of the table that failed."""
    import csv

    from eventpound.study.table import MESSAGE, TABLE

    with (out / TABLE).open(newline="", encoding="utf-8") as file:
        return sum(1 for row in csv.DictReader(file) if row[MESSAGE])


def _draw(case: StudyCase, out: Path) -> list[str]:
    """Draw the figures of a study; their names."""
    from eventpound.report.study_files import draw

    return [path.name for path in draw(case, out)]
