"""How long a run lasts, and how finely it is put out, where a case does not say.

    formula        until 4 T_p after the end of the motion
    record         until 5 T_1 after its last sample
    output step    the record's own time step, else a 2000th of the duration

T_p = 2 pi / omega_g is the period of the motion. T_1 is the longest period of
the undamped linear system K x = omega^2 M x of the scene at rest;
motions that no spring resists are left out. Where there is no such period,
5 T_1 is left out too.
"""

from __future__ import annotations

import math
from functools import lru_cache

from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion, moves
from eventpound.motion.delayed import Delayed
from eventpound.motion.record import Record
from eventpound.scene.at_rest import at_rest
from eventpound.scene.body import Body
from eventpound.scene.grounded import grounded
from eventpound.scene.periods import longest_period
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Spring
from eventpound.units import Dimension

_PERIODS_AFTER_FORMULA = 4.0
_PERIODS_AFTER_RECORD = 5.0
_ROWS = 2000
PERIODS_KEPT = 64
"""Structures whose period is kept."""


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
    shaking = [motion for motion in scene.motions if moves(motion)]
    end = max((motion.end for motion in shaking), default=math.inf)
    end = max(end, *(force.history.end for force in scene.forces), end)
    if not math.isfinite(end):
        reason = "a motion or a force without end" if shaking else "free motion"
        raise InputError(
            f"duration: missing, and {reason} sets none; accepted: {Dimension.TIME.accepted}"
        )
    after = max(_after(motion, scene, start_time) for motion in shaking)
    duration = end + after - start_time
    if duration <= 0.0:
        raise InputError(
            "duration: missing, and the motion is over before the start of the run at "
            f"{start_time:.6g} s; accepted: {Dimension.TIME.accepted}"
        )
    return duration


def _after(motion: GroundMotion, scene: Scene, start: float) -> float:
    """Time for which a run goes on after a motion (s)."""
    if isinstance(motion.motion if isinstance(motion, Delayed) else motion, Record):
        return _PERIODS_AFTER_RECORD * _longest_period(scene, start)
    scales = motion.scales()
    return 0.0 if scales is None else _PERIODS_AFTER_FORMULA * scales.period


def default_output_step(motion: GroundMotion, duration: float) -> float:
    """Distance of the rows of the history (s), for a run of a duration (s)."""
    return motion.time_step if isinstance(motion, Record) else duration / _ROWS


def _longest_period(scene: Scene, start: float) -> float:
    """T_1 (s); zero where no spring resists anything."""
    try:
        return _period_of(scene.bodies, grounded(at_rest(scene, start)).springs)
    except InputError as error:
        raise InputError(f"missing, and {error}; accepted: {Dimension.TIME.accepted}") from error


@lru_cache(PERIODS_KEPT)
def _period_of(bodies: tuple[Body, ...], springs: tuple[Spring, ...]) -> float:
    """T_1 (s), the same under every record of a suite."""
    return longest_period(Scene(bodies, springs)) or 0.0
