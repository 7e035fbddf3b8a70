"""Which runs of a study, or of a suite, scale their record by more than the limit of the case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from eventpound.basics.told import OptionWarning, warn_caller
from eventpound.case.record_scaling import large_scales
from eventpound.errors import InputError
from eventpound.motion.record import Record
from eventpound.scene.parameters import motion_with, number_places
from eventpound.study.base import Base
from eventpound.study.variants import axis_values, rows_with


def large_scales_of(bases: Sequence[Base]) -> str:
    """A sentence on them; empty where there are none. Records are read, nothing is run."""
    limit = max(base.case.largest_scale for base in bases)
    return large_scales([pair for base in bases for pair in _factors(base)], limit)


def warn_of_scales(bases: Sequence[Base]) -> None:
    """Warn a call in Python of them, in one line."""
    if text := large_scales_of(bases):
        warn_caller(text, OptionWarning)


def _factors(base: Base) -> Iterator[tuple[str, float]]:
    """Factor on the record of each run, by its name; none on one that cannot be read."""
    for member in base.records:
        if member.synthetic is not None:
            # It has no size of its own to be scaled from, and takes long to make.
            continue
        try:
            yield from ((member.name, f) for f in _over_axes(base.under(member)))
            for name, own in member.beside:
                if not own.options.follows:
                    yield f"{own.name} at {name}", own.motion().largest_factor
        except InputError:
            # Its run says so.
            continue
    motion = base.case.scene.motion
    if not base.records and isinstance(motion, Record):
        yield from ((motion.called, f) for f in _over_axes(base))


def _over_axes(base: Base) -> Iterator[float]:
    """Factors on the record of a scene over its axes; none where its motion is no record."""
    scene, size = base.case.scene, base.size_of_record
    if not isinstance(scene.motion, Record):
        return
    places = number_places(scene)
    numbers = rows_with(base, axis_values(base, 0, size), range(size)).numbers
    moving = {places[k]: v for k, v in numbers.items() if places[k].kind == "excitation"}
    columns = np.array([*moving.values()]).reshape(len(moving), size)
    each, count = np.unique(columns, axis=1, return_counts=True)
    for values, runs in zip(each.T.tolist(), count.tolist(), strict=True):
        changed = motion_with(scene.motion, dict(zip(moving, values, strict=True)))
        assert isinstance(changed, Record)
        yield from [changed.largest_factor] * runs
