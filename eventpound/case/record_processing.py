"""``processing`` of a record: what is done to its samples before they are scaled."""

from __future__ import annotations

import math

from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.motion.processing import Processing
from eventpound.units import Dimension


def read_processing(table: Table) -> Processing | None:
    """Read ``processing = { baseline, highpass, lowpass, order }``.

    Parameters
    ----------
    table : Table
        The table; empty where it is not given.

    Returns
    -------
    Processing or None
        None where there are problems; they are noted.
    """
    whole = {key: _whole_number(table, key) for key in ("baseline", "order")}
    corners = {
        key: table.optional_quantity(key, Dimension.FREQUENCY) for key in ("highpass", "lowpass")
    }
    table.close()
    if any(x is not None and math.isnan(x) for x in (*whole.values(), *corners.values())):
        return None
    baseline, order = whole["baseline"], whole["order"]
    try:
        return Processing(
            None if baseline is None else int(baseline),
            corners["highpass"],
            corners["lowpass"],
            4 if order is None else int(order),
        )
    except InputError as error:
        table.report("", str(error))
        return None


def _whole_number(table: Table, key: str) -> float | None:
    """A whole number; None where it is not given, NaN where it is wrong."""
    if not table.has(key):
        return None
    value = table.data[key]
    if isinstance(value, bool) or not isinstance(value, int):
        table.reject(key, "a whole number")
        return math.nan
    return value
