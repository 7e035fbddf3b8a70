"""Rows of a plan as runs, in order, those without contact beside them where they are needed.

Either by `Sweep` or not at all: rows that cannot be run say why, and stop no others.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from eventpound.basics.told import Counted
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.quantities.apart import avoiding_gaps
from eventpound.quantities.batch_response import BatchResponse
from eventpound.quantities.lookup import (
    FREE,
    needs_accelerations,
    needs_free,
    needs_impacts,
    values_of,
)
from eventpound.scene.parameters import number_places, value_at
from eventpound.scene.scene import Scene
from eventpound.study.base import Base
from eventpound.study.sweep import Sweep, WantedRuns
from eventpound.study.variants import Rows, rows_of_base


@dataclass(frozen=True)
class Results:
    """Runs of some rows, from which quantities are taken.

    Parameters
    ----------
    rows : Rows
        What was run.
    many : BatchResponse
        The runs.
    seconds : ndarray, shape (n,)
        What each took (s); its share by steps, where several were one call.
    """

    rows: Rows
    many: BatchResponse
    seconds: Floats

    def quantity(self, name: str) -> Floats | None:
        """Values of a quantity or a number of the scene, (n,); None where there is none."""
        rows, scene = self.rows, self.rows.scene
        if name in rows.numbers:
            return rows.numbers[name]
        place = number_places(scene).get(name)
        if place is None:
            return values_of(self.many, name)
        if place.kind == "excitation" and rows.motion_of is not None:
            own = [getattr(motion, place.field) for motion in rows.motions]
            return np.asarray(own, float)[rows.motion_of]
        return np.broadcast_to(np.asarray(value_at(scene, place), float), (rows.count,))


@dataclass(frozen=True)
class Refused:
    """Rows of a scene that cannot be run, all for the same reason.

    Parameters
    ----------
    base : Base
        The scene.
    at : range
        Which rows.
    error : InputError
        Why.
    """

    base: Base
    at: range
    error: InputError


def runs_in_parts(
    base: Base, low: int, high: int, wanted: WantedRuns
) -> Iterator[Results | Refused]:
    """Run the rows `low` to `high` of a scene, and give them in order.

    `keep` of what is wanted is given numbers of rows of the scene.
    """
    size = base.size_of_record
    begun = low
    for number in range(low // size, -(-high // size)) if base.records else ():
        first, last = max(low, number * size), min(high, (number + 1) * size)
        try:
            base.records[number].on(base.case.scene)
        except InputError as error:
            yield from _halved(base, begun, first, wanted)
            yield Refused(base, range(first, last), error)
            begun = last
        else:
            if base.one_by_one:
                # The record makes a scene of its own.
                yield from _halved(base, begun, last, wanted)
                begun = last
    yield from _halved(base, begun, high, wanted)


def _halved(base: Base, low: int, high: int, wanted: WantedRuns) -> Iterator[Results | Refused]:
    """Run rows; where a scene cannot be run at all, halve until it stands alone."""
    if low == high:
        return
    own = wanted
    if wanted.keep is not None:
        keep = wanted.keep
        own = replace(wanted, keep=lambda i, response: keep(low + i, response))
    try:
        results = results_of(rows_of_base(base, low, high), own)
    except InputError as error:
        if high - low == 1:
            yield Refused(base, range(low, high), error)
        else:
            middle = (low + high) // 2
            yield from _halved(base, low, middle, wanted)
            yield from _halved(base, middle, high, wanted)
    else:
        yield results


def results_of(
    rows: Rows, wanted: WantedRuns, workers: int = 1, progress: Counted | None = None
) -> Results:
    """Run rows, and those without contact that quantities need.

    Parameters
    ----------
    rows : Rows
        What is run.
    wanted : WantedRuns
        What is kept.
    workers : int
        Threads of the fast solver.
    progress : callable, optional
        Called with the numbers of rows done and of all.

    Raises
    ------
    InputError
        Where one of them cannot be run at all; then nothing is run.
    """
    scene = rows.scene
    sweep = Sweep(rows, _of_sweep(scene, wanted, ""))
    own, rows = sweep.run(workers, progress), sweep.rows

    def instead(
        other: Scene, kept: WantedRuns, struck: Collection[str] = ()
    ) -> tuple[BatchResponse, Ints]:
        """Runs of another scene; those that differ in contacts that it has not are one run."""
        if rows.case.run.in_equilibrium:
            from eventpound.scene.statics import placed_again

            other = placed_again(other, rows.case.run.start_time)
        fewer, which = _without_contacts(rows, other, struck)
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
    def apart(widened: tuple[int, ...]) -> Floats:
        which: list[Ints] = []
        struck = {c.name for i, c in enumerate(scene.contacts) if i not in widened}

        def run(other: Scene) -> BatchResponse:
            many, rows_of_many = instead(other, WantedRuns(wanted.solver, wanted.rtol), struck)
            which[:] = [rows_of_many]
            return many

        gaps = avoiding_gaps(scene, widened, run)
        return gaps[which[0]]

    return Results(rows, replace(own, free=free, apart=apart), sweep.seconds)


def _without_contacts(rows: Rows, other: Scene, struck: Collection[str]) -> tuple[Rows, Ints]:
    """Rows of a scene with these contacts only, each once, and which of them each row is."""
    places, contacts = number_places(rows.scene), rows.scene.contacts
    numbers = {
        key: v
        for key, v in rows.numbers.items()
        if places[key].kind != "contact" or contacts[places[key].index].name in struck
    }
    motion_of = rows.motion_of
    columns = [*numbers.values(), *([] if motion_of is None else [motion_of.astype(float)])]
    first, which = distinct(columns, rows.count)
    fewer = replace(
        rows,
        base=replace(rows.base, case=rows.case.apart(other)),
        at=range(first.size),
        numbers={key: column[first] for key, column in numbers.items()},
        lengths=None if rows.lengths is None else rows.lengths[first],
        motion_of=None if motion_of is None else motion_of[first],
        scales=None if rows.scales is None else rows.scales.rows(first, rows.count),
    )
    return fewer, which


def _of_sweep(scene: Scene, wanted: WantedRuns, prefix: str) -> WantedRuns:
    """What a sweep has to keep: quantities of a prefix, which others are computed from."""
    named = [
        name.removeprefix(prefix)
        for name in wanted.quantities
        if name.startswith(FREE) == bool(prefix) and not needs_free(scene, name.removeprefix(FREE))
    ]
    return replace(
        wanted,
        quantities=named,
        accelerations=wanted.accelerations or needs_accelerations(scene, wanted.quantities),
        impacts=wanted.impacts or needs_impacts(scene, named),
        keep=None if prefix else wanted.keep,
    )
