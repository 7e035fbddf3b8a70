"""`simulate` as the package offers it: a run, and an estimate of its error."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace

from eventpound import simulation
from eventpound.accuracy.estimate import estimate_of
from eventpound.case.case import Case
from eventpound.errors import AccuracyWarning
from eventpound.response import Response
from eventpound.scene.scene import Scene
from eventpound.simulation import Progress


def simulate(
    case: Case | Scene,
    solver: str | None = None,
    rtol: float | None = None,
    *,
    duration: float | None = None,
    output_step: float | None = None,
    energy: bool | None = None,
    settings: Mapping[str, object] | None = None,
    progress: Progress | None = None,
    max_steps: int | None = None,
    error_estimate: bool | None = None,
) -> Response:
    """Compute how a scene moves, and estimate by how much that is wrong.

    Parameters
    ----------
    case : Case or Scene
        What moves; a case brings its own options, which the others override.
    solver : str, optional
        Name of a solver (`eventpound.solvers.available`); ``"cvode"`` for a scene.
    rtol : float, optional
        Relative tolerance, 1e-14 to 1e-2; 1e-9 for a scene.
    duration : float, optional
        Length of the run (s); for a scene that of its motion and four periods.
    output_step : float, optional
        Distance of the rows of the history (s).
    energy : bool, optional
        Keep the energy ledger.
    settings : mapping, optional
        Settings of the solver (SI, `Solver.settings` names them), in place of all those
        of the case.
    progress : callable, optional
        Called with the time reached (s) as the run goes on.
    max_steps : int, optional
        Steps after which the run ends with a ComputationError.
    error_estimate : bool, optional
        Whether the errors of peaks and final values are estimated by a finer run. By default
        they are for ``cvode`` and ``ida`` where that costs milliseconds, as for
        ``eventpound run`` (docs/accuracy.md), or where the case asks for it.

    Returns
    -------
    Response
        Peaks, events, history and final state; `error_estimate` where there is one.

    Raises
    ------
    InputError
        Where the scene or an option cannot be run.
    ComputationError
        Where the computation failed; what was computed is in its `recording`.

    Warns
    -----
    AccuracyWarning
        Where the tolerance does not tell a number or an event.
    """
    response = simulation.simulate(
        case,
        solver,
        rtol,
        duration=duration,
        output_step=output_step,
        energy=energy,
        settings=settings,
        progress=progress,
        max_steps=max_steps,
    )
    if error_estimate is None and isinstance(case, Case) and case.run.error_estimate:
        error_estimate = True
    estimate = estimate_of(response, asked=error_estimate, bounded=max_steps is not None)
    for text in (estimate or {}).get("warnings", ()):
        warnings.warn(text, AccuracyWarning, stacklevel=2)
    return replace(response, error_estimate=estimate)
