"""Make all the runs of a case with a [study], their table and figures.

Results go to CASE/results: study.csv, a row a run; study.parquet where pyarrow is
installed; manifest.json; the figures of the case. A study that was stopped goes on
where it was when the command is given again; one whose case has changed begins
afresh. The table is the same to the last byte however it was computed.

The fast solver makes its runs in this process, on all cores; another solver in
processes of its own, one run at a time each. With --scheduler or --workers a Dask
cluster makes them: one that runs already, or one on this machine for this study.

Commands of two words tell more of it: "study sensitivities", "study spectrum" and "study
fragility" have their own --help.

Examples
--------
  eventpound study cases/figure-05
  eventpound study sensitivities cases/bridge-el-centro --of contacts.joint.max_impulse
  eventpound study spectrum cases/figure-05 --amplitude "0.4 g" --period "0.8 s"
  eventpound study fragility suite --measure L_e --demand peaks.deck.abs_max --limit "5 cm"
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli import arguments, fragility, sensitivities, spectrum
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.progress import Counter
from eventpound.cli.talk import going_on

if TYPE_CHECKING:
    from eventpound.study.engine import Engine


def add_study(commands: Commands) -> None:
    """Add the command to the parser."""
    study = add_command(commands, "study", _study, __doc__)
    study.case()
    study.out("where the results are or go (CASE/results)")
    study.option("--no-figures", "write the table only")
    study.exclusive()
    study.option("--processes N", "N processes of this machine", arguments.count_argument)
    study.option("--workers N", "N Dask workers on this machine", arguments.count_argument)
    study.option("--scheduler ADDRESS", "a Dask scheduler, tcp://HOST:8786")
    sensitivities.add_sensitivities(commands)
    spectrum.add_spectrum(commands)
    fragility.add_fragility(commands)


def _study(options: Options) -> int:
    from eventpound.study.running import run_study

    out, case = options.results, arguments.loaded_study(options.case)
    engine = _engine(options, case.study.solver)
    with going_on(), Counter("runs") as progress:
        moved = run_study(case.study, out, engine, progress)
    if moved is not None:
        print(f"moved     what was in {out} before is in {moved}")
    arguments.complain_of_scales(case.study.bases)
    print(f"runs      {case.study.size}, {_failures(out)} failed")
    print(f"results   {out}")
    if (case.figures or case.intensities) and not options.no_figures:
        from eventpound.report.study_files import draw

        print("figures   " + ", ".join(path.name for path in draw(case, out)))
    return 0


def _engine(options: Options, solver: str) -> Engine:
    """What computes the chunks, by the options and the solver."""
    if options.scheduler or options.workers:
        from eventpound.study.engine import Cluster

        return Cluster(options.scheduler, options.workers or 1)
    from eventpound.study.engine import engine_of

    return engine_of(solver, options.processes)


def _failures(out: Path) -> int:
    """Rows of the table that failed."""
    import csv

    from eventpound.study.forms import MESSAGE, TABLE

    with (out / TABLE).open(newline="", encoding="utf-8") as file:
        return sum(1 for row in csv.DictReader(file) if row[MESSAGE])
