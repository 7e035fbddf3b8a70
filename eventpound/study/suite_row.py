"""What one record of a suite leaves in the table, by the paths it has in ``summary.json``."""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.case.case import Case
from eventpound.errors import ComputationError, EventpoundError
from eventpound.motion.readers.base import RecordData
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.response import Response
from eventpound.results.summary import contacts_of, peaks_of

_OF_CONTACT = ("impacts", "resting_time", "max_impulse", "smallest_gap")


def identity(data: RecordData) -> dict[str, object]:
    """What a record is, as its file says."""
    return {
        "event": data.event or "",
        "date": data.date or "",
        "station": data.station or "",
        "component": data.component or "",
        "format": data.format,
        "sha256": data.sha256,
        "samples": data.acceleration.size,
        "time_step": data.time_step,
        "notes": "; ".join(data.notes),
    }


def scales_row(one: Case) -> dict[str, object]:
    """Scales of a record as it is used: PGA (m/s^2), T_m (s), omega_g (rad/s), L_e (m)."""
    motion = one.scene.motion
    assert isinstance(motion, Record)
    scales = motion.scales()
    return {
        "PGA": scales.a_g,
        "T_m": scales.period,
        "omega_g": scales.omega_g,
        "L_e": scales.length,
    }


def response_row(response: Response) -> dict[str, object]:
    """Peaks, residuals, impacts and resting time of a run, and what it cost."""
    row: dict[str, object] = {}
    for body, peaks in peaks_of(response).items():
        row |= {f"peaks.{body}.{key}": value for key, value in peaks.items()}
    for i, one in enumerate(response.scene.bodies):
        row[f"residual.{one.name}"] = float(response.recording.u[i])
    row["impacts"] = response.impacts
    row["resting_time"] = float(np.sum(response.recording.resting_time))
    contacts: dict[str, dict[str, Any]] = contacts_of(response, {})
    for name, contact in contacts.items():
        row |= {f"contacts.{name}.{key}": float(contact[key]) for key in _OF_CONTACT}
    row["t_final"] = response.recording.t
    row["work.steps"] = response.work.steps
    row["seconds.solve"] = response.work.seconds
    return row


def peak_displacements(response: Response) -> Floats:
    """Largest displacement of every body in size, shape (N,) (m)."""
    x = response.recording.displacement
    return np.maximum(x.maximum, -x.minimum)


def failed_row(error: EventpoundError, file: str) -> dict[str, object]:
    """Why a record has no numbers; its file is a column of its own."""
    where = {"t_final": error.time} if isinstance(error, ComputationError) else {}
    lines = (line.removeprefix(file).lstrip(":, ") for line in str(error).splitlines())
    return {"failed": "; ".join(lines), **where}
