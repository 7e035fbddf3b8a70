"""SUNDIALS IDA between events: the motion in descriptor form.

Every body keeps its coordinates and the forces of resting contacts are
unknowns (`eventpound.mechanics.descriptor`), and IDA's own root finder finds the
events, unless told otherwise: with CVODE it shares the event loop and the laws of
the springs. The page "method" of the docs says why it is so posed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from eventpound.errors import ComputationError
from eventpound.mechanics.model import Model, assemble, with_sliders
from eventpound.scene.spring import LawName
from eventpound.solvers.base import Drift, Recording, Task
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.roots import SUNDIALS, finders, sundials_finds
from eventpound.solvers.events.scales import SceneScales, scene_scales, tolerances
from eventpound.solvers.settings import Settings
from eventpound.solvers.sundials.descriptor_modes import LOCAL_SHARE, DescriptorModes
from eventpound.solvers.supported import with_supports
from eventpound.tolerances import FINEST_RTOL

if TYPE_CHECKING:
    from eventpound.solvers.sundials.compiled_ida import DirectIda
    from eventpound.solvers.sundials.wrapped import WrappedIda


class Ida:
    """The motion as a differential-algebraic system."""

    name = "ida"
    summary = "SUNDIALS IDA between events: contact forces as unknowns, a check on the reference"
    settings: Mapping[str, str] = {"events": finders(SUNDIALS)}
    counts_steps = True
    takes_supports = True
    takes_points = True
    memories = frozenset(LawName)
    lists_springs = True
    finest_rtol = FINEST_RTOL / LOCAL_SHARE
    """Below it the steps get no finer."""

    def check_settings(self, settings: Settings) -> None:
        """Refuse values that it cannot take; see `eventpound.solvers.base.Solver`."""
        sundials_finds(settings, SUNDIALS)

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        return with_supports(task, self._solve)

    def _solve(self, task: Task) -> Recording:
        finds_events = sundials_finds(task.settings, SUNDIALS)
        model = with_sliders(assemble(task.scene))
        scales = scene_scales(task.scene, model, task.end - task.start)
        chosen = integrator(task, model, scales)
        loop = EventLoop(task, chosen, finds_events=finds_events)

        def with_drift(recording: Recording) -> Recording:
            gap, gap_rate = (float(value) for value in chosen.drift)
            return replace(recording, drift=Drift(gap / scales.length, gap_rate / scales.speed))

        try:
            return with_drift(loop.run())
        except ComputationError as error:
            if error.recording is not None:
                error.recording = with_drift(error.recording)
            raise


def integrator(task: Task, model: Model, scales: SceneScales) -> DirectIda | WrappedIda:
    """IDA for one run, called from compiled code where that can be had.

    Parameters
    ----------
    task : Task
        The run.
    model, scales : Model and SceneScales
        Its scene.
    """
    from eventpound.solvers.sundials.library import ida_library

    atol = tolerances(task, scales)
    modes = DescriptorModes(model, scales, atol, task.rtol, ledger=task.energy)
    library = ida_library()
    if library is not None:
        from eventpound.solvers.sundials.compiled_ida import DirectIda

        return DirectIda(library, modes)
    from eventpound.solvers.sundials.wrapped import WrappedIda

    return WrappedIda(modes)
