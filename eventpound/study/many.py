"""Thousands of variants of one scene in one call, on all cores: axes that go along together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from eventpound.basics.cores import cores
from eventpound.basics.given import Count, checked, positive
from eventpound.basics.told import Counted
from eventpound.case.case import Case, case_of
from eventpound.case.run_options import Way, refuse_options
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.quantities.batch_response import BatchResponse
from eventpound.quantities.lookup import chosen, quantities_asked, values_of
from eventpound.scene.scene import Scene
from eventpound.simulation import check_case
from eventpound.study.axes import given_axes
from eventpound.study.base import base_of, solver_of
from eventpound.study.runs import results_of
from eventpound.study.sweep import WantedRuns
from eventpound.study.variants import axis_values, rows_with, unknown_axes
from eventpound.units import Dimension


@checked
def simulate_many(
    case: Case | Scene,
    parameters: Mapping[str, Sequence[float | str] | Floats],
    *,
    rtol: float | str | None = None,
    duration: float | str | Floats | Sequence[float] | None = None,
    accelerations: bool = False,
    quantities: Sequence[str] = (),
    workers: Count | None = None,
    progress: Counted | None = None,
) -> BatchResponse:
    """Compute how variants of one scene move.

    Every variant is computed exactly as ``simulate(variant, solver="fast")``
    would, to the last bit, whatever the number of workers. Scenes with sliders are run one by one,
    and so are contacts with laws of their own, by ``"cvode"``.

    Parameters
    ----------
    case : Case or Scene
        What the variants have in common; a case brings its own run options
        and tolerances.
    parameters : mapping of str to array_like, shape (n,)
        Numbers that differ (SI, or texts with units), one value a variant, by keys as a case has
        them: ``"body.deck.mass"``, ``"spring.frame.strength"``,
        ``"dashpot.ground-deck.coefficient"``, ``"contact.joint.gap"``,
        ``"excitation.amplitude"``, or Π-terms, ``"pi.delta"``; see the page "many" of the docs.
    rtol : float, optional
        Relative tolerance, 1e-14 to 1e-2; by default that of the case, 1e-6 for a scene.
    duration : float, str or array_like, shape (n,), optional
        Length of the runs (s), or of each; by default as of `simulate`, of each motion.
    accelerations : bool, optional
        Whether to give the extremes of absolute accelerations and base shear, too.
    quantities : sequence of str
        Further ones to tabulate (page "quantities" of the docs), beside those that ``[run]`` of a
        case asks for. For some, which need all of each run, variants run one by one, some
        hundred times slower.
    workers : int, optional
        Number of threads; as many as there are cores to use.
    progress : callable, optional
        Called with the numbers of variants done and of all.

    Returns
    -------
    BatchResponse
        Peaks, impacts and final states; a variant that failed is marked, with
        NaN in the place of its numbers.

    Raises
    ------
    InputError
        Where a key, a value or an option cannot be used; then nothing is run.

    Examples
    --------
    >>> ball = Body("ball", "1 kg", velocity="1 m/s")
    >>> wall = Contact("wall", "ball", "barrier", gap="1 m", restitution=0.5)
    >>> scene = Scene([ball], contacts=[wall])
    >>> many = simulate_many(scene, {"contact.wall.restitution": [0.0, 0.5, 1.0]}, duration="2 s")
    >>> [round(u, 9) for u in many.table["final.ball.u"]]
    [1.0, 0.5, 0.0]
    """
    solver = solver_of(case, rtol)
    case = case_of(case)
    refuse_options(case.run, Way.MANY, parameters)
    asked = quantities_asked([(case.scene, case.run)])
    if not parameters:
        raise InputError("parameters: found none; accepted: at least one key with its values")
    axes = given_axes("parameters", parameters, [list(parameters)])
    lengths = _lengths(duration, axes[0].values.size)
    check_case(case)
    base = base_of(case, axes, (), solver, math.nan if lengths is None else float(lengths.max()))
    if unknown := [f"parameters: {key}: {text}" for key, text in unknown_axes(base)]:
        raise InputError(unknown)
    stated = base.case.run.stated
    names = list(dict.fromkeys([*chosen(case.scene, quantities, stated), *asked]))
    wanted = WantedRuns(solver.name, solver.rtol, names, accelerations)
    values = axis_values(base, 0, base.size)
    rows = replace(rows_with(base, values, range(base.size)), lengths=lengths)
    many = results_of(rows, wanted, workers or cores(), progress).many
    found = {name: values_of(many, name) for name in names}
    further = {name: column for name, column in found.items() if column is not None}
    varied = {**values, **many.parameters}
    return replace(many, parameters=varied, further=further, free=None, apart=None)


def _lengths(duration: float | str | Floats | Sequence[float] | None, count: int) -> Floats | None:
    """Length of each run (s); None where the case or each motion sets it."""
    if duration is None:
        return None
    if isinstance(duration, str):
        duration = positive("duration", duration, Dimension.TIME)
    lengths = np.array(duration, dtype=np.float64)
    if lengths.shape not in ((), (count,)):
        raise InputError(f"duration: found shape {lengths.shape}; accepted: one, or ({count},)")
    if not (np.isfinite(lengths) & (lengths > 0.0)).all():
        raise InputError("duration: found one that is not positive; accepted: positive times (s)")
    return np.broadcast_to(lengths, (count,)).copy()
