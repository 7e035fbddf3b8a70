"""The figures of a suite's case, chosen by its ``[figure]``."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path, PurePath
from types import MappingProxyType

import pandas as pd
from matplotlib.figure import Figure

from eventpound.case.case import Case, member_case, member_of
from eventpound.case.figure import Figure as Wanted
from eventpound.case.figure import FigureKind
from eventpound.case.record_file import find_record
from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.pulse_fit import fit_pulse
from eventpound.motion.record import Record
from eventpound.report.bridge_response import bridge_response_figure
from eventpound.report.notes import add_notes
from eventpound.report.pulse_fit import record_scales_figure
from eventpound.report.similarity_contours import similarity_contours_figure
from eventpound.report.style import Paper, on_paper
from eventpound.report.suite_spectrum import suite_spectrum_figure
from eventpound.report.view import View
from eventpound.results import gather, write_together
from eventpound.simulation import response_of


def plot_suite(
    case: Case,
    table: pd.DataFrame,
    directory: str | os.PathLike[str],
    *,
    solver: str | None = None,
    rtol: float | None = None,
    paper: Paper | None = None,
) -> list[Path]:
    """Draw the figures of a suite and write them, all or none.

    Parameters
    ----------
    case : Case
        Of the suite; without ``[figure]`` it gets its spectrum.
    table : DataFrame
        As `eventpound.simulate_suite` returns it.
    directory : path
        Where they go.
    solver, rtol : optional
        What computes the response to a single record, instead of the case's own.
    paper : Paper, optional
        Kinds of files, width and resolution; PNG by default.

    Returns
    -------
    list of Path
        What was written; nothing where no record is left to draw.
    """
    done = table[table["failed"] == ""]
    if done.empty:
        return []
    by = (solver or case.solver.name, rtol or case.solver.rtol)
    plain = Wanted(FigureKind.SUITE_SPECTRUM, name=FigureKind.SUITE_SPECTRUM.value)
    drawn = {f"{each.name}.png": _drawn(case, each, done, by) for each in case.figures or (plain,)}
    return write_together(directory, on_paper(drawn, paper or Paper()))


def _drawn(case: Case, wanted: Wanted, done: pd.DataFrame, by: tuple[str, float]) -> Figure:
    """One figure of a suite; a single response is computed by a solver at a tolerance."""
    title = (wanted.title or case.title) + kind_of_motions(done)
    named = named_lengths(case, wanted)
    match wanted.kind:
        case FigureKind.RECORD_SCALES:
            drawn = _scales_figure(case, wanted, list(done["record"]), title)
        case FigureKind.SIMILARITY_CONTOURS:
            known = done[done["L_e"].notna()]
            names = [PurePath(name).stem for name in known["record"]]
            lengths = known["L_e"].to_numpy()
            drawn = similarity_contours_figure(lengths, names, wanted, title, named)
        case FigureKind.BRIDGE_RESPONSE:
            name = done["record"].iloc[0]
            member = member_of(case, name)
            one = member_case(case, member, member.read())
            run = response_of(one, *by)
            view = View(gather(run, one), one.scene)
            drawn = bridge_response_figure(view, f"{title}: {PurePath(name).name}")
        case _:
            drawn = suite_figure(case, done, wanted.groups, title, called=wanted.names)
    gone = "; ".join(motion.name for motion in wanted.motions if motion.name not in named)
    left_out = f"Left out, their records cannot be read here: {gone}." if gone else ""
    add_notes(drawn, [wanted.note, left_out])
    return drawn


def suite_figure(
    case: Case,
    done: pd.DataFrame,
    groups: int,
    title: str = "",
    most: int | None = None,
    called: Mapping[str, str] = MappingProxyType({}),
) -> Figure:
    """The peaks of the bodies of a case, or of the first of them, called as is said."""
    bodies = [body.name for body in case.scene.bodies][:most]
    names = {body: called.get(body, body) for body in bodies}
    return suite_spectrum_figure(done, names, groups, title)


def named_lengths(case: Case, wanted: Wanted) -> dict[str, float]:
    """L_e (m) of the motions that a figure names; records that are not here are left out.

    Parameters
    ----------
    case : Case
        To whose directory files are relative.
    wanted : Figure of a case
        With the motions.
    """
    found = {}
    for motion in wanted.motions:
        if motion.file is None:
            assert motion.length is not None
            found[motion.name] = motion.length
            continue
        try:
            data = read_record(find_record(motion.file, case.directory))
        except InputError:
            continue
        scales = Record(data.acceleration, data.time_step).scales()
        if scales is not None:
            found[motion.name] = scales.length
    return found


def _scales_figure(case: Case, wanted: Wanted, records: list[str], title: str) -> Figure:
    """The first record with its pulse, the last without."""
    members = [member_of(case, name) for name in (records[0], records[-1])]
    pulsed, plain = (member.options.motion(member.read()) for member in members)
    names = [PurePath(member.name).name for member in members]
    assert case.suite is not None
    if wanted.added_pulse is not None and case.suite.synthetic:
        pulse = wanted.added_pulse
        values = pulsed.values + pulse.acceleration(pulsed.times)
        pulsed = Record(values, pulsed.time_step, start=pulsed.start)
        names[0] += f" with a {pulse.kind} pulse added"
    best = fit_pulse(pulsed, wanted.pulses)[0]
    return record_scales_figure(pulsed, best, plain, names, title)


def kind_of_motions(done: pd.DataFrame) -> str:
    """Synthetic motions are called so wherever they appear."""
    synthetic = done["record"].str.contains(r"(?:^|/)synthetic-\d", regex=True)
    if synthetic.all():
        return " (synthetic)"
    return " (some of the motions are synthetic)" if synthetic.any() else ""
