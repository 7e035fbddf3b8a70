r"""Make all the runs of a case with a [study], their table and figures.

Results go to CASE/results: study.csv, a row a run; study.parquet where pyarrow is
installed; manifest.json; the figures of the case. A study that was stopped goes on
where it was when the command is given again; one whose case has changed begins
afresh. The table is the same to the last byte however it was computed.

The fast solver makes its runs in this process, on all cores; another solver in
processes of its own, one run at a time each. With --scheduler or --workers a Dask
cluster makes them: one that runs already, or one on this machine for this study.

--sensitivities, of any case: how quantities follow its numbers, one at a time. Each number is
varied by 1e-5 of itself; derivatives have an error, and a note where there is none because an
impact comes or goes. Files: sensitivities.csv, sensitivities.png (per cent for one per cent).

With --spectrum or --fragility no runs are made: the finished table is taken.

--spectrum, of a study in Π-terms, which holds for every amplitude and period of its pulse:
spectrum.csv has its rows in dimensions: T_s (s) or Q/m (m/s²), gap and yield displacement
(m), and u_max (m); the figures of the case are drawn in them, too. Other columns stay those of
the pulse of the study.

--fragility, of a study or of a suite: lognormal curves, the probability that a demand
exceeds a limit, over an intensity, by maximum likelihood. Of a study that scales each
record through intensities, the capacity of each record is found, and a record that never
exceeds the limit is censored at its largest intensity. Of a suite, or with --counts, runs
are counted. Files: fragility.csv and fragility.png. What is done: the page "spectra" of
the documentation.

Examples
--------
  eventpound study cases/figure-05
  eventpound study cases/bridge-el-centro --sensitivities --of contacts.joint.max_impulse
  eventpound study cases/figure-05 --spectrum --amplitude "0.4 g" --period "0.8 s"
  eventpound study ida --fragility --measure excitation.psa \
      --demand peaks.deck.abs_max --limit "5 cm"
  eventpound study suite --fragility --measure L_e --demand contacts.joint.max_impulse \
      --limit "20 kN s" --limit "60 kN s"
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.cli import arguments, finished
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.progress import Counter
from eventpound.cli.talk import going_on
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.case import Case
    from eventpound.study.engines.base import Engine

_SENSITIVITIES = "--sensitivities --of --to --out --no-figures" + arguments.PAPER
_RUNS = "--out --no-figures --processes --workers --scheduler"


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    study = add_command(commands, "study", _study, __doc__)
    study.case()
    study.out("where the results are or go (CASE/results)")
    study.option("--no-figures", "write the table only")
    study.exclusive()
    study.option("--processes N", "N processes of this machine", arguments.count_argument)
    study.option("--workers N", "N Dask workers on this machine", arguments.count_argument)
    study.option("--scheduler ADDRESS", "a Dask scheduler, tcp://HOST:8786")
    study.group("what a quantity depends on")
    study.option("--sensitivities", "write and draw it")
    several: dict[str, Any] = {"action": "append", "default": []}
    study.option("--of QUANTITY", "by name or path (peaks); may be repeated", **several)
    study.option("--to NUMBER", "by its key (every number); may be repeated", **several)
    finished.add(study)


def _study(options: Options) -> int:
    out = options.results
    if options.spectrum:
        _of_finished(options, "--spectrum", finished.SPECTRUM, "--amplitude --period")
        for path in finished.draw_spectrum(options, out):
            print(path)
    elif options.fragility:
        _of_finished(options, "--fragility", finished.FRAGILITY, "--measure --demand --limit")
        arguments.write(out, finished.fit_fragility(options, out))
    elif options.sensitivities:
        _of_finished(options, "--sensitivities", _SENSITIVITIES, "")
        arguments.write(out, _sensitivities(options, _scene_of(options.case)))
    else:
        others = "--sensitivities, --spectrum or --fragility"
        options.refuse_others(_RUNS, f"is not for making runs, but for {others}")
        _make_runs(options, out)
    return 0


def _of_finished(options: Options, name: str, accepted: str, needed: str) -> None:
    """Refuse what an option does not go with, and it without what it needs."""
    options.refuse_others(accepted, f"is not for {name}")
    missing = [word for word in needed.split() if not getattr(options, word.strip("-"))]
    if missing:
        raise InputError(f"{name}: needs {', '.join(missing)}, too")


def _scene_of(path: Path) -> Case:
    """The case as it is, without what its [study] varies."""
    from eventpound.study.kinds import Kind, kind_of

    if kind_of(path)[0] is not Kind.STUDY:
        return arguments.load(path)
    bases = arguments.load_study(path).study.bases
    if len(bases) > 1 or bases[0].records:
        raise InputError("--sensitivities: is of one scene, and this [study] has several")
    return bases[0].case


def _sensitivities(options: Options, case: Case) -> dict[str, bytes]:
    """Compute, print and draw them; the files."""
    from eventpound.results import check_writable
    from eventpound.results.cells import Cells, lines_of
    from eventpound.results.tables import table_csv
    from eventpound.study.sensitivities import PEAKS, sensitivities

    check_writable(options.results)
    with Counter("runs") as progress:
        table = sensitivities(case, of=options.of or PEAKS, to=options.to, progress=progress)
    for name, part in table.groupby("quantity", sort=False):
        shown = zip(part["to"], part["elasticity"], part["note"], strict=True)
        rows = tuple((to, "" if note else f"{size:+.4f}", note) for to, size, note in shown)
        print("\n".join(lines_of(Cells((str(name), "% for 1 %", ""), rows, (True, False, True)))))
    files = {"sensitivities.csv": table_csv(table)}
    if options.no_figures:
        return files
    from eventpound.report.style import on_paper
    from eventpound.report.tornado import tornado_figure

    figure = tornado_figure(table, case.title)
    return files | on_paper(
        {} if figure is None else {"sensitivities.png": figure}, options.paper()
    )


def _make_runs(options: Options, out: Path) -> None:
    from eventpound.study.running import run_study

    case = arguments.load_study(options.case)
    engine = _engine(options, case.study.solver)
    with going_on(), Counter("runs") as progress:
        moved = run_study(case.study, out, engine, progress)
    if moved is not None:
        print(f"moved     what was in {out} before is in {moved}")
    arguments.warn_of_scales(case.study.bases)
    print(f"runs      {case.study.size}, {_failures(out)} failed")
    print(f"results   {out}")
    if (case.figures or case.intensities) and not options.no_figures:
        from eventpound.report.study_files import draw

        print("figures   " + ", ".join(path.name for path in draw(case, out)))


def _engine(options: Options, solver: str) -> Engine:
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
