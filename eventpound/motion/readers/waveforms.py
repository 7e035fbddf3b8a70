"""SAC and miniSEED (SEED with headers, too), read by ObsPy, an optional extra.

miniSEED usually has counts, which need the sensitivity of the instrument: from a StationXML
file, ``response``, or as the unit of a count, ``units = "2.3e-6 m/s2"``. A SAC header has no
unit (``IDEP`` says that the numbers are accelerations, and would have them in nm/s^2, which
few writers heed), so it has to be given.
"""

from __future__ import annotations

import importlib
import io
import re
import struct
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source, UnstatedError
from eventpound.motion.readers.header import Header, record_data, unit_factor

_MINISEED = re.compile(rb"\d{6}[DRQMVAST][ \x00*]|MS\x03")
_SAC_HEADER_BYTES = 632
_VERSION_AT, _COUNT_AT, _KIND_AT = 304, 316, 344
_VERSIONS = (6, 7)
_VELOCITY_AND_DISPLACEMENT = (7, 6)


def _sac_byte_order(source: Source) -> str | None:
    """``<`` or ``>``; None unless version and number of samples are where SAC has them."""
    size = len(source.content)
    if size < _SAC_HEADER_BYTES:
        return None
    for order in "<>":
        version = _integer(source, order, _VERSION_AT)
        count = _integer(source, order, _COUNT_AT)
        if version in _VERSIONS and 0 < _SAC_HEADER_BYTES + 4 * count <= size:
            return order
    return None


def _integer(source: Source, order: str, at: int) -> int:
    return int(struct.unpack_from(order + "i", source.content, at)[0])


def _sac_channels(source: Source, given: Given) -> list[Channel]:
    """The one component, unless the header says velocities or displacements."""
    order = _sac_byte_order(source)
    if order is not None and _integer(source, order, _KIND_AT) in _VELOCITY_AND_DISPLACEMENT:
        raise source.error(None, "its header says velocities or displacements, not accelerations")
    return _waveform_channels(source, given, SAC.name, "SAC")


SAC = Reader("sac", lambda source: _sac_byte_order(source) is not None, _sac_channels)
MINISEED = Reader(
    "miniseed",
    lambda source: bool(_MINISEED.match(source.content)),
    lambda source, given: _waveform_channels(source, given, "miniseed", "MSEED"),
)


def _waveform_channels(source: Source, given: Given, format: str, obspy_name: str) -> list[Channel]:
    """The traces of a file, named by their channel code.

    Raises
    ------
    InputError
        Without ObsPy, for what ObsPy cannot read, or a trace with gaps.
    """
    obspy = _obspy(source, format)
    try:
        with warnings.catch_warnings(action="ignore"):
            stream = obspy.read(io.BytesIO(source.content), format=obspy_name)
    except Exception as error:  # ObsPy raises what its parsers happen to raise
        raise source.error(None, f"ObsPy cannot read it as {obspy_name}: {error}") from error
    _refuse_gaps(source, stream)

    def channel(trace: Any) -> Channel:
        def read() -> RecordData:
            return _read_trace(source, given, format, trace)

        return Channel(trace.stats.channel or None, read, (trace.id,))

    return [channel(trace) for trace in stream]


def _obspy(source: Source, format: str) -> Any:
    """ObsPy; what it warns of while it is imported is no matter of who reads a record."""
    try:
        with warnings.catch_warnings(action="ignore"):
            return importlib.import_module("obspy")
    except ImportError as error:
        raise InputError(
            f"{source.file}: a file in the format '{format}' is read by ObsPy, which is not "
            "installed; pip install 'eventpound[obspy]'"
        ) from error


def _refuse_gaps(source: Source, stream: Sequence[Any]) -> None:
    """Stop where a channel comes in several pieces."""
    names = [trace.id for trace in stream]
    for name in names:
        if names.count(name) > 1:
            raise source.error(
                None, f"channel {name} comes in {names.count(name)} pieces, with gaps between them"
            )


def _read_trace(source: Source, given: Given, format: str, trace: Any) -> RecordData:
    """One trace; its unit is never in the file."""
    stats = trace.stats
    units: str | None = None
    notes: tuple[str, ...] = ()
    if given.response is not None:
        units, note = _sensitivity(source, given.response, trace)
        notes = (note,)
    elif np.issubdtype(trace.data.dtype, np.integer) and not _is_of_counts(given.units):
        raise UnstatedError(
            f"{source.file}: channel {trace.id} holds whole numbers, counts and not "
            'accelerations; give response = "FILE.xml" (StationXML), or the unit of a count, '
            'units = "2.3e-6 m/s2"',
            ["response", "units"],
        )
    header = Header(
        units=units,
        time_step=float(stats.delta),
        station=".".join(part for part in (stats.network, stats.station) if part) or None,
        component=stats.channel or None,
        date=str(stats.starttime),
    )
    values = np.asarray(trace.data, dtype=float)
    return record_data(source, format, header, values, given, notes)


def _is_of_counts(units: str | None) -> bool:
    """Whether a unit has a number before it, as that of a count would."""
    return units is not None and unit_factor(units) != unit_factor(units.split()[-1])


def _sensitivity(source: Source, response: str, trace: Any) -> tuple[str, str]:
    """The unit of a count from a StationXML file, and a note on it."""
    obspy = _obspy(source, "StationXML")
    try:
        with warnings.catch_warnings(action="ignore"):
            inventory = obspy.read_inventory(response)
        found = inventory.get_response(trace.id, trace.stats.starttime).instrument_sensitivity
    except Exception as error:  # as above
        raise InputError(
            f"{source.file}: response = '{response}' has none for channel {trace.id}: {error}"
        ) from error
    if str(found.input_units).upper() not in ("M/S**2", "M/S^2", "M/S/S"):
        raise InputError(
            f"{source.file}: response = '{response}': channel {trace.id} measures "
            f"{found.input_units}; an accelerometer (M/S**2) is needed"
        )
    return (
        f"{1.0 / found.value!r} m/s2",
        f"divided by the sensitivity of {trace.id}, {found.value:g} counts per m/s2; "
        "the frequency response of the instrument is not removed",
    )
