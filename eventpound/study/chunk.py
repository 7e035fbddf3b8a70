"""A chunk of a study: its runs, and their rows of the table as text.

The rows of a chunk depend on nothing but the study and the chunk: not on the
number of workers, nor on what ran before.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from eventpound.batch_response import (
    BatchResponse,
    blank_many,
    keep_named,
    keep_recording,
    mark_failed,
)
from eventpound.case.case import Case
from eventpound.errors import ComputationError, InputError
from eventpound.many import simulate_many
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.quantities import FREE, is_whole, needs_energy, needs_one, values_of
from eventpound.scene.check import check_scene
from eventpound.scene.parameters import places_of, with_values
from eventpound.simulation import simulate
from eventpound.study.axes import values_of_rows
from eventpound.study.plan import FAST, Chunk, Study
from eventpound.study.quantities import Results, needs_accelerations, without_contacts
from eventpound.study.table import MESSAGE, SUCCESS
from eventpound.study.variants import Rows, rows_of


def header(study: Study) -> bytes:
    """Line of the names of the columns."""
    return _text([[*study.columns, *study.quantities, SUCCESS, MESSAGE]])


def compute(study: Study, chunk: Chunk, workers: int | None = 1) -> bytes:
    """Run a chunk.

    Parameters
    ----------
    study : Study
        Whose chunk it is.
    chunk : Chunk
        Which one.
    workers : int, optional
        Threads of the fast solver; None for as many as there are cores.

    Returns
    -------
    bytes
        Its rows, CSV.
    """
    return _compute(study, chunk, workers)


def _compute(study: Study, chunk: Chunk, workers: int | None) -> bytes:
    """Run rows; where a scene cannot be run at all, halve until it stands alone."""
    base, low, high = study.bases[chunk.base], chunk.low, chunk.high
    try:
        rows = rows_of(base, low, high)
        return _rows_text(study, rows, _results(study, rows, workers))
    except InputError as error:
        if high - low == 1:
            return _refused(study, chunk, error)
    middle = (low + high) // 2
    halves = (replace(chunk, high=middle), replace(chunk, low=middle))
    return b"".join(_compute(study, half, workers) for half in halves)


def _results(study: Study, rows: Rows, workers: int | None) -> Results:
    case = rows.base.case
    own = _run(study, case, rows.numbers, rows.durations, workers)

    @cache
    def without_contact() -> tuple[BatchResponse, Ints]:
        """Runs without contact; those that differ in their contacts only are one run."""
        places = places_of(case.scene)
        numbers = {key: v for key, v in rows.numbers.items() if places[key].kind != "contact"}
        if not numbers:
            body = case.scene.bodies[0]
            numbers = {f"body.{body.name}.mass": np.full(rows.count, body.mass)}
        first, which = distinct(list(numbers.values()), rows.count)
        apart = replace(case, scene=without_contacts(case.scene))
        fewer = {key: column[first] for key, column in numbers.items()}
        scales = None if rows.scales is None else rows.scales.rows(first, rows.count)
        many = _run(study, apart, fewer, rows.durations[first], workers, FREE)
        return replace(many, scales=scales), which

    def free(name: str) -> Floats | None:
        many, which = without_contact()
        values = values_of(many, name)
        return None if values is None else values[which]

    return Results(rows, replace(own, scales=rows.scales, free=free))


def _run(
    study: Study,
    case: Case,
    numbers: Mapping[str, Floats],
    durations: Floats,
    workers: int | None,
    prefix: str = "",
) -> BatchResponse:
    """Runs of variants of a case on the solver of the study, with quantities of a prefix."""
    accelerations = needs_accelerations(case.scene, study.quantities)
    named = [
        name.removeprefix(prefix)
        for name in study.quantities
        if name.startswith(FREE) == bool(prefix) and needs_one(case.scene, name)
    ]
    if study.solver == FAST:
        return simulate_many(
            case,
            numbers,
            rtol=study.rtol,
            duration=durations,
            accelerations=accelerations,
            quantities=named,
            workers=workers,
        )
    places = places_of(case.scene)
    many = blank_many(case.scene, numbers, accelerations, named)
    energy = needs_energy(named) or None
    for i, duration in enumerate(durations.tolist()):
        values = {places[key]: float(column[i]) for key, column in numbers.items()}
        variant = replace(case, scene=with_values(case.scene, values))
        check_scene(variant.scene)
        try:
            response = simulate(
                variant,
                study.solver,
                study.rtol,
                duration=duration,
                output_step=duration,
                energy=energy,
            )
        except ComputationError as error:
            mark_failed(many, i, error)
        else:
            keep_recording(many, i, response.recording)
            keep_named(many, i, response.runs)
    return many


def _rows_text(study: Study, rows: Rows, results: Results) -> bytes:
    own = results.many
    columns: list[list[object]] = []
    for name in study.columns:
        label = rows.base.labels.get(name, "")
        column = rows.values.get(name)
        columns.append([label] * rows.count if column is None else column.tolist())
    for name in study.quantities:
        values = results.quantity(name)
        columns.append([""] * rows.count if values is None else _cells(name, values))
    columns.append(own.success.tolist())
    columns.append(["" if good else m for good, m in zip(own.success, own.message, strict=True)])
    return _text(zip(*columns, strict=True))


def _cells(name: str, values: Floats) -> list[object]:
    """Cells of a column; nothing where a run has no such number, counts as whole numbers."""
    if is_whole(name):
        return ["" if value != value else int(value) for value in values.tolist()]
    return ["" if value != value else value for value in values.tolist()]


def _refused(study: Study, chunk: Chunk, error: InputError) -> bytes:
    """Row of a scene that cannot be run."""
    base = study.bases[chunk.base]
    values = values_of_rows(base.axes, chunk.low, chunk.high)
    cells: list[object] = [
        float(values[name][0]) if name in values else base.labels.get(name, "")
        for name in study.columns
    ]
    blanks = [""] * len(study.quantities)
    return _text([[*cells, *blanks, False, " ".join(str(error).split())]])


def _text(rows: Iterable[Sequence[object]]) -> bytes:
    """Lines of a CSV file; every number reads back as the same double."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()
