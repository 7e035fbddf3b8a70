"""Floor spectra: the largest responses of oscillators that stand on a body which may be struck.

For an oscillator of period T = 2 pi/w and damping ratio xi on a body of absolute displacement
U = u + u_g, so light that the body does not feel it, with q its elongation,

    q'' + 2 xi w q' + w^2 q = -U'',       q = q' = 0 at the start

    SD = max |q|    PSV = w SD    PSA = w^2 SD    SA = max |w^2 q + 2 xi w q'|

SA is the absolute acceleration of the oscillator. An impact of the body is an impulse on the
oscillator: where U' jumps, q' jumps by as much the other way, and q goes on. Nothing stands in
for the impact, so nothing of its force has to be resolved in time.

Between two rows U is the quintic of U, U', U'' at both, and what an oscillator makes of it is
known to rounding (`eventpound.motion.swing`). The quintic meets U and U' at the rows, so what it
errs by, e = O(h^6), acts through two integrations by parts as w^2 e: the error of q is O(h^6) of
the motion, not the O(h^4) of the accelerations. Rows are doubled until no number changes by more
than `rows.AGREEMENT`.

Source of SD, PSV, PSA: A. K. Chopra, Dynamics of Structures, chapter 6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.scaling import spectrum_columns
from eventpound.motion.swing import largest_swings
from eventpound.numerics.arrays import Floats
from eventpound.quantities.decks import translates
from eventpound.quantities.rows import Rerun, settled, warn_unsettled
from eventpound.scene.scene import Scene
from eventpound.solvers.base import History, Recording, Task
from eventpound.solvers.supported import of_ground

if TYPE_CHECKING:
    import pandas as pd

_NAME = "floor spectrum"
"""What a warning calls it."""


def largest_responses(
    history: History, scene: Scene, bodies: Sequence[int], periods: Floats, ratios: Sequence[float]
) -> Floats:
    """Largest |q| (m) and |q'' + U''| (m/s^2) of oscillators on bodies, shape (b, r, k, 2).

    Parameters
    ----------
    history : History
        Rows close together.
    scene : Scene
        Whose they are, with the motion of the ground.
    bodies : sequence of int
        Numbers of the b bodies.
    periods : ndarray, shape (k,)
        T (s).
    ratios : sequence of float
        The r ratios xi, each below 1.
    """
    t = history.t
    h = np.diff(t)
    # From the double before 0 to 0: of such a length no product is left.
    h[h < np.finfo(float).tiny] = 0.0
    found = np.zeros((len(bodies), len(ratios), periods.size, 2))
    for i, b in enumerate(bodies):
        way = scene.bodies[b].direction
        u = history.u[:, b] + of_ground(scene, way, "displacement", t)
        v, a = history.v[:, b] + of_ground(scene, way, "velocity", t), history.a[:, b]
        push = _quintic_push(u, v, a, h)
        for j, ratio in enumerate(ratios):
            largest_swings(h, push, np.diff(v), 2.0 * math.pi / periods, ratio, found[i, j])
    return found


def _quintic_push(u: Floats, v: Floats, a: Floats, h: Floats) -> Floats:
    """``h^2 U''`` over the cells by powers of x = s/h, U the quintic of both ends, (n - 1, 4)."""
    du = u[1:] - u[:-1] - h * v[:-1] - 0.5 * h**2 * a[:-1]
    dv, da = h * (v[1:] - v[:-1] - h * a[:-1]), h**2 * (a[1:] - a[:-1])
    c3 = 10.0 * du - 4.0 * dv + 0.5 * da
    c4 = -15.0 * du + 7.0 * dv - da
    c5 = 6.0 * du - 3.0 * dv + 0.5 * da
    return np.stack([h**2 * a[:-1], 6.0 * c3, 12.0 * c4, 20.0 * c5], axis=1)


def floor_table(
    task: Task, rerun: Rerun, names: Sequence[str], periods: Floats, ratios: Sequence[float]
) -> pd.DataFrame:
    """Floor spectra over a run, made again with rows close together.

    Parameters
    ----------
    task : Task
        What was asked.
    rerun : callable
        Runs a task.
    names : sequence of str
        Of the bodies.
    periods : ndarray, shape (k,)
        T (s).
    ratios : sequence of float
        Ratios of critical damping, each below 1.

    Returns
    -------
    DataFrame
        Columns body, damping, period (s), SD (m), PSV (m/s), PSA (m/s^2), PSA_g (g) and
        SA (m/s^2).

    Raises
    ------
    InputError
        Where a body is not known.
    ComputationError
        Where the run fails.
    """
    import pandas as pd

    scene = task.scene
    every = [body.name for body in scene.bodies]
    # A deck that turns shakes no oscillator on a line.
    known = [name for i, name in enumerate(every) if translates(scene, i)]
    if unknown := [name for name in names if name not in known] or (not names and ["none"]):
        raise InputError(f"body: found {', '.join(unknown)}; accepted: {', '.join(known)}")
    places = [every.index(name) for name in names]

    def numbers(recording: Recording) -> dict[str, tuple[Floats, Floats]]:
        found = largest_responses(recording.history, scene, places, periods, ratios)
        return {_NAME: (found, found)}

    found, apart = settled(task, rerun, numbers)
    warn_unsettled(_NAME, apart[_NAME])
    largest, _ = found[_NAME]
    parts = []
    for i, body in enumerate(names):
        for j, ratio in enumerate(ratios):
            table = pd.DataFrame(spectrum_columns(periods, largest[i, j, :, 0]))
            table.insert(0, "damping", ratio)
            table.insert(0, "body", body)
            parts.append(table.assign(SA=largest[i, j, :, 1]))
    whole = pd.concat(parts, ignore_index=True)
    units = {"body": "", "damping": "", "period": "s", "SD": "m", "PSV": "m/s"}
    whole.attrs["units"] = units | {"PSA": "m/s^2", "PSA_g": "g", "SA": "m/s^2"}
    return whole
