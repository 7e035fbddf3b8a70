"""The appendix of a suite: the scene, its motions, what they did, origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.motion.oscillators import PERIODS
from eventpound.motion.scaling import DAMPING, psa_of
from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import parts_of
from eventpound.quantities.listed import LISTED
from eventpound.report import html
from eventpound.report.many import fractiles, struck
from eventpound.report.record_tables import record_names
from eventpound.report.spectrum_figure import suite_spectra_figure
from eventpound.report.suite_plot import suite_figure
from eventpound.results.cells import Cells
from eventpound.scene.at_rest import at_rest
from eventpound.scene.periods import longest_period
from eventpound.study.large_scales import large_scales_of
from eventpound.units import STANDARD_GRAVITY

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
    names = record_names(table)
    return [
        ("Summary", [_summary(case, table, done)]),
        ("Model", html.model_of(case) if case.scene.bodies else ()),
        ("Ground motions", _motions(case, done)),
        ("Response", _response(case, done)),
        ("Quantities", [fractiles(done, numbers, "under", lambda row: names[done["record"][row]])]),
        ("Records", [_records(case, table)]),
        ("Origin", [html.origin_of(manifest)]),
    ]


def _summary(case: Case, table: pd.DataFrame, done: pd.DataFrame) -> html.Part:
    """How many records there are, their sizes, and the largest response with its record."""
    lines = {"records": f"{len(done)} of {len(table)}"}
    if failed := len(table) - len(done):
        lines["failed"] = f"{failed}; why is in the table of records"
    if case.suite is not None and case.suite.options.scaling:
        lines["scaling"] = case.suite.options.scaling
    if large := large_scales_of(case):
        lines["warning"] = large
    if done.empty:
        return html.list_of(lines)
    for name, size, unit in (("PGA", STANDARD_GRAVITY, "g"), ("L_e", 0.01, "cm")):
        values = done[name] / size
        lines[name] = f"{values.min():.4g} to {values.max():.4g} {unit}"
    peaks = {body.name: f"peaks.{body.name}.abs_max" for body in case.scene.bodies}
    largest = [(done[name].max(), body, name) for body, name in peaks.items() if name in done]
    if largest:
        size, body, name = max(largest)
        record = record_names(table)[done["record"][done[name].idxmax()]]
        lines["largest"] = f"|u| = {size:.6g} m of {body} under {record}"
    return html.list_of(lines | struck(done))


def _motions(case: Case, done: pd.DataFrame) -> Iterator[html.Part]:
    """Spectra of the records that still are where they were."""
    spectra: list[Floats] = []
    records, at = list(done["record"]), None
    if "Sa_T1" in done and done["Sa_T1"].notna().all() and case.suite is not None:
        period = longest_period(at_rest(case.scene, case.run.start_time))
        assert period is not None
        at = period, done["Sa_T1"].to_numpy(float), case.suite.options.size.wanted(period)
    members = [] if case.suite is None else case.suite.members(case.directory)
    for member in [m for m in members if m.name in records][:_MOST_SPECTRA]:
        try:
            motion = member.options.motion(member.read())
        except InputError:
            continue
        spectra.append(psa_of(motion.values, motion.time_step, _SPECTRUM, DAMPING))
    if spectra:
        target = None if case.suite is None else case.suite.options.size.target
        drawn = suite_spectra_figure(_SPECTRUM, np.array(spectra), DAMPING, target, at)
        said = f"Spectra of {len(spectra)} records as scaled, {100.0 * DAMPING:g} % damping."
        yield html.figure_of(drawn, said)


def _response(case: Case, done: pd.DataFrame) -> Iterator[html.Part]:
    if len(done) > 1 and case.scene.bodies:
        figure = suite_figure(case, done, _GROUPS, most=_MOST_BODIES)
        yield html.figure_of(figure, "Peak displacements over the length scale of the motions.")


def _records(case: Case, table: pd.DataFrame) -> html.Part:
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
    rows, names = [], record_names(table)
    for _, row in table.iterrows():
        values = [row[name] / size for name, size in columns.values()]
        cells = ["" if np.isnan(value) else f"{value:.5g}" for value in values]
        rows.append((names[row["record"]], str(row["file"]), *cells, str(row["failed"])))
    words = (True, True, *(False for _ in columns), True)
    shown = html.table_of(Cells(("record", "file", *columns, "failed"), tuple(rows), words))
    return html.folded(f"{len(rows)} records", shown)
