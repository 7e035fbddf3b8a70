"""The appendix of a suite: the scene, its motions, what they did, origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.motion.oscillators import PERIODS
from eventpound.motion.scaling import psa_of
from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import parts_of
from eventpound.quantities.listed import LISTED
from eventpound.report import html
from eventpound.report.many import fractiles, struck
from eventpound.report.record_tables import all_records, record_names
from eventpound.report.spectrum_figure import suite_spectra_figure
from eventpound.report.suite_plot import suite_figure
from eventpound.results.trade import trade_of
from eventpound.study.large_scales import large_scales_of
from eventpound.study.records import SA, sa_of_suite
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
    names, trade = record_names(table), trade_of(case.scene, case.run.stated)
    records = all_records(case, table, trade)
    return [
        ("Summary", [_summary(case, table, done)]),
        ("Model", html.model_of(case) if case.scene.bodies else ()),
        ("Ground motions", _motions(case, done)),
        ("Response", _response(case, done)),
        ("Quantities", [fractiles(done, numbers, "under", lambda row: names[done["record"][row]])]),
        ("Records", [html.folded(f"{len(table)} records", html.table_of(records))]),
        ("Origin", [html.origin_of(manifest)]),
    ]


def _summary(case: Case, table: pd.DataFrame, done: pd.DataFrame) -> html.Part:
    """How many records there are, their sizes, and the largest response with its record."""
    lines = {"records": f"{len(done)} of {len(table)}"}
    if failed := len(table) - len(done):
        lines["failed"] = f"{failed}; why is in the table of records"
    if case.scaling:
        lines["scaling"] = case.scaling
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
    period, damping = sa_of_suite(case)
    if SA in done and done[SA].notna().all() and case.suite is not None:
        at = period, done[SA].to_numpy(float), case.suite.options.size.wanted(period)
    for member in [m for m in case.members if m.name in records][:_MOST_SPECTRA]:
        try:
            motion = member.options.motion(member.read())
        except InputError:
            continue
        spectra.append(psa_of(motion.values, motion.time_step, _SPECTRUM, damping))
    if spectra:
        target = None if case.suite is None else case.suite.options.size.target
        drawn = suite_spectra_figure(_SPECTRUM, np.array(spectra), damping, target, at)
        said = f"Spectra of {len(spectra)} records as scaled, {100.0 * damping:g} % damping."
        yield html.figure_of(drawn, said)


def _response(case: Case, done: pd.DataFrame) -> Iterator[html.Part]:
    if len(done) > 1 and case.scene.bodies:
        figure = suite_figure(case, done, _GROUPS, most=_MOST_BODIES)
        yield html.figure_of(figure, "Peak displacements over the length scale of the motions.")
