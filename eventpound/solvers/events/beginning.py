"""The state before an impact at the very start, which no step ends with."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.contact_elements import NO_LAW
from eventpound.mechanics.contact_laws import contact_forces
from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Forcing, forcing_of
from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import add_body_loads
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Task
from eventpound.solvers.events.recorder import row_width
from eventpound.solvers.events.scales import SceneScales


def lines_before(task: Task, model: Model, scales: SceneScales) -> Floats:
    """Lines of the history (`eventpound.solvers.events.recorder.history_of`) before the first.

    Parameters
    ----------
    task : Task
        The run.
    model : Model
        Its scene.
    scales : SceneScales
        What a gap of zero is.

    Returns
    -------
    ndarray, shape (0 or 1, row width)
        The state as the scene gives it where an impact changes it at once; elsewhere the line
        of the settled state says the same.
    """
    if not model.v0.any():
        return np.empty((0, row_width(model)))
    gap, rate = model.initial_gaps(scales.length), model.rates(model.v0)
    if not ((model.elements.kind == NO_LAW) & (gap == 0.0) & (rate < 0.0)).any():
        return np.empty((0, row_width(model)))
    z_of_link = np.zeros(model.links)
    z_of_link[model.hysteretic] = model.z0
    elastic = _elastic_forces(model) + model.law.strength * z_of_link
    total = elastic + model.law.damping * model.elongations(model.v0)
    force = contact_forces(model.elements, gap, rate, np.zeros(gap.size))
    elastic[model.plain :] = total[model.plain :] = -force[model.laws]
    line = np.concatenate(
        (
            (task.start, _ground(task)),
            model.u0,
            model.v0,
            (_pulled(model, total) + _loads(task, model)) / model.mass,
            model.z0,
            elastic[: model.springs],
            gap,
            force,
        )
    )
    return line.reshape(1, -1)


def _elastic_forces(model: Model) -> Floats:
    """``k x + f`` of every link, shape (L,) (N)."""
    below = np.array([law.compression for law in model.elastic], float)
    above = np.array([law.extension for law in model.elastic], float)
    x = model.elongations(model.u0) - np.array([law.offset for law in model.elastic], float)
    return np.where(x < 0.0, below, above) * x


def _pulled(model: Model, force: Floats) -> Floats:
    """Sum of the forces of the links on each body, shape (N,) (N)."""
    total = np.zeros(model.bodies + 1)
    np.add.at(total, model.link_ends[:, 0], force)
    np.add.at(total, model.link_ends[:, 1], -force)
    return total[:-1]


def _ground(task: Task) -> float:
    """Acceleration of the ground as the run begins (m/s²)."""
    return float(ground_acceleration(_first_piece(task), task.start))


def _loads(task: Task, model: Model) -> Floats:
    """Loads on the bodies as the run begins, shape (N,) (N)."""
    force = np.zeros(model.bodies)
    if model.loads:
        add_body_loads(_first_piece(task), task.start, force)
    return force


def _first_piece(task: Task) -> Forcing:
    """The piece of the ground motion in which the run begins."""
    piece = next(piece for piece in task.scene.motion.pieces() if piece.end > task.start)
    return forcing_of(piece, task.start)
