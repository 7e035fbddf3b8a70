"""Force against elongation between rows: loops without the corners of their rows.

A hysteretic variable follows its law along x, dz/dx, at whatever pace the spring moves. So a loop
between two rows is known once it is known where the spring turns (`between.with_turns`). What the
law misses of the next row, which is of the order of the rows' distance, is spread along the way.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.quantities.between import Between
from eventpound.scene.elastic_laws import elastic_force

_PARTS = 16
"""Of a stretch that is curved."""
_STRAIGHT = 2e-4
"""Part of the largest force by which a stretch may differ from a straight line."""


def loop_of(rows: Between, spring: int) -> tuple[Floats, Floats]:
    """Elongation and force of a spring along a motion.

    Parameters
    ----------
    rows : Between
        The motion, with rows where its hysteretic springs turn.
    spring : int
        Which one.

    Returns
    -------
    tuple of ndarray, shape (n,)
        Elongations (m) and forces without the dashpot beside it (N).
    """
    x = rows.elongation(spring, rows.u)
    elastic = rows.model.elastic.one(spring)
    if spring not in rows.model.hysteretic:
        # An elastic law is a line with one corner, gone along from end to end.
        ends = rows.extremes(x, rows.elongation(spring, rows.v))
        reached = np.clip(elastic.offset, ends.minimum, ends.maximum)
        x = np.concatenate([ends.minimum, reached, ends.maximum])
        return x, elastic_force(elastic, x)[0]
    force, _ = rows.spring_force(spring)
    z = _along(rows, spring, x, rows.hysteretic(spring))
    part = np.linspace(0.0, 1.0, _PARTS + 1)
    fine_x = x[:-1, None] + np.diff(x)[:, None] * part
    law = rows.model.law
    fine = elastic_force(elastic, fine_x)[0] + law.strength[spring] * z
    straight = force[:-1, None] + np.diff(force)[:, None] * part
    curved = np.abs(fine - straight).max(axis=1) > _STRAIGHT * np.abs(force).max()
    # All parts of what is curved, of the rest its start; then the end of all.
    shown = np.zeros(fine.shape, dtype=bool)
    shown[:, 0], shown[curved, :-1] = True, True
    shown[-1:, -1] = True
    return fine_x[shown], fine[shown]


def _along(rows: Between, spring: int, x: Floats, z: Floats) -> Floats:
    """The variable z at parts of every stretch, shape (n - 1, _PARTS + 1)."""
    dx = np.diff(x) / _PARTS
    way = np.sign(dx)
    found = np.empty((dx.size, _PARTS + 1))
    found[:, 0] = z[:-1]
    for part in range(_PARTS):
        y = found[:, part]
        k1 = rows.z_by_x(spring, y, way)
        k2 = rows.z_by_x(spring, y + 0.5 * dx * k1, way)
        k3 = rows.z_by_x(spring, y + 0.5 * dx * k2, way)
        k4 = rows.z_by_x(spring, y + dx * k3, way)
        found[:, part + 1] = y + dx * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    missed = z[1:] - found[:, -1]
    return found + missed[:, None] * np.linspace(0.0, 1.0, _PARTS + 1)
