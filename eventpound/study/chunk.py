"""A chunk of a study: its runs, and their rows of the table as text.

The rows of a chunk depend on nothing but the study and the chunk: not on the
number of workers, nor on what ran before.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

from eventpound.batch_response import BatchResponse
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.quantities.apart import avoiding_gaps
from eventpound.quantities.lookup import (
    FREE,
    is_whole,
    needs_accelerations,
    needs_free,
    needs_impacts,
    needs_one,
    values_of,
)
from eventpound.scene.parameters import places_of
from eventpound.scene.scene import Scene
from eventpound.study.plan import RECORD, Base, Chunk, Study
from eventpound.study.quantities import Results
from eventpound.study.table import MESSAGE, SUCCESS
from eventpound.study.variants import Rows, axis_values, rows_of
from eventpound.sweep import Columns, Sweep, Wanted


def header(study: Study) -> bytes:
    """Line of the names of the columns."""
    return _text([[*study.columns, *study.quantities, SUCCESS, MESSAGE]])


def compute(study: Study, chunk: Chunk, workers: int = 1) -> bytes:
    """Run a chunk.

    Parameters
    ----------
    study : Study
        Whose chunk it is.
    chunk : Chunk
        Which one.
    workers : int
        Threads of the fast solver.

    Returns
    -------
    bytes
        Its rows, CSV.
    """
    wanted = Wanted(study.solver, study.rtol, quantities=study.quantities)
    parts = parts_of(study.bases[chunk.base], chunk.low, chunk.high, wanted, workers)
    return b"".join(_text(zip(*_cells_of(study, part), strict=True)) for part in parts)


@dataclass(frozen=True)
class Refused:
    """Rows of a scene that cannot be run, all for the same reason.

    Parameters
    ----------
    base : Base
        The scene.
    low, high : int
        Which rows.
    error : InputError
        Why.
    """

    base: Base
    low: int
    high: int
    error: InputError


def parts_of(
    base: Base, low: int, high: int, wanted: Wanted, workers: int = 1
) -> Iterator[Results | Refused]:
    """Run rows of a scene, and give them in order.

    Parameters
    ----------
    base : Base
        The scene.
    low, high : int
        Which rows.
    wanted : Wanted
        What is kept of them; `keep` is given numbers of rows of the scene.
    workers : int
        Threads of the fast solver.
    """
    begun = low
    for refused in _unreadable(base, low, high):
        yield from _of_scenes(base, begun, refused.low, wanted, workers)
        yield refused
        begun = refused.high
    yield from _of_scenes(base, begun, high, wanted, workers)


def _of_scenes(
    base: Base, low: int, high: int, wanted: Wanted, workers: int
) -> Iterator[Results | Refused]:
    """Run rows, those of each record by themselves where it makes a scene of its own."""
    size = base.size_of_record if base.one_by_one else max(high - low, 1)
    first = low - low % size if base.one_by_one else low
    for start in range(first, high, size):
        own = max(start, low), min(start + size, high)
        yield from _halved(base, *own, wanted, workers)


def _unreadable(base: Base, low: int, high: int) -> Iterator[Refused]:
    """Rows whose records cannot be read."""
    size = base.size_of_record
    for number in range(low // size, -(-high // size)) if base.records else ():
        try:
            base.records[number].on(base.case.scene)
        except InputError as error:
            yield Refused(base, max(low, number * size), min(high, (number + 1) * size), error)


def _halved(
    base: Base, low: int, high: int, wanted: Wanted, workers: int
) -> Iterator[Results | Refused]:
    """Run rows; where a scene cannot be run at all, halve until it stands alone."""
    if low == high:
        return
    own = wanted
    if wanted.keep is not None:
        keep = wanted.keep
        own = replace(wanted, keep=lambda i, response: keep(low + i, response))
    try:
        results = results_of(rows_of(base, low, high), own, workers)
    except InputError as error:
        if high - low == 1:
            yield Refused(base, low, high, error)
        else:
            middle = (low + high) // 2
            yield from _halved(base, low, middle, wanted, workers)
            yield from _halved(base, middle, high, wanted, workers)
    else:
        yield results


def results_of(rows: Rows, wanted: Wanted, workers: int) -> Results:
    """Run rows.

    Raises
    ------
    InputError
        Where one of them cannot be run at all.
    """
    scene = rows.scene
    sweep = Sweep(rows, _of_sweep(scene, wanted, ""))
    own = sweep.run(workers)

    def instead(other: Scene, kept: Wanted) -> tuple[BatchResponse, Ints]:
        """Runs without contact; those that differ in their contacts only are one run."""
        places = places_of(scene)
        numbers = {key: v for key, v in rows.numbers.items() if places[key].kind != "contact"}
        motion_of = rows.motion_of
        columns = [*numbers.values(), *([] if motion_of is None else [motion_of.astype(float)])]
        first, which = distinct(columns, rows.count)
        assert rows.lengths is not None
        fewer = Columns(
            rows.base.case.apart(other),
            {key: column[first] for key, column in numbers.items()},
            rows.lengths[first],
            rows.motions,
            None if motion_of is None else motion_of[first],
            None if rows.scales is None else rows.scales.rows(first, rows.count),
        )
        return Sweep(fewer, kept).run(workers), which

    @cache
    def without_contact() -> tuple[BatchResponse, Ints]:
        bare = replace(scene, contacts=())
        return instead(bare, _of_sweep(bare, wanted, FREE))

    def free(name: str) -> Floats | None:
        many, which = without_contact()
        values = values_of(many, name)
        return None if values is None else values[which]

    @cache
    def apart() -> Floats:
        which: list[Ints] = []

        def run(other: Scene) -> BatchResponse:
            many, rows_of_many = instead(other, Wanted(wanted.solver, wanted.rtol))
            which[:] = [rows_of_many]
            return many

        gaps = avoiding_gaps(scene, run)
        return gaps[which[0]]

    return Results(rows, replace(own, free=free, apart=apart), sweep.seconds)


def _of_sweep(scene: Scene, wanted: Wanted, prefix: str) -> Wanted:
    """What a sweep has to keep: quantities of a prefix, which others are computed from."""
    named = [
        name.removeprefix(prefix)
        for name in wanted.quantities
        if name.startswith(FREE) == bool(prefix) and not needs_free(scene, name.removeprefix(FREE))
    ]
    return replace(
        wanted,
        accelerations=wanted.accelerations or needs_accelerations(scene, wanted.quantities),
        impacts=wanted.impacts or needs_impacts(scene, named),
        quantities=[name for name in named if needs_one(scene, name)],
        keep=None if prefix else wanted.keep,
    )


def _cells_of(study: Study, part: Results | Refused) -> Iterator[Sequence[object]]:
    """Columns of the table for some rows."""
    if isinstance(part, Refused):
        base, rows = part.base, range(part.low, part.high)
        values: Mapping[str, Floats] = axis_values(base, part.low, part.high)
    else:
        base, rows, values = part.rows.base, part.rows.at, part.rows.values
    count = len(rows)
    for name in study.columns:
        if name == RECORD and base.records:
            yield [base.records[row // base.size_of_record].name for row in rows]
        elif name in values:
            yield values[name].tolist()
        else:
            yield [base.labels.get(name, "")] * count
    if isinstance(part, Refused):
        yield from [[""] * count] * len(study.quantities)
        yield [False] * count
        yield [" ".join(str(part.error).split())] * count
        return
    for name in study.quantities:
        found = part.quantity(name)
        yield [""] * count if found is None else _cells(name, found)
    own = part.many
    yield own.success.tolist()
    yield ["" if good else m for good, m in zip(own.success, own.message, strict=True)]


def _cells(name: str, values: Floats) -> list[object]:
    """Cells of a column; nothing where a run has no such number, counts as whole numbers."""
    if is_whole(name):
        return ["" if value != value else int(value) for value in values.tolist()]
    return ["" if value != value else value for value in values.tolist()]


def _text(rows: Iterable[Sequence[object]]) -> bytes:
    """Lines of a CSV file; every number reads back as the same double."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()
