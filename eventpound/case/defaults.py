"""How long a run lasts, and how finely it is put out, where a case does not say.

    formula        until 4 T_p after the end of the motion
    record         until 5 T_1 after its last sample
    output step    the record's own time step, else a 2000th of the duration

T_p = 2 pi / omega_g is the period of the motion. T_1 is the longest period of
the undamped linear system K x = omega^2 M x with every spring at its initial
stiffness (one with a kink at the smaller of its stiffnesses that are not zero);
motions that no spring resists are left out. Where there is no such period,
5 T_1 is left out too.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion
from eventpound.motion.record import Record
from eventpound.scene.damping import initial_stiffness
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BilinearElastic, Linear, Series, Spring
from eventpound.units import Dimension

_PERIODS_AFTER_FORMULA = 4.0
_PERIODS_AFTER_RECORD = 5.0
_ROWS = 2000
# Squared frequencies this far below the largest are rigid motions: rounding
# leaves some N eps of the largest, and a structure spans far fewer decades.
_RIGID = 1.0e-12


def default_duration(scene: Scene, start_time: float) -> float:
    """Duration of a run that does not say it.

    Parameters
    ----------
    scene : Scene
        Without problems.
    start_time : float
        When the run starts (s).

    Returns
    -------
    float
        Duration (s), positive.

    Raises
    ------
    InputError
        For free motion, a motion without end, or one over before the start.
    """
    motion = scene.motion
    scales = motion.scales()
    if scales is None or not math.isfinite(motion.end):
        reason = "free motion" if scales is None else "a motion without end"
        raise InputError(f"missing, and {reason} sets none; accepted: {Dimension.TIME.accepted}")
    if isinstance(motion, Record):
        after = _PERIODS_AFTER_RECORD * (longest_period(scene) or 0.0)
    else:
        after = _PERIODS_AFTER_FORMULA * scales.period
    duration = motion.end + after - start_time
    if duration <= 0.0:
        raise InputError(
            f"missing, and the motion is over before the start of the run at {start_time:.6g} s; "
            f"accepted: {Dimension.TIME.accepted}"
        )
    return duration


def default_output_step(motion: GroundMotion, duration: float) -> float:
    """Distance of the rows of the history (s), for a run of a duration (s)."""
    return motion.time_step if isinstance(motion, Record) else duration / _ROWS


def longest_period(scene: Scene) -> float | None:
    """Longest period of a scene without damping and contacts, T_1.

    Parameters
    ----------
    scene : Scene
        Without problems.

    Returns
    -------
    float or None
        T_1 (s); None where no spring resists anything.

    Raises
    ------
    InputError
        Where a stiffness over a mass is no double.
    """
    if not scene.bodies:
        return None
    index = {body.name: i for i, body in enumerate(scene.bodies)}
    root_mass = np.sqrt([body.mass for body in scene.bodies])
    stiffness = np.zeros((len(index), len(index)))
    for spring in scene.springs:
        k = _nominal_stiffness(spring)
        ends = [
            (index[end], sign)
            for end, sign in zip(spring.between, (-1.0, 1.0), strict=True)
            if end != GROUND
        ]
        for i, sign_i in ends:
            for j, sign_j in ends:
                stiffness[i, j] += sign_i * sign_j * k
    with np.errstate(all="ignore"):
        matrix = stiffness / np.outer(root_mass, root_mass)
    if not np.isfinite(matrix).all():
        raise InputError(
            "missing, and stiffness over mass is too large to be computed with; "
            f"accepted: {Dimension.TIME.accepted}"
        )
    squares = np.linalg.eigvalsh(matrix)
    elastic = squares[squares > _RIGID * squares[-1]]
    return 2.0 * math.pi / math.sqrt(elastic[0]) if elastic.size else None


def _nominal_stiffness(spring: Spring) -> float:
    """Initial stiffness, or one that stands for a law with a kink (N/m)."""
    law = spring.law
    if isinstance(law, Series):
        stiffnesses = [_part_stiffness(part) for part in law.parts]
        return 1.0 / sum(1.0 / k for k in stiffnesses) if all(stiffnesses) else 0.0
    if isinstance(law, BilinearElastic):
        return _part_stiffness(law)
    return initial_stiffness(law) or 0.0


def _part_stiffness(law: Linear | BilinearElastic) -> float:
    if isinstance(law, Linear):
        return law.stiffness
    return min((k for k in (law.compression, law.extension) if k > 0.0), default=0.0)
