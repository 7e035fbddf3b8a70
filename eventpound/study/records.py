"""What the table of a suite tells of its records, and how far a run is off there."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import suppress
from functools import lru_cache

import numpy as np

from eventpound.accuracy.judge import rtol_of_judge
from eventpound.case.case import Case
from eventpound.case.suite import KEPT, Member, where_beside
from eventpound.errors import EventpoundError
from eventpound.motion.intensity import peak_velocity
from eventpound.motion.readers.base import RecordData
from eventpound.motion.record import Record
from eventpound.motion.scaling import DAMPING, psa_of
from eventpound.numerics.arrays import Floats
from eventpound.scene.at_rest import at_rest
from eventpound.scene.periods import longest_period
from eventpound.scene.plausibility import motion_doubts
from eventpound.solvers.base import Extremes
from eventpound.study.runs import Results
from eventpound.study.sweep import Sweep, WantedRuns

FILE, FAILED = "file", "failed"
UNLIKELY = "hardly meant: "
"""Begins notes on what is possible but unlike earthquakes."""
SA = "Sa_T1"
"""Column of Sa of each record, of the period and damping of `sa_of_suite`."""
_IDENTITY = (
    *("event", "date", "station", "component", "format", "sha256", "samples", "time_step", "notes"),
)
_SCALES, _MEASURES = ("scale", "PGA", "T_m", "omega_g", "L_e"), ("PGV", SA)
_READ = "seconds.read"


def record_columns(members: Sequence[Member], measured: bool) -> tuple[str, ...]:
    """Columns of a suite that tell of its records, perhaps with PGV and Sa."""
    beside = [name for name, _ in members[0].beside]
    own = [f"{key}.{name}" for name in beside for key in (FILE, "sha256", "PGA")]
    measures = _MEASURES if measured else ()
    return ("record", FILE, FAILED, *_IDENTITY, *own, *_SCALES, *measures, _READ)


def sa_of_suite(case: Case) -> tuple[float, float]:
    """Period (s) and damping at which Sa of its records is told.

    Where a case scales by Sa that which it asks for, else T1 of the scene as a run begins, NaN
    where nothing resists, and 5 %.
    """
    if case.size.psa_period is not None:
        damping = case.size.psa_damping
        return case.size.psa_period, DAMPING if damping is None else damping
    return longest_period(at_rest(case.scene, case.run.start_time)) or math.nan, DAMPING


def about(member: Member, sa: tuple[float, float] | None) -> dict[str, object]:
    """What a record is, as its file says, and its scales as it is used (SI).

    With PGV and Sa at a period (s) and damping where they are given.
    """
    row: dict[str, object] = {"record": member.name, FILE: member.file, FAILED: ""}
    began = time.perf_counter()
    try:
        motion = member.motion()
        assert motion.source is not None
        row |= _identity(motion.source)
        doubts = [f"{UNLIKELY}{text}" for _, text in motion_doubts(motion)]
        scales = motion.scales()
        row |= {f"{FILE}.{name}": own.file for name, own in member.beside}
        for name, moved in member.motions_beside().items():
            row[f"sha256.{name}"] = None if moved.source is None else moved.source.sha256
            row[f"PGA.{name}"] = moved.peak
            own_doubts = motion_doubts(moved)
            doubts += [f"{UNLIKELY}{where_beside(name)}{text}" for _, text in own_doubts]
        row["notes"] = "; ".join((*motion.source.notes, *doubts))
    except EventpoundError as error:
        row[FAILED] = reason(str(error), member.file)
        with suppress(EventpoundError):
            row |= _identity(member.read())
        return row
    known = (math.nan, math.nan) if scales is None else (scales.omega_g, scales.length)
    sizes = (motion.largest_factor, motion.peak, motion.mean_period)
    row |= zip(_SCALES, (*sizes, *known), strict=True)
    if sa is not None:
        row |= zip(_MEASURES, _measures(motion, *sa), strict=True)
    row[_READ] = time.perf_counter() - began
    return row


@lru_cache(KEPT)
def _measures(motion: Record, period: float, damping: float) -> tuple[float, float]:
    """PGV (m/s), and Sa (m/s^2), NaN where there is no period."""
    if math.isnan(period):
        return peak_velocity(motion), math.nan
    sa = psa_of(motion.values, motion.time_step, np.array([period]), damping)[0]
    return peak_velocity(motion), float(sa)


def _identity(data: RecordData) -> dict[str, object]:
    """What a record is, as its file says."""
    words = (data.event or "", data.date or "", data.station or "", data.component or "")
    samples = (data.acceleration.size, data.time_step, "; ".join(data.notes))
    return dict(zip(_IDENTITY, (*words, data.format, data.sha256, *samples), strict=True))


def reason(message: str, file: str) -> str:
    """Why a record has no numbers; its file is a column of its own."""
    lines = (line.removeprefix(file).lstrip(":, ") for line in message.splitlines())
    return "; ".join(lines)


def peak_errors(part: Results, solver: str, rtol: float) -> Floats:
    """Differences of the peaks from those of finer runs, relative to the largest, shape (n,).

    A run whose finer one failed is marked as failed.
    """
    better = Sweep(part.rows, WantedRuns(solver, rtol_of_judge(rtol, solver, itself=True))).run()
    many = part.many
    for i in np.flatnonzero(many.success & ~better.success).tolist():
        many.success[i], many.message[i], many.t[i] = False, better.message[i], better.t[i]
    peaks = _peak_displacements(better.displacement)
    largest, error = peaks.max(axis=1), abs(_peak_displacements(many.displacement) - peaks)
    return np.where(largest == 0.0, 0.0, error.max(axis=1) / np.where(largest, largest, 1.0))


def _peak_displacements(displacement: Extremes) -> Floats:
    """Largest displacement of every body in size (m), of the shape of the extremes."""
    return np.maximum(displacement.maximum, -displacement.minimum)
