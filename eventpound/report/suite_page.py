"""One self-contained HTML page of a suite: the scene, its motions, what they did, origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.motion.oscillators import PERIODS
from eventpound.motion.scaling import DAMPING, psa_of
from eventpound.numerics.arrays import Floats
from eventpound.report.fractiles import fractiles, quantities_among
from eventpound.report.html import (
    figure_of,
    list_of,
    model_section,
    origin_section,
    page,
    table_of,
)
from eventpound.report.spectrum_figure import suite_spectra_figure
from eventpound.report.suite_spectrum import suite_spectrum_figure
from eventpound.results.input_tables import Cells
from eventpound.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    import pandas as pd

_MOST_BODIES, _MOST_SPECTRA = 6, 100
"""That have a panel; whose spectra are drawn."""
_GROUPS = 4
_SPECTRUM = PERIODS[::3]


def suite_page(case: Case, table: pd.DataFrame, manifest: Mapping[str, Any]) -> bytes:
    """The page of a suite.

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
    bytes
        HTML, UTF-8.
    """
    done = table[table["failed"] == ""]
    sections = [
        ("Summary", _summary(case, table, done)),
        ("Model", model_section(case) if case.scene.bodies else ()),
        ("Ground motions", _motions(case, done)),
        ("Response", _response(case, done)),
        ("Quantities", _quantities(done)),
        ("Records", _records(case, table)),
        ("Origin", origin_section(manifest)),
    ]
    return page(case.title, sections)


def _summary(case: Case, table: pd.DataFrame, done: pd.DataFrame) -> Iterator[str]:
    """How many records there are, their sizes, and the largest response with its record."""
    lines = {"records": f"{len(done)} of {len(table)}"}
    if failed := len(table) - len(done):
        lines["failed"] = f"{failed}; why is in the table of records"
    if case.suite is not None and case.suite.options.scaling:
        lines["scaling"] = case.suite.options.scaling
    if len(done):
        g = done["PGA"] / STANDARD_GRAVITY
        lines["PGA"] = f"{g.min():.4g} to {g.max():.4g} g"
        lines["L_e"] = f"{100.0 * done['L_e'].min():.4g} to {100.0 * done['L_e'].max():.4g} cm"
    peaks = {body.name: f"peaks.{body.name}.abs_max" for body in case.scene.bodies}
    largest = [(done[name].max(), body, name) for body, name in peaks.items() if name in done]
    if largest and len(done):
        size, body, name = max(largest)
        record = done["record"][done[name].idxmax()]
        lines["largest"] = f"|u| = {size:.6g} m of {body} under {record}"
    if "impacts" in done and len(done):
        struck = int((done["impacts"] > 0).sum())
        lines["impacts"] = f"in {struck} of {len(done)} runs, {int(done['impacts'].max())} at most"
    yield list_of(lines)


def _motions(case: Case, done: pd.DataFrame) -> Iterator[str]:
    """Spectra of the records that still are where they were."""
    names, spectra = _spectra(case, list(done["record"]))
    if not names:
        return
    target = None if case.suite is None else case.suite.options.size.target
    caption = f"Spectra of {len(names)} records as scaled, {100.0 * DAMPING:g} % damping."
    yield figure_of(suite_spectra_figure(_SPECTRUM, spectra, target), caption)


def _spectra(case: Case, wanted: list[str]) -> tuple[list[str], Floats]:
    """PSA (m/s^2) of records at `_SPECTRUM`, a row a record."""
    names: list[str] = []
    rows: list[Floats] = []
    members = [] if case.suite is None else case.suite.members(case.directory)
    for member in [m for m in members if m.name in wanted][:_MOST_SPECTRA]:
        try:
            motion = member.options.motion(member.read())
        except InputError:
            continue
        names.append(member.name)
        rows.append(psa_of(motion.values, motion.time_step, _SPECTRUM, DAMPING))
    return names, np.array(rows)


def _response(case: Case, done: pd.DataFrame) -> Iterator[str]:
    bodies = [body.name for body in case.scene.bodies][:_MOST_BODIES]
    if len(done) > 1 and bodies:
        names = case.figure.names if case.figure else {}
        called = {body: names.get(body, body) for body in bodies}
        figure = suite_spectrum_figure(done, called, _GROUPS, "")
        yield figure_of(figure, "Peak displacements over the length scale of the motions.")


def _quantities(done: pd.DataFrame) -> Iterator[str]:
    """Fractiles of every quantity over the records, and the record of the largest."""
    yield fractiles(done, quantities_among(done), "under", lambda row: str(done["record"][row]))


def _records(case: Case, table: pd.DataFrame) -> Iterator[str]:
    """A line a record: its size, its peaks, or why it has none."""
    columns = {
        "PGA (g)": ("PGA", STANDARD_GRAVITY),
        "T_m (s)": ("T_m", 1.0),
        "L_e (cm)": ("L_e", 0.01),
    }
    for body in case.scene.bodies[:_MOST_BODIES]:
        columns[f"|u| of {body.name} (cm)"] = (f"peaks.{body.name}.abs_max", 0.01)
    columns["impacts"] = ("impacts", 1.0)
    columns = {head: (name, size) for head, (name, size) in columns.items() if name in table}
    rows = []
    for _, row in table.iterrows():
        cells = [_number(row[name], size) for name, size in columns.values()]
        rows.append((str(row["record"]), *cells, str(row["failed"])))
    words = (True, *(False for _ in columns), True)
    shown = table_of(Cells(("record", *columns, "failed"), tuple(rows), words))
    summary = escape(f"{len(rows)} records")
    yield f"<details><summary>{summary}</summary>\n{shown}</details>\n"


def _number(value: float, size: float) -> str:
    return "" if np.isnan(value) else f"{value / size:.5g}"
