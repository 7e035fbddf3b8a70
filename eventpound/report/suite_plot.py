"""The figure of a suite's case, chosen by its ``[figure]``."""

from __future__ import annotations

import os
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

import numpy as np

from eventpound.case.case import Case
from eventpound.case.figure import Figure as Wanted
from eventpound.case.figure import FigureKind
from eventpound.case.member import member_case
from eventpound.case.record_file import find_record
from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.pulse_fit import fit_pulse
from eventpound.motion.record import Record
from eventpound.report.bridge_response import bridge_response_figure
from eventpound.report.notes import add_notes
from eventpound.report.record_scales import record_scales_figure
from eventpound.report.similarity_contours import similarity_contours_figure
from eventpound.report.style import Paper, on_paper
from eventpound.report.suite_spectrum import suite_spectrum_figure
from eventpound.report.view import View
from eventpound.results import gather, write_together
from eventpound.simulation import simulate

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
    paper: Paper | None = None,
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
    wanted = case.figure or Wanted(FigureKind.SUITE_SPECTRUM)
    title = case.title + kind_of_motions(done)
    drawn = _figure(case, wanted, done, title, solver or case.solver.name, rtol or case.solver.rtol)
    add_notes(drawn, [wanted.note, _left_out(case, wanted)])
    name = f"{wanted.kind.value}.png"
    return write_together(directory, on_paper({name: drawn}, paper or Paper()))


def _figure(
    case: Case, wanted: Wanted, done: pd.DataFrame, title: str, solver: str, rtol: float
) -> Figure:
    match wanted.kind:
        case FigureKind.RECORD_SCALES:
            return _scales_figure(case, wanted, list(done["record"]), title)
        case FigureKind.SIMILARITY_CONTOURS:
            known = done[done["L_e"].notna()]
            names = [PurePath(name).stem for name in known["record"]]
            lengths = known["L_e"].to_numpy()
            named = named_lengths(case, wanted)
            return similarity_contours_figure(lengths, names, wanted, title, named)
        case FigureKind.BRIDGE_RESPONSE:
            one = _case_of(case, done["record"].iloc[0])
            view = View(gather(simulate(one, solver, rtol), one), one.scene)
            name = PurePath(done["record"].iloc[0]).name
            return bridge_response_figure(view, f"{title}: {name}")
        case FigureKind.SUITE_SPECTRUM:
            bodies = [body.name for body in case.scene.bodies]
            called = {body: wanted.names.get(body, body) for body in bodies}
            return suite_spectrum_figure(done, called, wanted.groups, title)


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


def _left_out(case: Case, wanted: Wanted) -> str:
    """Motions that a figure names and does not show."""
    found = named_lengths(case, wanted)
    gone = [motion.name for motion in wanted.motions if motion.name not in found]
    return f"Left out, their records cannot be read here: {'; '.join(gone)}." if gone else ""


def _scales_figure(case: Case, wanted: Wanted, records: list[str], title: str) -> Figure:
    """The first record with its pulse, the last without."""
    pulsed, plain = (_record_of(case, name) for name in (records[0], records[-1]))
    names = [PurePath(record).name for record in (records[0], records[-1])]
    assert case.suite is not None
    if wanted.added_pulse is not None and case.suite.synthetic:
        pulse = wanted.added_pulse
        t = pulsed.start + pulsed.time_step * np.arange(pulsed.samples.size, dtype=np.float64)
        pulsed = Record(pulsed.values + pulse.acceleration(t), pulsed.time_step, start=pulsed.start)
        names[0] += f" with a {pulse.kind} pulse added"
    best = fit_pulse(pulsed, wanted.pulses)[0]
    return record_scales_figure(pulsed, best, plain, names, title)


def _case_of(case: Case, name: str) -> Case:
    """The case of one record of a suite."""
    assert case.suite is not None
    (member,) = (m for m in case.suite.members(case.directory) if m.name == name)
    return member_case(case, member, member.read())


def _record_of(case: Case, name: str) -> Record:
    assert case.suite is not None
    (member,) = (m for m in case.suite.members(case.directory) if m.name == name)
    return member.options.motion(member.read())


def kind_of_motions(done: pd.DataFrame) -> str:
    """Synthetic motions are called so wherever they appear."""
    synthetic = done["record"].str.contains(r"(?:^|/)synthetic-\d", regex=True)
    if synthetic.all():
        return " (synthetic)"
    return " (some of the motions are synthetic)" if synthetic.any() else ""
