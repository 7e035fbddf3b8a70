"""Thousands of variants of one scene in one call, on all cores."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from eventpound.batch_response import BatchResponse
from eventpound.case.case import DEFAULTS, Case
from eventpound.case.options import default_solver
from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.given import Count, checked, positive
from eventpound.numerics.arrays import Floats
from eventpound.quantities.lookup import chosen, needs_accelerations
from eventpound.scene.parameters import Place, places_of
from eventpound.scene.pi_columns import scale_columns
from eventpound.scene.scene import Scene
from eventpound.sweep import Columns, Sweep, Wanted, cores
from eventpound.units import Dimension
from eventpound.ways import Way, quantities_asked, refuse_options

MOST_SHOWN = 12
"""Keys that a message lists, at most."""


@checked
def simulate_many(
    case: Case | Scene,
    parameters: Mapping[str, Sequence[float] | Floats],
    *,
    rtol: float | str = 1e-6,
    duration: float | str | Floats | Sequence[float] | None = None,
    accelerations: bool = False,
    quantities: Sequence[str] = (),
    workers: Count | None = None,
    progress: Callable[[int], None] | None = None,
) -> BatchResponse:
    """Compute how variants of one scene move.

    Every variant is computed exactly as ``simulate(variant, solver="fast")``
    would, to the last bit, whatever the number of workers. Contacts with laws of their own or at
    points between bodies are not for that: ``"cvode"`` then, one by one.

    Parameters
    ----------
    case : Case or Scene
        What the variants have in common; a case brings its own run options
        and absolute tolerances.
    parameters : mapping of str to array_like, shape (n,)
        Numbers (SI) that differ, one value a variant, by keys as a case has
        them: ``"body.deck.mass"``, ``"spring.frame.strength"``,
        ``"dashpot.ground-deck.coefficient"``, ``"contact.joint.gap"``,
        ``"excitation.amplitude"``; see the page "many" of the docs.
    rtol : float, optional
        Relative tolerance, 1e-14 to 1e-2.
    duration : float, str or array_like, shape (n,), optional
        Length of the runs (s), or of each; for a scene that of each variant's
        motion and four periods.
    accelerations : bool, optional
        Whether to give the extremes of absolute accelerations and base shear, too.
    quantities : sequence of str
        Further ones to tabulate (page "quantities" of the docs), beside those that ``[run]`` of a
        case asks for. For some, which need all of each run, variants run one by one, some
        hundred times slower.
    workers : int, optional
        Number of threads; as many as there are cores to use.
    progress : callable, optional
        Called with the number of variants done as the work goes on.

    Returns
    -------
    BatchResponse
        Peaks, impacts and final states; a variant that failed is marked, with
        NaN in the place of its numbers.

    Raises
    ------
    InputError
        Where a key, a value or an option cannot be used; then nothing is run.
    """
    if isinstance(case, Case):
        refuse_options(case, Way.MANY, parameters)
        scene, stated = case.scene, case.run.stated
        asked = quantities_asked([(scene, case.run)])
    else:
        scene, stated, asked = case, DEFAULTS, []
    quantities = list(dict.fromkeys([*chosen(scene, quantities, stated), *asked]))
    values = _checked_columns(parameters, places_of(scene))
    count = len(next(iter(values.values())))
    wanted = Wanted(
        default_solver([scene], many=True),
        positive("rtol", rtol, Dimension.NUMBER),
        accelerations or needs_accelerations(scene, quantities),
        quantities=quantities,
    )
    scales = scale_columns(scene, values) if wanted.quantities else None
    columns = Columns(case, values, _lengths(case, duration, count), scales=scales)
    return Sweep(columns, wanted).run(workers or cores(), progress)


def _checked_columns(
    parameters: Mapping[str, Sequence[float] | Floats], places: Mapping[str, Place]
) -> dict[str, Floats]:
    """Columns of one length, of finite numbers, by keys that the scene has."""
    problems, columns = [], {}
    for key, given in parameters.items():
        if key not in places:
            shown = [*list(places)[:MOST_SHOWN], *(["..."] if len(places) > MOST_SHOWN else [])]
            meant = suggestion(key, list(places)) or f"; accepted: {', '.join(shown)}"
            problems.append(f"parameters: {key}: unknown key{meant}")
            continue
        try:
            column = np.array(given, dtype=np.float64)
        except (TypeError, ValueError):
            problems.append(f"parameters: {key}: found {given!r}; accepted: an array of numbers")
            continue
        bad = np.flatnonzero(~np.isfinite(column))
        if column.ndim != 1 or column.size == 0:
            problems.append(
                f"parameters: {key}: found shape {column.shape}; accepted: (n,), a value a variant"
            )
        elif bad.size:
            problems.append(
                f"parameters: {key}: found {column[bad[0]]} in variant {bad[0]}; "
                "accepted: finite numbers"
            )
        else:
            columns[key] = column
    sizes = {key: column.size for key, column in columns.items()}
    if len(set(sizes.values())) > 1:
        found = ", ".join(f"{key} has {size}" for key, size in sizes.items())
        problems.append(f"parameters: found different lengths: {found}; accepted: one length")
    if not parameters:
        problems.append("parameters: found none; accepted: at least one key with its values")
    if problems:
        raise InputError(problems)
    return columns


def _lengths(
    case: Case | Scene, duration: float | str | Floats | Sequence[float] | None, count: int
) -> Floats | None:
    """Length of each run (s); None where each motion sets its own."""
    if duration is None:
        return np.full(count, case.run.duration) if isinstance(case, Case) else None
    if isinstance(duration, str):
        duration = positive("duration", duration, Dimension.TIME)
    lengths = np.array(duration, dtype=np.float64)
    if lengths.shape not in ((), (count,)):
        raise InputError(f"duration: found shape {lengths.shape}; accepted: one, or ({count},)")
    if not (np.isfinite(lengths) & (lengths > 0.0)).all():
        raise InputError("duration: found one that is not positive; accepted: positive times (s)")
    return np.broadcast_to(lengths, (count,)).copy()
