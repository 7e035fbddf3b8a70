"""Records one after the other, with rest between them: a mainshock and its aftershocks.

They become one record of the smallest of their time steps. Of each other the samples between its
own lie on the straight lines that its motion has there, so that no motion changes. From the last
sample of a record to the rest, and from the rest to the first of the next, the motion goes in a
time step.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import RecordData
from eventpound.numerics.arrays import Floats
from eventpound.tolerances import SAME_SAMPLE


def in_sequence(records: Sequence[RecordData], rest: float) -> RecordData:
    """Records as one, which says where each begins.

    Parameters
    ----------
    records : sequence of RecordData
        In their order, one at least.
    rest : float
        From the last sample of one to the first of the next (s), to a whole time step.

    Raises
    ------
    InputError
        Where a time step is no multiple of the smallest.
    """
    dt = min(record.time_step for record in records)
    still = np.zeros(max(round(rest / dt) - 1, 1))
    parts: list[Floats] = []
    begins: list[int] = []
    for record in records:
        # At the last sample of the rest before it.
        begins.append(sum(part.size for part in parts) - 1 if parts else 0)
        parts += [_at_step(record, dt), still]
    hashes = "".join(record.sha256 for record in records)
    return RecordData(
        acceleration=np.concatenate(parts[:-1]),
        time_step=dt,
        units=_each(record.units for record in records),
        format=_each(record.format for record in records),
        file=_each(PurePath(record.file).name for record in records),
        sha256=hashlib.sha256(hashes.encode()).hexdigest(),
        notes=tuple(note for record in records for note in record.notes),
        begins=tuple(begins),
        event=" + ".join(record.event or PurePath(record.file).stem for record in records),
        shocks=tuple(record.called for record in records),
    )


def times_each(sequence: RecordData, factors: Sequence[float]) -> RecordData:
    """A sequence with each of its records multiplied by a factor of its own.

    Parameters
    ----------
    sequence : RecordData
        As `in_sequence` made it.
    factors : sequence of float
        One for each record.
    """
    sizes = np.diff([*sequence.begins, sequence.acceleration.size])
    samples = sequence.acceleration * np.repeat(factors, sizes)
    return replace(sequence, acceleration=samples, factors=tuple(factors))


def begun_with(first: RecordData, second: RecordData) -> RecordData:
    """A sequence whose records begin where those of another do, of which it is a component.

    Components of one shock may differ by some samples, and the rest between shocks takes that up.

    Raises
    ------
    InputError
        Where it has another number of records, or one reaches into the next.
    """
    if len(first.begins) != len(second.begins):
        raise InputError(
            f"found {len(second.begins) or 1} records for the {len(first.begins) or 1} of the "
            "first component; accepted: as many"
        )
    begins = [round(begin * first.time_step / second.time_step) for begin in first.begins]
    parts = [np.trim_zeros(part, "b") for part in records_of(second)]
    samples = np.zeros(begins[-1] + parts[-1].size if begins else 0)
    for i, (begin, part) in enumerate(zip(begins, parts, strict=False)):
        end = begin + part.size
        if end >= (*begins, samples.size + 1)[i + 1]:
            raise InputError(
                f"found {second.shocks[i]}, which goes on when the next shock of the first "
                "component begins; accepted: a longer rest"
            )
        samples[begin:end] = part
    return replace(second, acceleration=samples, begins=tuple(begins)) if begins else second


def records_of(sequence: RecordData) -> list[Floats]:
    """Samples of each record of a sequence, with the rest before the next (m/s^2)."""
    return np.split(sequence.acceleration, sequence.begins[1:])


def _at_step(record: RecordData, dt: float) -> Floats:
    """Samples of a record at a smaller time step (s)."""
    times = round(record.time_step / dt)
    if abs(record.time_step - times * dt) > SAME_SAMPLE * dt:
        raise InputError(
            f"{record.file}: found a time step of {record.time_step:g} s beside {dt:g} s; "
            "accepted: whole multiples of the smallest, in a sequence"
        )
    own = np.arange(record.acceleration.size, dtype=np.float64)
    within = np.arange((own.size - 1) * times + 1) / times
    return np.interp(within, own, record.acceleration)


def _each(words: Iterable[str]) -> str:
    """Words that differ, in their order."""
    return ", ".join(dict.fromkeys(words))
