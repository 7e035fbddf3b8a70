"""Force against elongation between rows: loops without the corners of their rows.

Between two rows the elongation x is the cubic of x and x' at both. A hysteretic variable follows
its law along x, dz/dx, at whatever pace the spring moves; what the law misses of the next row,
which is of the order of the rows' distance, is spread along the way.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.link_law import link_law, memory_force
from eventpound.numerics.arrays import Floats
from eventpound.scene.elastic_laws import elastic_force, reduced
from eventpound.scene.spring import BoucWen, Hysteretic, Law

_PARTS = 16
"""Of the way from one row to the next."""


def loop_of(law: Law, t: Floats, x: Floats, rate: Floats, *memory: Floats) -> tuple[Floats, Floats]:
    """Elongation and force of a spring along a motion.

    Parameters
    ----------
    law : Law
        Its law.
    t, x, rate : ndarray, shape (n,)
        Times of the rows (s), elongation (m) and the rate of that (m/s).
    *memory : ndarray, shape (n,)
        Its internal variables, where it has some, z first.

    Returns
    -------
    tuple of ndarray, shape (m,)
        Elongations (m) and forces without the dashpot beside it (N).
    """
    h, part = np.diff(t)[:, None], np.linspace(0.0, 1.0, _PARTS + 1)
    rest = 1.0 - part
    left = (1.0 + 2.0 * part) * x[:-1, None] + part * h * rate[:-1, None]
    right = (1.0 + 2.0 * rest) * x[1:, None] - rest * h * rate[1:, None]
    fine = rest**2 * left + part**2 * right
    elastic = reduced(law)
    if not isinstance(law, Hysteretic):
        # An elastic law is a line with one corner, gone along from end to end.
        low, high = fine.min(), fine.max()
        ends = np.array([low, np.clip(elastic.offset, low, high), high])
        return ends, elastic_force(elastic, ends)[0]
    own, (z, *others) = link_law([law], [0.0]).memory, memory
    along = law.z_along(fine, z[:-1])
    if along is None:
        # Rows far apart for a sharp law must not make a step leave what z can reach.
        bound = law.bound if isinstance(law, BoucWen) and law.gamma >= 0.0 else np.inf
        along = _along(own, bound, fine, z, *others)
    force = elastic_force(elastic, fine)[0] + memory_force(own, along[..., None])[..., 0]
    # The last of a cell is the first of the next.
    return np.append(fine[:, :-1], fine[-1, -1]), np.append(force[:, :-1], force[-1, -1])


def _along(
    memory: Floats, bound: float, x: Floats, z: Floats, beside: Floats | None = None
) -> Floats:
    """The variable z at parts of every cell, of the shape (n - 1, _PARTS + 1) of x.

    The one beside it is that of the middle of the cell.
    """
    found, w = np.empty_like(x), 0.0 if beside is None else 0.5 * (beside[1:] + beside[:-1])
    found[:, 0] = z[:-1]
    for part, dx in enumerate(np.diff(x).T):
        y = found[:, part]
        k1 = z_by_x(memory, y, dx, w)
        k2 = z_by_x(memory, np.clip(y + 0.5 * dx * k1, -bound, bound), dx, w)
        k3 = z_by_x(memory, np.clip(y + 0.5 * dx * k2, -bound, bound), dx, w)
        k4 = z_by_x(memory, np.clip(y + dx * k3, -bound, bound), dx, w)
        mean = (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        found[:, part + 1] = np.clip(y + dx * mean, -bound, bound)
    missed = z[1:] - found[:, -1]
    found += missed[:, None] * np.linspace(0.0, 1.0, _PARTS + 1)
    return np.clip(found, -bound, bound)


def z_by_x(
    memory: Floats,
    z: Floats | float,
    way: Floats | float,
    beside: Floats | float = 0.0,
    of: int = 0,
) -> Floats:
    """Slope dz/dx (1/m) of the one law where x goes a way: grows where that is positive.

    `beside`: second number of its memory, whose own slope is that `of` 1.
    """
    # Here and not above: to read results imports no compiler.
    from eventpound.mechanics.elements import z_rate
    from eventpound.numerics.compiled import in_python

    rate: Any = in_python(z_rate)
    return np.asarray(rate(of, memory, 1.0, way, z, beside))
