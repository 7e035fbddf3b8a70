"""What a quantity q depends on: its derivatives by the numbers p of a scene.

    dq/dp = (q(p + h) - q(p - h)) / 2h,    h = DIFFERENCE_STEP |p|

As long as the same events happen, a computed quantity follows the numbers smoothly, so that its
error hardly grows as h shrinks. A second difference, of twice the step at ten times the tolerance,
misses dq/dp by more for either reason; how far the two are apart is taken for the error.

Where an impact comes or goes between p - 2h and p + 2h there is no derivative, unless it comes too
late for q: then the two are as near as ever. Impacts softer than `SOFT` of the fastest do not
count: they are the last of a contact that comes to rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from eventpound.accuracy.sequences import SOFT
from eventpound.basics.given import Count, checked, positive
from eventpound.basics.told import Counted, warn_caller
from eventpound.case.case import Case, case_of
from eventpound.case.run_options import Stated
from eventpound.case.solver_options import LARGEST_RTOL, SolverOptions, default_solver
from eventpound.case.table import suggestion
from eventpound.errors import AccuracyWarning, ComputationError, InputError
from eventpound.numerics.arrays import Floats
from eventpound.quantities.batch_response import BatchResponse
from eventpound.quantities.lookup import FREE, Named, chosen, find, values_of
from eventpound.scene.parameters import dimension_of_number, number_places, value_at
from eventpound.scene.scene import Scene
from eventpound.simulation import check_case
from eventpound.study.axes import PI, NumberAxis
from eventpound.study.base import Base, base_of
from eventpound.study.many import simulate_many
from eventpound.study.variants import check_axes
from eventpound.tolerances import DIFFERENCE_STEP
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd

PEAKS = ("peaks.<body>.abs_max",)
"""Whose derivatives are given where nobody says."""
_RTOL = 1e-10
_COARSER = 2.0, 10.0
"""Step and tolerance of the second difference, beside those of the first."""
_FAR = 0.01
"""Part of a derivative by which two differences of it are apart where there is none."""
_SAMPLING = "excitation.time_step"
"""What nobody designs: it stretches the record."""
_SHOWN = 3
_COUNTED = ("contacts.<contact>.impacts_faster", "contacts.<contact>.fastest_closing")


@dataclass(frozen=True, slots=True)
class _Number:
    """A number that is varied: its key, its value and its step (SI)."""

    key: str
    at: float
    step: float


@checked
def sensitivities(
    case: Case | Scene,
    *,
    of: Sequence[str] = PEAKS,
    to: Sequence[str] | Mapping[str, float | str] = (),
    rtol: float | str = _RTOL,
    duration: float | str | None = None,
    workers: Count | None = None,
    progress: Counted | None = None,
) -> pd.DataFrame:
    """Tell how quantities follow the numbers of a scene, by central differences.

    Parameters
    ----------
    case : Case or Scene
        What is run as it is, and with each number moved by itself, one and two steps up and down.
    of : sequence of str
        Quantities (page "quantities" of the docs), by name or path.
    to : sequence of str or mapping of str to float
        Numbers by their keys, as for `simulate_many`; in a mapping each with its step (SI, or a
        text with a unit), which a number that is zero needs. By default all that are not zero,
        but the time step of a record; of a case in Π-terms its terms.
    rtol : float
        Relative tolerance.
    duration : float or str, optional
        Length of all runs (s); by default that of the case as it is.
    workers : int, optional
        Number of threads; as many as there are cores to use.
    progress : callable, optional
        Called with the numbers of runs done and of all.

    Returns
    -------
    DataFrame
        A row for each quantity and number, the largest elasticity of a quantity first. Columns
        quantity, its value and unit; to, and what that number is at; derivative and its error, in
        `unit` for one SI unit of the number; elasticity, per cent for one per cent of the number;
        note, why there is no derivative: an impact comes or goes within the steps, or a run failed.

    Raises
    ------
    InputError
        Where a name, a key or an option cannot be used; then nothing is run.
    ComputationError
        Where the scene as it is cannot be computed.

    Warns
    -----
    AccuracyWarning
        Where there are notes.
    """
    tolerance = positive("rtol", rtol, Dimension.NUMBER)
    length = np.nan if duration is None else positive("duration", duration, Dimension.TIME)
    given = case_of(case).scene
    solver = SolverOptions(default_solver([given], many=True), tolerance)
    check_case(case)
    base = base_of(case, (), (), solver, length)
    names = _with_derivatives(base.case, of)
    numbers = _numbers(base, to)
    asked = [*[named.name for named in names], *(_COUNTED if given.contacts else ())]
    total = 1 + 4 * len(numbers)

    def runs(
        columns: Mapping[str, Floats], rtol: float, threshold: float, done: int
    ) -> BatchResponse:
        case = _counting(base.case, threshold)
        return simulate_many(
            case,
            columns,
            rtol=rtol,
            duration=case.run.duration,
            quantities=asked,
            workers=workers,
            progress=None if progress is None else lambda new, _: progress(done + new, total),
        )

    first = runs({number.key: np.array([number.at]) for number in numbers}, tolerance, 0.0, 0)
    if not first.success[0]:
        raise ComputationError(first.message[0], float(first.t[0]))
    soft = SOFT * first.contact_numbers.fastest_closing.max(initial=0.0)
    times, coarser = _COARSER
    coarse_rtol = min(coarser * tolerance, LARGEST_RTOL)
    fine = runs(_up_and_down(numbers, 1.0), tolerance, soft, 1)
    coarse = runs(_up_and_down(numbers, times), coarse_rtol, soft, 1 + 2 * len(numbers))
    table = _tabled(names, numbers, (first, fine, coarse))
    if noted := (table["quantity"] + " to " + table["to"])[table["note"] != ""].tolist():
        shown = ", ".join(noted[:_SHOWN]) + (", ..." if len(noted) > _SHOWN else "")
        text = f"no derivative, {len(noted)} of {len(table)}, as the table notes: of {shown}"
        warn_caller(text, AccuracyWarning)
    return table


def _counting(case: Case, threshold: float) -> Case:
    """The case as it is run: impacts above a speed (m/s) are counted, nothing else is asked."""
    stated = Stated(contact_stiffness=case.run.stated.contact_stiffness)
    if case.scene.contacts:
        stated = replace(stated, threshold_speed=threshold)
    return replace(case, run=replace(case.run, stated=stated, energy=False, error_estimate=None))


def _with_derivatives(case: Case, of: Sequence[str]) -> list[Named]:
    """The quantities, none of which is a count."""
    if not of:
        raise InputError("of: found []; accepted: at least one quantity")
    try:
        names = chosen(case.scene, of, case.run.stated)
    except InputError as error:
        problems = [problem.removeprefix("quantities: ") for problem in error.problems]
        raise InputError([f"of: {problem}" for problem in problems]) from None
    found = [find(case.scene, name.removeprefix(FREE)) for name in names]
    named = [replace(n, name=name) for name, n in zip(names, found, strict=True) if n is not None]
    if counts := [n.name for n in named if n.quantity.kind is not float]:
        raise InputError([f"of: {name!r} is a count, and has no derivative" for name in counts])
    return named


def _numbers(base: Base, to: Sequence[str] | Mapping[str, float | str]) -> list[_Number]:
    """The numbers that are varied; where nobody names any, those that can be.

    A case in Π-terms has these only: its runs hold them all, whatever else changes.
    """
    scene, pi = base.case.scene, base.case.pi
    there = {key: value_at(scene, place) for key, place in number_places(scene).items()}
    if pi is not None:
        there = {PI + term: value for term, value in pi.terms.items()}
    steps = to if isinstance(to, Mapping) else {}
    numbers: list[_Number] = []
    problems: list[str] = []
    for key in dict.fromkeys(to or [key for key in there if key != _SAMPLING]):
        try:
            if key not in there:
                meant = suggestion(key, list(there)) or f"; accepted: {', '.join(there)}"
                raise InputError(f"unknown key{meant}")
            numbers.append(_number(base, key, there[key], steps.get(key)))
        except InputError as error:
            problems += [f"to: {key}: {problem}" for problem in error.problems] if to else []
    if problems or not numbers:
        raise InputError(problems or "to: no number of the scene can be varied by a part of itself")
    return numbers


def _number(base: Base, key: str, at: float | None, given: float | str | None) -> _Number:
    """A number and its step, the ends of whose steps are looked at.

    Raises
    ------
    InputError
        Where there cannot be such a scene.
    """
    if at is None:
        raise InputError("not given in this scene, so there is nothing to vary")
    if given is None:
        step = DIFFERENCE_STEP * abs(at)
    else:
        step = positive("step", given, dimension_of_number(key) or Dimension.NUMBER)
    if step == 0.0:
        raise InputError("found 0, which has no part to vary by; accepted: with a step of its own")
    ends = at + _COARSER[0] * step * np.array([-1.0, 1.0])
    axis = NumberAxis(key, ends)
    if problems := list(check_axes(replace(base, axes=(axis,)))):
        raise InputError([problem.partition("): ")[2] for problem in problems])
    return _Number(key, at, step)


def _up_and_down(numbers: Sequence[_Number], times: float) -> dict[str, Floats]:
    """Columns of a batch: each number by itself up, then each down, by so many steps."""
    steps = np.diag([times * number.step for number in numbers])
    away = np.concatenate((steps, -steps))
    return {number.key: number.at + away[:, i] for i, number in enumerate(numbers)}


def _reason(number: int, numbers: int, batches: Sequence[BatchResponse]) -> str:
    """Why there may be no derivative by a number: a run failed, or impacts come or go."""
    own = [(many, row) for many in batches for row in (number, number + numbers)]
    if failed := [many.message[row] for many, row in own if not many.success[row]]:
        return failed[0]
    counts = [many.contact_numbers.impacts_faster[row] for many, row in own]
    ranges = zip(np.min(counts, axis=0), np.max(counts, axis=0), strict=True)
    texts = [
        f"{low:.0f} to {high:.0f} impacts of {contact.name} within the steps"
        for contact, (low, high) in zip(batches[0].scene.contacts, ranges, strict=True)
        if low != high
    ]
    return ", ".join(texts)


def _tabled(
    names: Sequence[Named],
    numbers: Sequence[_Number],
    batches: tuple[BatchResponse, BatchResponse, BatchResponse],
) -> pd.DataFrame:
    """A row for each quantity and number, in order of the elasticities; those with a note last."""
    import pandas as pd

    first, fine, coarse = batches
    keys = [number.key for number in numbers]
    at = np.array([number.at for number in numbers])
    reasons = np.array([_reason(i, len(keys), (fine, coarse)) for i in range(len(keys))])
    tables = []
    for named in names:
        (value,) = _values(first, named.name)
        derivative, other = (_derivatives(many, named.name, keys) for many in (fine, coarse))
        error = np.abs(derivative - other)
        elasticity = derivative * at / (value or np.nan)
        notes = np.where(error <= _FAR * np.abs(derivative), "", reasons)
        columns = {
            "quantity": named.name,
            "value": value,
            "unit": named.quantity.dimension.unit,
            "to": keys,
            "at": at,
            "derivative": derivative,
            "error": error,
            "elasticity": elasticity,
            "note": notes,
        }
        order = np.argsort(np.where(notes == "", -np.abs(elasticity), np.nan), kind="stable")
        tables.append(pd.DataFrame(columns).iloc[order])
    return pd.concat(tables, ignore_index=True)


def _derivatives(many: BatchResponse, name: str, keys: Sequence[str]) -> Floats:
    """Central differences of a quantity by each number, shape (numbers,)."""
    up, down = np.split(_values(many, name), 2)
    apart = [many.parameters[key][[i, i + len(keys)]] for i, key in enumerate(keys)]
    return (up - down) / np.array([high - low for high, low in apart])


def _values(many: BatchResponse, name: str) -> Floats:
    """Values of a quantity, shape (n,); NaN where it has none."""
    found = values_of(many, name)
    return np.full(many.t.size, np.nan) if found is None else found
