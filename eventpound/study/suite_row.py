"""What one record of a suite leaves in the table: what it is, and quantities by their names."""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.case.case import Case
from eventpound.errors import ComputationError, EventpoundError
from eventpound.motion.readers.base import RecordData
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.response import Response


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
    """Every quantity of a run that needs no further one, and what it cost."""
    row: dict[str, Any] = response.numbers()
    # Numbers of a contact may be missing in a row: its columns have no whole ones.
    of_contacts = {k: v for k, v in row.items() if k.startswith("contacts.") and v is not None}
    row |= {name: float(value) for name, value in of_contacts.items()}
    return {**row, "seconds.solve": response.work.seconds}


def peak_displacements(response: Response) -> Floats:
    """Largest displacement of every body in size, shape (N,) (m)."""
    x = response.recording.displacement
    return np.maximum(x.maximum, -x.minimum)


def failed_row(error: EventpoundError, file: str) -> dict[str, object]:
    """Why a record has no numbers; its file is a column of its own."""
    where = {"t_final": error.time} if isinstance(error, ComputationError) else {}
    lines = (line.removeprefix(file).lstrip(":, ") for line in str(error).splitlines())
    return {"failed": "; ".join(lines), **where}
