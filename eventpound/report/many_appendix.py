"""What follows the sheets of a report of many runs.

The appendix of a suite: the scene, its motions, what they did, origin.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.motion.scaling import PERIODS, psa_of
from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import parts_of
from eventpound.quantities.listed import LISTED
from eventpound.report import html
from eventpound.report.html import Part, folded, table_of
from eventpound.report.record_figure import suite_spectra_figure
from eventpound.report.record_tables import all_records, record_names
from eventpound.report.study_files import figures_of
from eventpound.report.suite_plot import suite_spectrum_figure
from eventpound.report.symbols import dimension_of
from eventpound.results.shown_units import units_of_scene
from eventpound.results.tables import Cells, cell_text, headed
from eventpound.study.forms import MESSAGE, SUCCESS
from eventpound.study.reading import StudyCase
from eventpound.study.records import SA, sa_of_suite
from eventpound.study.stated import stated

_PARTS = (16.0, 50.0, 84.0)


def fractiles(
    table: pd.DataFrame, columns: Sequence[str], where: str, place: Callable[[int], str]
) -> Part:
    """A table of fractiles over the rows, folded up by a click; empty where nothing is known.

    Parameters
    ----------
    table : DataFrame
        A row a run.
    columns : sequence of str
        Of numbers.
    where : str
        Heading of the last column.
    place : callable
        What stands there for the row of the greatest.

    Returns
    -------
    str
        HTML.
    """
    rows = []
    for name in columns:
        values = table[name].dropna()
        if values.empty:
            continue
        parts = [values.min(), *np.percentile(values, _PARTS), values.max()]
        texts = [cell_text(float(part)) for part in parts]
        called = headed(name, dimension_of(name).unit)
        rows.append((called, *texts, place(int(values.idxmax()))))
    if not rows:
        return ""
    heads = ("quantity", "least", *(f"{p:g} %" for p in _PARTS), "greatest", where)
    words = (True, *(False for _ in heads[2:]), True)
    shown = table_of(Cells(heads, tuple(rows), words))
    return folded(f"{len(rows)} quantities", shown, opened=True)


_MOST_FAILED, _LISTED = 50, 8
"""Runs that are listed; values of an axis, beyond which only the ends of numbers are."""


def study_sections(
    case: StudyCase, table: pd.DataFrame, manifest: Mapping[str, Any]
) -> list[html.Section]:
    """What stands behind the report of a study.

    Parameters
    ----------
    case : StudyCase
        The study, and what is drawn of it.
    table : DataFrame
        Its table.
    manifest : mapping
        Its manifest.

    Returns
    -------
    list of Section
        Empty ones have nothing to say.
    """
    study = case.study
    done = table[table[SUCCESS]]
    numbers = [n for n in done.select_dtypes("number").columns if n in set(study.quantities)]

    def place(row: int) -> str:
        return ", ".join(f"{name} = {cell_text(done[name][row])}" for name in study.columns)

    same, *parts = (text.replace("$", "").replace("\\,", " ") for text in stated(study, str))
    summary = {"runs": f"{len(done)} of {len(table)}", "in all runs": same}
    summary |= {"parts": "; ".join(parts)} if parts else {}
    first = study.bases[0].at_first().case
    return [
        ("Summary", [html.list_of(summary)]),
        ("Axes", [_axes(study.columns, table)]),
        ("Figures", [html.figure_of(figure, said) for _, figure, said in figures_of(case, table)]),
        ("Quantities", [fractiles(done, numbers, "at", place)]),
        ("Failed", _failed(study.columns, table[~table[SUCCESS]])),
        ("Model", [html.text_part("The scene of the first run."), *html.model_of(first)]),
        ("Origin", [html.origin_of(manifest)]),
    ]


def _axes(axes: Sequence[str], table: pd.DataFrame) -> html.Part:
    """What varies: how many values, and which or from where to where."""
    rows = []
    for name in axes:
        values = table[name].drop_duplicates()
        listed = ", ".join(cell_text(value) for value in values[:_LISTED])
        if len(values) > _LISTED:
            listed += " …"
            if values.dtype.kind == "f":
                listed = f"{cell_text(values.min())} to {cell_text(values.max())}"
        rows.append((headed(name, dimension_of(name).unit), str(len(values)), listed))
    return html.table_of(Cells(("axis", "values", ""), tuple(rows), (True, False, True)))


def _failed(axes: Sequence[str], failed: pd.DataFrame) -> Iterator[html.Part]:
    """The runs that were not carried to their end, and why."""
    shown = failed.head(_MOST_FAILED)
    rows = tuple(
        (*(cell_text(row[name]) for name in axes), str(row[MESSAGE])) for _, row in shown.iterrows()
    )
    if rows:
        words = (*(False for _ in axes), True)
        yield html.table_of(Cells((*axes, "why"), rows, words, len(failed) - len(rows)))


_MOST_BODIES, _MOST_SPECTRA = 6, 100
"""That have a panel; whose spectra are drawn."""
_GROUPS = 4
_SPECTRUM = PERIODS[::3]


def suite_sections(
    case: Case, table: pd.DataFrame, manifest: Mapping[str, Any]
) -> list[html.Section]:
    """What stands behind the report of a suite.

    Parameters
    ----------
    case : Case
        The case as it was run.
    table : DataFrame
        Its table.
    manifest : mapping
        Its manifest.

    Returns
    -------
    list of Section
        Empty ones have nothing to say.
    """
    done = table[table["failed"] == ""]
    # Times of extremes say nothing over many runs.
    listed = {parts_of(q.path)[0].partition(".")[0] for q in LISTED}
    numbers = [
        name
        for name in done.select_dtypes("number").columns
        if name.partition(".")[0] in listed and not name.rpartition(".")[2].startswith("t_")
    ]
    names, units = record_names(table), units_of_scene(case.scene, case.run.stated)
    records = all_records(case, table, units)
    return [
        ("Model", html.model_of(case) if case.scene.bodies else ()),
        ("Ground motions", _motions(case, done)),
        ("Response", _response(case, done)),
        ("Quantities", [fractiles(done, numbers, "under", lambda row: names[done["record"][row]])]),
        ("Records", [html.folded(f"{len(table)} records", html.table_of(records))]),
        ("Origin", [html.origin_of(manifest)]),
    ]


def _motions(case: Case, done: pd.DataFrame) -> Iterator[html.Part]:
    """Spectra of the records that still are where they were."""
    spectra: list[Floats] = []
    records, at = list(done["record"]), None
    period, damping = sa_of_suite(case)
    if SA in done and done[SA].notna().all():
        at = period, done[SA].to_numpy(float), case.size.wanted(period)
    for member in [m for m in case.members if m.name in records][:_MOST_SPECTRA]:
        try:
            motion = member.options.motion(member.read())
        except InputError:
            continue
        spectra.append(psa_of(motion.values, motion.time_step, _SPECTRUM, damping))
    if spectra:
        drawn = suite_spectra_figure(_SPECTRUM, np.array(spectra), damping, case.size.target, at)
        said = f"Spectra of {len(spectra)} records as scaled, {100.0 * damping:g} % damping."
        yield html.figure_of(drawn, said)


def _response(case: Case, done: pd.DataFrame) -> Iterator[html.Part]:
    if len(done) > 1 and case.scene.bodies:
        names = {body.name: body.name for body in case.scene.bodies[:_MOST_BODIES]}
        figure = suite_spectrum_figure(done, names, _GROUPS, "")
        yield html.figure_of(figure, "Peak displacements over the length scale of the motions.")
