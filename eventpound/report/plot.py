"""All figures of a run, from results in memory or on disk to PNG files."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.errors import InputError
from eventpound.report.displacements import displacement_figure
from eventpound.report.loops import loop_figure, nonlinear_springs
from eventpound.report.style import Paper, on_paper
from eventpound.response import Response
from eventpound.results import StoredResults, gather, read, write_together

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Source = StoredResults | Response | str | os.PathLike[str]


def figures(source: Source) -> dict[str, Figure]:
    """Draw the figures of a run.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.

    Returns
    -------
    dict
        Figures by the names of their files: ``displacements.png`` and, where a
        spring is not linear, ``loops.png``.

    Raises
    ------
    InputError
        Where a directory holds no complete results.
    """
    results = _results(source)
    drawn = {"displacements.png": displacement_figure(results)}
    if nonlinear_springs(results):
        drawn["loops.png"] = loop_figure(results)
    return drawn


def plot(
    source: Source,
    directory: str | os.PathLike[str],
    paper: Paper | None = None,
    xlim: tuple[float, float] | None = None,
) -> list[Path]:
    """Draw the figures of a run and write them, all or none.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.
    directory : path
        Where the figures go.
    paper : Paper, optional
        Kinds of files, width and resolution; PNG by default.
    xlim : tuple of float, optional
        Stretch of time that is drawn (s).

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        Where a directory holds no complete results or cannot be written to.
    """
    results = _results(source)
    if xlim is not None:
        results = _within(results, xlim)
    return write_together(directory, on_paper(figures(results), paper or Paper()))


def _within(results: StoredResults, xlim: tuple[float, float]) -> StoredResults:
    """Results of a stretch of time (s)."""
    low, high = xlim
    rows, events = (
        table[table["t"].between(low, high)] for table in (results.history, results.events)
    )
    if len(rows) < 2:
        raise InputError(f"xlim: found {low:g} to {high:g} s, in which there are no rows to draw")
    return replace(results, history=rows, events=events)


def _results(source: Source) -> StoredResults:
    if isinstance(source, StoredResults):
        return source
    if isinstance(source, Response):
        return gather(source)
    return read(source)
