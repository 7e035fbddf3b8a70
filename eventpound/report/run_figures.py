"""All figures of a run, from results in memory or on disk to files."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

from eventpound.basics.given import checked
from eventpound.case import read_case
from eventpound.errors import InputError
from eventpound.report.displacements import displacement_figure
from eventpound.report.loops import loop_figure, nonlinear_springs
from eventpound.report.plan_view import worst_plan_figure
from eventpound.report.profile import profile_figure
from eventpound.report.style import Paper, on_paper
from eventpound.report.towers import towers_of
from eventpound.report.view import Beside, View
from eventpound.response import Response
from eventpound.results import StoredResults, gather, read, write_together
from eventpound.scene.scene import Scene

Source = StoredResults | Response | str | os.PathLike[str]


def figures(
    source: Source,
    beside: tuple[Source, str] | None = None,
    pi: bool = False,
    xlim: tuple[float, float] | None = None,
) -> dict[str, Figure]:
    """Draw the figures of a run.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.
    beside : tuple of (source, str), optional
        Another run of the same bodies and what it is called, drawn pale.
    pi : bool
        Whether axes are in Π-terms, as L_e and 1/omega_g.
    xlim : tuple of float, optional
        Stretch of time that is drawn (s).

    Returns
    -------
    dict
        Figures by the names of their files: ``displacements.png``; where a spring is not
        linear, ``loops.png``; where storeys stand on one another, ``profiles.png``; of decks in
        plan ``plan.png``.

    Raises
    ------
    InputError
        Where a directory holds no complete results, or a motion has no scales for Π-terms.
    """
    view, other = view_of_run(source, pi).within(xlim), None
    if beside is not None:
        # Times and lengths of both in the units of the first.
        own = replace(view_of_run(beside[0]), units_of=view)
        if set(own.bodies).isdisjoint(view.bodies):
            raise InputError(f"{beside[1]}: none of its bodies is called as one of this run")
        other = Beside(own.within(xlim), beside[1])
    drawn = {"displacements.png": displacement_figure(view, other)}
    if nonlinear_springs(view):
        drawn["loops.png"] = loop_figure(view, other)
    if (plan := worst_plan_figure(view)) is not None:
        drawn["plan.png"] = plan
    if towers_of(view):
        drawn["profiles.png"] = profile_figure(view, other)
    return drawn


@checked
def plot(
    source: Source,
    directory: str | os.PathLike[str],
    paper: Paper | None = None,
    xlim: tuple[float, float] | None = None,
    beside: tuple[Source, str] | None = None,
    pi: bool = False,
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
    beside : tuple of (source, str), optional
        Another run of the same bodies and what it is called, drawn pale.
    pi : bool
        Whether axes are in Π-terms, as L_e and 1/omega_g.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        Where a directory holds no complete results or cannot be written to.
    """
    drawn = figures(source, beside, pi, xlim)
    return write_together(directory, on_paper(drawn, paper or Paper()))


def view_of_run(source: Source, pi: bool = False) -> View:
    """Results as figures read them, with the scene where it is known.

    Parameters
    ----------
    source : StoredResults, Response or path
        Results, or the directory that holds them.
    pi : bool
        Whether axes are in Π-terms.
    """
    if isinstance(source, Response):
        return View(gather(source), source.scene, pi)
    results = source if isinstance(source, StoredResults) else read(source)
    return View(results, _scene(results), pi)


def _scene(results: StoredResults) -> Scene | None:
    """Bodies, springs and contacts of a run, without its motion; None where the case is unknown."""
    case = results.manifest.get("case")
    if not isinstance(case, dict) or "body" not in case:
        return None
    try:
        return read_case({**case, "excitation": {"kind": "none"}}, Path("case.toml")).scene
    except InputError:
        return None
