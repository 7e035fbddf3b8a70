"""Draw the figures of results: of a run, a suite, a study, or a folder of cases.

A run is drawn from its results; so are a suite and a study, whose case says what is drawn.
For a folder of cases all studies and suites with a [figure] are computed and drawn, with an
index page, index.html.

Examples
--------
  eventpound plot pulse --xlim 2,6.5 --format pdf --width "90 mm"
  eventpound plot pulse --model
  eventpound plot cases --out figures
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.folder import plot_folder
from eventpound.cli.talk import complain
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.report.style import Paper
    from eventpound.response import Response


def add_plot(commands: Commands) -> None:
    """Add the command to the parser."""
    plot = add_command(commands, "plot", _plot, __doc__)
    plot.add_argument("case", metavar="CASE|FOLDER", type=Path, help="directory of it, or of cases")
    plot.out("where results are and figures go (CASE/results; for a folder figures)")
    plot.option("--model", "draw the bodies, springs and contacts only, model.png")
    plot.group("of a single run")
    plot.option("--xlim FROM,TO", "stretch of time that is drawn (s)", arguments.two_times)
    apart = "draw the same run without contact beside it, pale; it is computed for this"
    plot.option("--without-contact", apart)
    plot.option("--beside DIR", "other results, drawn beside these, pale", Path)
    plot.option("--zoom", "one page that zooms, with events to click, instead: motion.html")
    plot.option("--pi", "axes in Π-terms: L_e, 1/ω_g, m a_g")
    plot.paper()


def _plot(options: Options) -> int:
    from eventpound.study.kinds import Holds, kind_of_results

    out = options.results
    kind, document = kind_of_results(out, options.case)
    if kind is Holds.FOLDER:
        options.refuse_others("--out", "is for a single case, and this is a folder of cases")
        return plot_folder(options.case, options.out or Path("figures"))
    paper = options.paper()
    run: Callable[..., Sequence[Path]] = partial(_plot_run, "pi" in document)
    draw = kind.choose(run=run, suite=_plot_suite, study=_plot_study, folder=run)
    if options.model:
        options.refuse_others("--model --out" + arguments.PAPER, "is not for --model")
        draw = _plot_model
    elif kind is not Holds.RUN:
        why = f"is for a single run, and these are the results of a {kind}"
        options.refuse_others("--out" + arguments.PAPER, why)
    for path in draw(options, out, paper):
        print(path)
    return 0


def _plot_run(pi: bool, options: Options, out: Path, paper: Paper) -> Sequence[Path]:
    """Draw a run, or make its page that zooms; of a case in Π-terms in these."""
    from eventpound.report.run_figures import plot
    from eventpound.results import write_together

    if options.zoom:
        options.refuse_others("--zoom --out", "is not for --zoom")
        return write_together(out, _zoom(out))
    return plot(out, out, paper, options.xlim, _beside(options, out), options.pi or pi)


def _zoom(out: Path) -> dict[str, bytes]:
    """The page that zooms."""
    from eventpound.case.run_options import Stated
    from eventpound.report.run_figures import view_of_run
    from eventpound.report.zoom import ZOOM_PAGE, zoom_page
    from eventpound.results.shown_units import Units, units_of_scene

    view = view_of_run(out)
    title = str((view.results.manifest.get("case") or {}).get("title", "")) or out.name
    stated = (view.results.manifest.get("case") or {}).get("run", {}).get("units", ())
    units = Units()
    if view.scene is not None:
        units = units_of_scene(view.scene, Stated(units=tuple(stated)))
    return {ZOOM_PAGE: zoom_page(view, title, units)}


def _beside(options: Options, out: Path) -> tuple[Path | Response, str] | None:
    """What is drawn beside the results, and its name."""
    if options.beside is not None:
        if options.without_contact:
            raise InputError("--beside and --without-contact: accepted: one of them")
        return options.beside, str(options.beside)
    if not options.without_contact:
        return None
    from eventpound.results import read
    from eventpound.simulation import response_of

    case = arguments.case_of_results(read(out).manifest, out, options)
    return response_of(case.apart(replace(case.scene, contacts=()))), "without contact"


def _plot_model(options: Options, out: Path, paper: Paper) -> Sequence[Path]:
    """Draw the bodies of a case and what joins them, of a study those of its first run."""
    from eventpound.report.model_figure import model_figure
    from eventpound.report.style import on_paper
    from eventpound.results import write_together

    first = arguments.by_kind(options.case, lambda case: case, lambda own: own.study.bases[0].case)
    if not first.scene.bodies:
        raise InputError(f"{options.case}: the case has no bodies to draw")
    figures = {"model.png": model_figure(first.scene, first.title, with_laws=True)}
    return write_together(out, on_paper(figures, paper))


def _plot_study(options: Options, out: Path, paper: Paper) -> Sequence[Path]:
    """Draw the figures of a study from its table."""
    from eventpound.report.study_files import draw
    from eventpound.study.reading import load_finished

    case, _, _ = load_finished(options.case, out)
    if not (case.figures or case.intensities):
        raise InputError(
            f"{options.case}: [figure]: missing; a study is drawn as it says (the page "
            '"studies" of the documentation)'
        )
    return draw(case, out, paper)


def _plot_suite(options: Options, out: Path, paper: Paper) -> Sequence[Path]:
    """Draw the figure of a suite, of the records it was run with."""
    from eventpound.report.suite_plot import plot_suite
    from eventpound.study.table import read_suite

    table, manifest = read_suite(out)
    if not manifest.get("complete", True):
        complain(
            f"warning: {len(table)} of {manifest.get('records_of_suite')} records of the suite "
            "were run before it was stopped; the figure shows no more"
        )
    case, of = arguments.case_of_results(manifest, out, options), manifest["options"]
    return plot_suite(case, table, out, solver=of.get("solver"), rtol=of.get("rtol"), paper=paper)
