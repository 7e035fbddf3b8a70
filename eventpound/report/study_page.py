"""One self-contained HTML page of a study: its axes, its figures, its quantities, origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from eventpound.case.case import Case
from eventpound.report.fractiles import fractiles
from eventpound.report.html import figure_of, list_of, model_section, page, table_of, text_of
from eventpound.report.intensity_figure import intensity_figure
from eventpound.report.study_figure import study_figures
from eventpound.report.symbols import dimension_of
from eventpound.results.input_tables import Cells
from eventpound.study.intensity import fractile_curves
from eventpound.study.reading import StudyCase
from eventpound.study.stated import stated
from eventpound.study.table import MESSAGE, SUCCESS

if TYPE_CHECKING:
    import pandas as pd

_MOST_FAILED, _LISTED = 50, 8
"""Runs that are listed; values of an axis, beyond which only the ends of numbers are."""


def study_page(case: StudyCase, table: pd.DataFrame, manifest: Mapping[str, Any]) -> bytes:
    """The page of a study.

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
    bytes
        HTML, UTF-8.
    """
    study = case.study
    done = table[table[SUCCESS]]
    sections = [
        ("Summary", _summary(case, table, done)),
        ("Axes", _axes(case, table)),
        ("Figures", _figures(case, table)),
        ("Quantities", _quantities(case, done)),
        ("Failed", _failed(case, table[~table[SUCCESS]])),
        ("Model", _model(study.bases[0].at_first().case)),
        ("Origin", _origin(manifest)),
    ]
    return page(study.title, sections)


def _summary(case: StudyCase, table: pd.DataFrame, done: pd.DataFrame) -> Iterator[str]:
    lines = {"runs": f"{len(done)} of {len(table)}"}
    same, *parts = (text.replace("$", "").replace("\\,", " ") for text in stated(case.study, str))
    lines["in all runs"] = same
    if parts:
        lines["parts"] = "; ".join(parts)
    if "impacts" in done and len(done):
        struck = int((done["impacts"] > 0).sum())
        lines["impacts"] = f"in {struck} of {len(done)} runs, {int(done['impacts'].max())} at most"
    yield list_of(lines)


def _axes(case: StudyCase, table: pd.DataFrame) -> Iterator[str]:
    """What varies: how many values, and which or from where to where."""
    rows = []
    for name in case.study.columns:
        values = table[name].drop_duplicates()
        unit = dimension_of(name).unit
        called = f"{name} ({unit})" if unit else name
        listed = ", ".join(text_of(value) for value in values[:_LISTED])
        if len(values) > _LISTED:
            listed += " …"
            if values.dtype.kind == "f":
                listed = f"{text_of(values.min())} to {text_of(values.max())}"
        rows.append((called, str(len(values)), listed))
    yield table_of(Cells(("axis", "values", ""), tuple(rows), (True, False, True)))


def _figures(case: StudyCase, table: pd.DataFrame) -> Iterator[str]:
    """Those that the case asks for."""
    for plan in case.figures:
        for _, figure in study_figures(case, plan, table):
            yield figure_of(figure, plan.claim or plan.title or case.study.title)
    for intensity in case.intensities:
        curves = fractile_curves(table, intensity)
        drawn = intensity_figure(case.study, intensity, table, curves)
        yield figure_of(drawn, f"Fractiles of {intensity.demand} over {intensity.measure}.")


def _quantities(case: StudyCase, done: pd.DataFrame) -> Iterator[str]:
    """Fractiles over all runs, and where the greatest is."""
    axes, kept = case.study.columns, set(case.study.quantities)

    def place(row: int) -> str:
        return ", ".join(f"{name} = {text_of(done[name][row])}" for name in axes)

    columns = [name for name in done.select_dtypes("number").columns if name in kept]
    yield fractiles(done, columns, "at", place)


def _failed(case: StudyCase, failed: pd.DataFrame) -> Iterator[str]:
    """The runs that were not carried to their end, and why."""
    if failed.empty:
        return
    axes = case.study.columns
    rows = [
        (*(text_of(row[name]) for name in axes), str(row[MESSAGE]))
        for _, row in failed.head(_MOST_FAILED).iterrows()
    ]
    more = len(failed) - len(rows)
    words = (*(False for _ in axes), True)
    yield table_of(Cells((*axes, "why"), tuple(rows), words, more))


def _model(first: Case) -> Iterator[str]:
    """The scene of the first run."""
    yield "<p>The scene of the first run.</p>\n"
    yield from model_section(first)


def _origin(manifest: Mapping[str, Any]) -> Iterator[str]:
    versions = {name: version for name, version in manifest["versions"].items() if version}
    lines = {"study": manifest["study_sha256"], **versions, **manifest["files"]}
    yield list_of({key: str(value) for key, value in lines.items()})
