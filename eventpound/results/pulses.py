"""``pulses.csv``: the pulses fitted to records, a row for each record and kind."""

from __future__ import annotations

from collections.abc import Sequence

from eventpound.motion.characteristics import Characteristics
from eventpound.motion.pulse_fit import PulseFit
from eventpound.results.tables import rows_csv

PULSE_TABLE = "pulses.csv"
_SHAPE = ("gamma", "phase", "cycles")


def pulses_csv(records: Sequence[tuple[Characteristics, Sequence[PulseFit]]]) -> bytes:
    """Table of pulses as CSV.

    Parameters
    ----------
    records : sequence of (Characteristics, sequence of PulseFit)
        The records with their pulses, the best first.
    """
    rows = [_row(record, fit) for record, fits in records for fit in fits]
    return rows_csv([rows[0], *(row.values() for row in rows)])


def _row(record: Characteristics, fit: PulseFit) -> dict[str, object]:
    motion = fit.motion
    return {
        "file": record.data.file,
        "component": record.data.component or "",
        "pulse": fit.kind,
        "a_p": fit.a_p,
        "T_p": fit.T_p,
        "L_e": fit.length,
        "start": getattr(motion, "start"),  # noqa: B009
        "reverse": getattr(motion, "reverse"),  # noqa: B009
        **{key: getattr(motion, key, "") for key in _SHAPE},
        "fitted_to": fit.on,
        "explained": fit.explained,
    }
