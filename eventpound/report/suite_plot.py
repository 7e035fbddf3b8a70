"""The figure of a suite's case, chosen by its ``[figure]``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.case.case import Case
from eventpound.case.figure import Figure as Wanted
from eventpound.case.figure import FigureKind
from eventpound.errors import InputError
from eventpound.report.style import png
from eventpound.report.suite_spectrum import suite_spectrum_figure
from eventpound.results import write_together

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


def plot_suite(
    case: Case,
    table: pd.DataFrame,
    directory: str | os.PathLike[str],
    *,
    solver: str | None = None,
    rtol: float | None = None,
) -> list[Path]:
    """Draw the figure of a suite and write it.

    Parameters
    ----------
    case : Case
        Of the suite; without ``[figure]`` it gets its spectrum.
    table : DataFrame
        As `eventpound.simulate_suite` returns it.
    directory : path
        Where it goes.
    solver, rtol : optional
        What computes the response to a single record, instead of the case's own.

    Returns
    -------
    list of Path
        What was written; nothing where no record is left to draw.
    """
    done = table[table["failed"] == ""]
    if done.empty:
        return []
    wanted = case.figure or Wanted(FigureKind.SUITE_SPECTRUM)
    title = case.title + _kind_of_motions(done)
    drawn = _figure(case, wanted, done, title)
    name = f"{wanted.kind.value}.png"
    write_together(directory, {name: png(drawn)})
    return [Path(directory) / name]


def _figure(case: Case, wanted: Wanted, done: pd.DataFrame, title: str) -> Figure:
    match wanted.kind:
        case FigureKind.SUITE_SPECTRUM:
            bodies = [body.name for body in case.scene.bodies]
            return suite_spectrum_figure(done, bodies, wanted.groups, title)
    raise InputError(f"[figure]: {wanted.kind.value} cannot be drawn")


def _kind_of_motions(done: pd.DataFrame) -> str:
    """Synthetic motions are called so wherever they appear."""
    synthetic = done["record"].str.contains(r"(?:^|/)synthetic-\d", regex=True)
    if synthetic.all():
        return " (synthetic motions)"
    return " (some of the motions are synthetic)" if synthetic.any() else ""
