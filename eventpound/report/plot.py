"""All figures of a run, from results in memory or on disk to PNG files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.report.displacements import displacement_figure
from eventpound.report.loops import loop_figure, nonlinear_springs
from eventpound.report.style import png
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


def plot(source: Source, directory: str | os.PathLike[str]) -> list[Path]:
    """Draw the figures of a run and write them, all or none.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.
    directory : path
        Where the figures go.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        Where a directory holds no complete results or cannot be written to.
    """
    pictures = {name: png(figure) for name, figure in figures(source).items()}
    return write_together(directory, pictures)


def _results(source: Source) -> StoredResults:
    if isinstance(source, StoredResults):
        return source
    if isinstance(source, Response):
        return gather(source)
    return read(source)
