"""SUNDIALS IDA between events: the motion in descriptor form.

Every body keeps its coordinates and the forces of resting contacts are
unknowns (`eventpound.mechanics.descriptor`); with CVODE it shares the event
loop and the laws of the springs. docs/method.md says why it is so posed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.model import Model, assemble
from eventpound.solvers.base import Drift, Recording, Task
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.scales import SceneScales, scene_scales, tolerances

if TYPE_CHECKING:
    from eventpound.solvers.sundials.ida_direct import DirectIda


class Ida:
    """The motion as a differential-algebraic system."""

    name = "ida"
    summary = "SUNDIALS IDA between events: contact forces as unknowns, a check on the reference"
    settings: Mapping[str, str] = {}
    counts_steps = True

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        model = assemble(task.scene)
        scales = scene_scales(task.scene, model, task.end - task.start)
        integrator = _integrator(task, model, scales)
        loop = EventLoop(task, integrator)

        def with_drift(recording: Recording) -> Recording:
            gap, gap_rate = (float(value) for value in integrator.drift)
            return replace(recording, drift=Drift(gap / scales.length, gap_rate / scales.speed))

        try:
            return with_drift(loop.run())
        except ComputationError as error:
            if error.recording is not None:
                error.recording = with_drift(error.recording)
            raise


def _integrator(task: Task, model: Model, scales: SceneScales) -> DirectIda:
    from eventpound.solvers.sundials.ida_library import ida_library

    library = ida_library()
    if library is None:
        raise InputError(
            'solver = "ida": the SUNDIALS of this installation cannot be called from compiled '
            'code; accepted here: "cvode", "fast"'
        )
    from eventpound.solvers.sundials.ida_direct import DirectIda

    atol = tolerances(task, scales)
    return DirectIda(library, model, scales, atol, task.rtol, ledger=task.energy)
