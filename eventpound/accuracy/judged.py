"""`simulate` as the package offers it: errors with every run."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace

from eventpound import simulation
from eventpound.accuracy.estimate import estimate_of
from eventpound.basics.given import Count, checked
from eventpound.basics.told import Reached, warn_caller
from eventpound.case.case import Case, case_of
from eventpound.case.run_options import EQUILIBRIUM, INITIAL
from eventpound.errors import AccuracyWarning, InputError
from eventpound.response import Response
from eventpound.scene.check import check_scene
from eventpound.scene.continuation import FinalState, continued
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Solver


@checked
def simulate(
    case: Case | Scene,
    solver: str | Solver | None = None,
    rtol: float | str | None = None,
    *,
    duration: float | str | None = None,
    output_step: float | str | None = None,
    energy: bool | None = None,
    events: Sequence[str] | None = None,
    settings: Mapping[str, object] | None = None,
    progress: Reached | bool | None = None,
    max_steps: Count | None = None,
    error_estimate: bool | None = None,
    start: FinalState | str | None = None,
) -> Response:
    """Compute how a scene moves, and estimate the error.

    Parameters
    ----------
    case : Case or Scene
        What moves; a case brings its own options, which the others override.
    solver : str or Solver, optional
        Name of a solver (`eventpound.solvers.available`), ``"cvode"`` for a scene; with settings
        as ``"cvode:events=sundials"``; or one of your own (page "your-solver" of the docs).
    rtol : float, optional
        Relative tolerance, 1e-14 to 1e-2; 1e-9 for a scene.
    duration : float, optional
        Length of the run (s), or with a unit, ``"12 s"``; for a scene until four periods after a
        pulse, or five of the structure's after a record.
    output_step : float, optional
        Distance of the rows of the history (s).
    energy : bool, optional
        Keep the energy ledger.
    events : sequence of str, optional
        Which events of springs `write` writes, ``"slip"`` and ``"soil"``; the table
        `spring_events` has all.
    settings : mapping, optional
        Settings of the solver (`Solver.settings` names them), in place of all those of the
        case.
    progress : callable or bool, optional
        Called with the time reached (s) as the run goes on; True shows it on stderr.
    max_steps : int, optional
        Steps after which the run ends with a ComputationError.
    error_estimate : bool, optional
        Whether the errors of peaks and final values are estimated by a second run. By default
        they are for ``cvode``, ``ida`` and ``fast``, by what is at hand; True asks for the most
        independent run, False for none (page "accuracy" of the docs). A case may say
        so, too.
    start : mapping or str, optional
        The state that another run ended in, its ``response.final``: displacements, velocities and
        z begin there (page "aftershocks" of the docs). ``"equilibrium"``: where forces, springs
        and contacts hold the bodies at the start; ``"initial"``: where they are given. Dashpots
        and scales of a case stay as they were read.

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
        Where a number or an event is uncertain, or the error is not known.

    Examples
    --------
    A ball meets a wall with 1 m/s after one second, and comes back with half of that:

    >>> ball = Body("ball", "1 kg", velocity="1 m/s")
    >>> wall = Contact("wall", "ball", "barrier", gap="1 m", restitution=0.5)
    >>> response = simulate(Scene([ball], contacts=[wall]), "fast", duration="2 s")
    >>> response.impacts, round(response.quantity("final.ball.u"), 9)
    (1, 0.5)
    """
    case = case_of(case)
    if start is not None:
        case = _started(case, start)
    response = simulation.response_of(
        case,
        solver,
        rtol,
        duration=duration,
        output_step=output_step,
        energy=energy,
        events=events,
        settings=settings,
        progress=_shown if progress is True else progress or None,
        max_steps=max_steps,
    )
    asked = case.run.error_estimate if error_estimate is None else error_estimate
    estimate = estimate_of(response, asked=asked)
    for text in (*response.warnings, *(estimate or {}).get("warnings", ())):
        warn_caller(text, AccuracyWarning)
    if progress is True:
        print(f"\r{response.recording.t:.6g} s", file=sys.stderr)
        response = replace(response, task=replace(response.task, progress=None))
    return response if estimate is None else replace(response, error_estimate=estimate)


def _started(case: Case, start: FinalState | str) -> Case:
    """The same in equilibrium, as it is, or from the end of another run on."""
    scene, time = case.scene, case.run.start_time
    if not isinstance(start, str):
        return replace(case, scene=continued(scene, start, time))
    if case.run.in_equilibrium and start != EQUILIBRIUM:
        raise InputError(f"start: found {start!r}; accepted: a case that starts there")
    if start == INITIAL or case.run.in_equilibrium:
        return case
    if start != EQUILIBRIUM:
        accepted = f"{INITIAL!r}, {EQUILIBRIUM!r}, or the final state of a run"
        raise InputError(f"start: found {start!r}; accepted: {accepted}")
    from eventpound.scene.statics import in_equilibrium

    check_scene(scene, None)
    return replace(case, scene=in_equilibrium(scene, time))


def _shown(t: float) -> None:
    """Show the time reached."""
    print(f"\r{t:.6g} s", end="", file=sys.stderr, flush=True)
