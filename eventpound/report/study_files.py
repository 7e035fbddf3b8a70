"""The files that are drawn of the table of a study, written all or none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from eventpound.motion.base import Scales
from eventpound.report.model_figure import model_figure
from eventpound.report.study_curves import intensity_figure
from eventpound.report.study_figure import study_figures
from eventpound.report.style import Paper, on_paper, png
from eventpound.results.files import write_together
from eventpound.results.tables import table_csv
from eventpound.study.figure import FigurePlan
from eventpound.study.intensity import fractile_curves
from eventpound.study.reading import StudyCase
from eventpound.study.spectra import dimensional_name, dimensional_spectrum
from eventpound.study.table import read_table


def draw(case: StudyCase, directory: Path, paper: Paper | None = None) -> list[Path]:
    """Draw the figures of a study from its table and write them, all or none.

    Fractile curves are written as a table, too.

    Parameters
    ----------
    case : StudyCase
        The study and what is drawn of it.
    directory : Path
        Where its table is and the figures go.
    paper : Paper, optional
        Kinds of files, width and resolution; PNG by default.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        Where there is no table, or the directory cannot be written to.
    """
    table = read_table(directory)
    drawn = {name: figure for name, figure, _ in figures_of(case, table)}
    for plan in [plan for plan in case.figures if plan.model]:
        title, scene = plan.title or case.study.title, case.study.bases[0].case.scene
        drawn[f"{plan.name}-model.png"] = model_figure(scene, title, with_laws=True)
    curves = {plan.name: fractile_curves(table, plan) for plan in case.intensities}
    files = {f"{name}.csv": table_csv(curve) for name, curve in curves.items()}
    return write_together(directory, on_paper(drawn, paper or Paper()) | files)


def figures_of(case: StudyCase, table: pd.DataFrame) -> Iterator[tuple[str, Figure, str]]:
    """Figures that a study asks for: names of their files, pictures, what they show."""
    for plan in case.figures:
        said = plan.claim or plan.title or case.study.title
        yield from ((*each, said) for each in study_figures(case, plan, table))
    for intensity in case.intensities:
        curves = fractile_curves(table, intensity)
        drawn = intensity_figure(case.study, intensity, table, curves)
        said = f"Fractiles of {intensity.demand} over {intensity.measure}."
        yield f"{intensity.name}.png", drawn, said


def draw_spectrum(case: StudyCase, directory: Path, scales: Scales) -> list[Path]:
    """Write the spectrum in dimensions of a study in Π-terms, and its figures drawn in them.

    Parameters
    ----------
    case : StudyCase
        The study and what is drawn of it.
    directory : Path
        Where its table is and the spectrum goes.
    scales : Scales
        a_g and omega_g of the pulse.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        Where there is no table or none with peaks in Π-terms, or the directory
        cannot be written to.
    """
    spectrum = dimensional_spectrum(read_table(directory), scales)
    files = {"spectrum.csv": table_csv(spectrum)}
    pulse = f"$a_g$ = {scales.a_g:.4g} m/s², $T_g$ = {scales.period:.4g} s"
    for plan in case.figures:
        title = f"{plan.title or case.study.title}: {pulse}"
        for name, figure in study_figures(case, _in_dimensions(plan, title, scales), spectrum):
            files[name] = png(figure)
    return write_together(directory, files)


def _in_dimensions(plan: FigurePlan, title: str, scales: Scales) -> FigurePlan:
    """The same figure of columns in dimensions; an empty `x` stays the last axis."""
    words = ("curves", "rows", "columns", "pages", "grey")
    named: dict[str, Any] = {word: dimensional_name(getattr(plan, word)) for word in words}
    named |= {axis: tuple(map(dimensional_name, getattr(plan, axis))) for axis in ("x", "y")}
    # Numbers on the axes are in Π-terms.
    named |= {"regions": None, "gain": False, "marks": (), "levels": (), "largest": None}
    named |= {"x_labels": (), "y_labels": ()}
    y_max = None if plan.y_max is None else plan.y_max * scales.length
    return replace(plan, name=f"spectrum-{plan.name}", title=title, y_max=y_max, **named)
