"""SUNDIALS IDA between events: the motion in descriptor form.

Every body keeps its coordinates and the forces of resting contacts are
unknowns (`eventpound.mechanics.descriptor`); with CVODE it shares the event
loop and the laws of the springs. docs/method.md says why it is so posed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from eventpound.errors import ComputationError
from eventpound.mechanics.model import assemble
from eventpound.solvers.base import Drift, Recording, Task
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.scales import scene_scales, tolerances


class Ida:
    """The motion as a differential-algebraic system."""

    name = "ida"
    summary = "SUNDIALS IDA between events: contact forces as unknowns, a check on the reference"
    settings: Mapping[str, str] = {}
    kernels = "sundials"

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        from eventpound.solvers.sundials.ida_direct import DirectIda
        from eventpound.solvers.sundials.ida_library import ida_library

        model = assemble(task.scene)
        scales = scene_scales(task.scene, model, task.end - task.start)
        atol = tolerances(task, scales)
        integrator = DirectIda(
            ida_library(), model, scales, atol, task.rtol, ledger=task.energy
        )
        recording = EventLoop(task, integrator).run()
        gap, gap_rate = integrator.drift
        return replace(
            recording, drift=Drift(gap / scales.length, gap_rate / scales.speed)
        )
