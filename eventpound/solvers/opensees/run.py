"""One transient analysis in OpenSees: Newmark's average acceleration, Newton's iterations.

    ops.integrator("Newmark", 0.5, 0.25),  ops.algorithm("Newton"),  a fixed step

The ground acceleration is sampled at the steps; where it jumps at one, as the mean of both
sides, and the first acceleration is given, so that a pulse that starts or ends with a jump
does not cost the method its second order.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Task
from eventpound.solvers.opensees.elements import GROUND_NODE, ZeroLength
from eventpound.tolerances import OPENSEES_CHANGE

MOST_ITERATIONS = 50
PARTS = 10
"""Parts in which a step is taken whose iterations do not converge, as is usual."""


@dataclass(frozen=True)
class AnalysisRows:
    """What an analysis leaves behind, up to where it got.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times (s).
    u, v : ndarray, shape (n, N)
        Relative displacements (m) and velocities (m/s).
    force : ndarray, shape (n, S)
        Forces of the springs (N); NaN in rows where they were not asked for.
    iterations : int
        Newton iterations in all.
    """

    t: Floats
    u: Floats
    v: Floats
    force: Floats
    iterations: int


def analyse(
    ops: Any, task: Task, model: Model, elements: list[ZeroLength], steps: int, length: float
) -> AnalysisRows:
    """Build the model and carry it from start to end.

    Parameters
    ----------
    ops : module
        ``openseespy.opensees``.
    task : Task
        What is asked.
    model : Model
        Its arrays.
    elements : list of ZeroLength
        What is between the nodes, the springs first.
    steps : int
        Number of equal steps.
    length : float
        Scale of displacements (m).
    """
    ops.logFile(os.devnull, "-noEcho")
    ops.wipe()
    try:
        _build(ops, model, elements)
        _start(ops, task, model)
        _load(ops, task, steps)
        _prepare(ops, length)
        return _carry(ops, task, model, steps)
    finally:
        ops.wipe()


def _build(ops: Any, model: Model, elements: list[ZeroLength]) -> None:
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(GROUND_NODE, 0.0)
    ops.fix(GROUND_NODE, 1)
    for b, mass in enumerate(model.mass):
        ops.node(b + 2, 0.0)
        ops.mass(b + 2, float(mass))
    for tag, element in enumerate(elements, start=1):
        kind, *numbers = element.material
        ops.uniaxialMaterial(kind, tag, *numbers)
        ops.element("zeroLength", tag, element.first, element.second, "-mat", tag, "-dir", 1)


def _start(ops: Any, task: Task, model: Model) -> None:
    """Give every node its initial motion, the acceleration included."""
    force = model.pulled(model.link_forces(model.u0, model.v0, model.z0)[1])
    ground = float(task.scene.motion.acceleration(np.array([task.start]))[0])
    for b in range(model.bodies):
        ops.setNodeDisp(b + 2, 1, float(model.u0[b]), "-commit")
        ops.setNodeVel(b + 2, 1, float(model.v0[b]), "-commit")
        ops.setNodeAccel(b + 2, 1, float(force[b] / model.mass[b]) - ground, "-commit")


def _load(ops: Any, task: Task, steps: int) -> None:
    """The ground acceleration at the steps and, so that rounding cannot end it, one beyond."""
    step = (task.end - task.start) / steps
    t = task.start + step * np.arange(steps + 2, dtype=np.float64)
    motion = task.scene.motion
    after = motion.acceleration(t)
    before = motion.acceleration(np.asarray(np.nextafter(t, -np.inf), dtype=np.float64))
    values = np.concatenate((after[:1], 0.5 * (before[1:] + after[1:])))
    ops.timeSeries("Path", 1, "-dt", step, "-values", *values.tolist())
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)


def _prepare(ops: Any, length: float) -> None:
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", OPENSEES_CHANGE * length, MOST_ITERATIONS, 0)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")


def _advance(ops: Any, step: float) -> int:
    """Take a step, in parts where need be; Newton iterations it took, 0 where none converge."""
    if ops.analyze(1, step) == 0:
        return max(1, int(ops.testIter()))
    iterations = MOST_ITERATIONS
    for _ in range(PARTS):
        if ops.analyze(1, step / PARTS) != 0:
            return 0
        iterations += ops.testIter()
    return iterations


def _carry(ops: Any, task: Task, model: Model, steps: int) -> AnalysisRows:
    step = (task.end - task.start) / steps
    u, v = np.empty((steps + 1, model.bodies)), np.empty((steps + 1, model.bodies))
    force = np.full((steps + 1, model.springs), np.nan)
    u[0], v[0] = model.u0, model.v0
    iterations, done = 0, 0
    for i in range(1, steps + 1):
        needed = _advance(ops, step)
        if needed == 0:
            break
        done = i
        iterations += needed
        for b in range(model.bodies):
            u[i, b], v[i, b] = ops.nodeDisp(b + 2, 1), ops.nodeVel(b + 2, 1)
        if task.output_times.size or i == steps:
            for s in range(model.springs):
                force[i, s] = ops.eleResponse(s + 1, "material", 1, "stress")[0]
        if task.progress is not None:
            task.progress(task.start + i * step)
    rows = slice(done + 1)
    t = task.start + step * np.arange(steps + 1, dtype=np.float64)
    t[-1] = task.end
    return AnalysisRows(t[rows], u[rows], v[rows], force[rows], iterations)
