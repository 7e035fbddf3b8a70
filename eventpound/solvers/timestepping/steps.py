"""The steps of a run: how long they are, by ``[solver]``, and where they stop.

``time_step`` gives the longest step. Without it there are `steps_per_period`
steps in the shortest period of the scene, the smallest of

    2π/ω with ω² = max_i (k_ii + Σ_j |k_ij|) / m_i, Gershgorin's bound of the
        highest frequency, each spring at the largest stiffness it can have
    the period 2π/ω_g of a pulse; the sampling interval of a record counts as a step
    whatever a contact element brings

or, where nothing swings, of 2π T, T being the scene's time scale.

Steps are equal on each smooth piece of the ground motion. None crosses the beginning or end
of a pulse, where the acceleration may jump. Under a record a step not longer than the sampling
interval divides it, so that every sample is met.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from eventpound.errors import InputError
from eventpound.mechanics.link_law import yielding
from eventpound.mechanics.model import Model
from eventpound.motion.base import Family, Piece
from eventpound.motion.forcing import next_sample, places_of
from eventpound.motion.loads import rows_of
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import SceneScales
from eventpound.solvers.settings import Settings, number
from eventpound.tolerances import SAME_SAMPLE

STEPS_PER_PERIOD = 100
MOST_STEPS = 2_000_000_000
"""Steps of a run; more is a slip of the unit."""
SETTINGS = {
    "time_step": "longest step (s); default: see steps_per_period",
    "steps_per_period": f"steps in the shortest period of the scene (default {STEPS_PER_PERIOD})",
}
"""What every stepper understands."""


def checked_choices(settings: Settings) -> tuple[float | None, float | None]:
    """``time_step`` (s) and ``steps_per_period``, None where they are not given.

    Raises
    ------
    InputError
        Where both are given or one is not a positive number.
    """
    given = number(settings, "time_step", "a positive time (s)", 0.0)
    steps = number(settings, "steps_per_period", "a positive number of steps", 0.0)
    if given is not None and steps is not None:
        raise InputError("[solver]: time_step and steps_per_period; accepted: one of them")
    return given, steps


def time_step(task: Task, model: Model, scales: SceneScales, contact_period: float) -> float:
    """Longest step of a run (s).

    Parameters
    ----------
    task : Task
        With the settings.
    model, scales
        The scene.
    contact_period : float
        Shortest period that a contact element brings (s), inf for none.

    Raises
    ------
    InputError
        Where both settings are given, one is not a positive number, or the run
        would take more than `MOST_STEPS`.
    """
    given, steps = checked_choices(task.settings)
    if given is None:
        period = min(_elastic_period(model), _motion_period(task, scales), contact_period)
        if not math.isfinite(period):
            period = 2.0 * math.pi * scales.time
        given = period / (steps or STEPS_PER_PERIOD)
        given = min(given, _sampling_interval(task))
    if (task.end - task.start) / given > MOST_STEPS:
        raise InputError(
            f"[solver]: a step of {given:.6g} s makes {(task.end - task.start) / given:.3g} steps; "
            f"accepted: at most {MOST_STEPS}"
        )
    return given


def largest_stiffness(model: Model) -> Floats:
    """Largest stiffness each link can have in size (N/m), (L,); of a Bouc–Wen spring the first."""
    elastic = np.maximum(abs(model.elastic.compression), abs(model.elastic.extension))
    return np.asarray(elastic + yielding(model.law.memory).stiffness)


def _elastic_period(model: Model) -> float:
    """Gershgorin's lower bound of the shortest period (s), inf where nothing is stiff."""
    row, pulls = np.zeros(model.coordinates), model.elongations(np.eye(model.bodies))
    for link, ((first, second), k) in enumerate(
        zip(model.link_ends, largest_stiffness(model), strict=True)
    ):
        if max(first, second) >= model.bodies:
            own = np.abs(pulls[:, link])
            row[: model.bodies] += own.sum() * k * own
            continue
        both = 2.0 if first >= 0 and second >= 0 else 1.0
        for b in (first, second):
            if b >= 0:
                row[b] += both * k
    highest = math.sqrt(float((row[: model.bodies] / model.mass[: model.bodies]).max()))
    return 2.0 * math.pi / highest if highest > 0.0 else math.inf


def _motion_period(task: Task, scales: SceneScales) -> float:
    """Period of a motion given by a formula (s), inf for a record or none."""
    families = {family for piece in task.scene.motion.pieces() for family, _ in signals_in(piece)}
    if families & {Family.SINUSOIDS, Family.GAUSSIAN}:
        return 2.0 * math.pi * scales.time
    return math.inf


def _sampling_interval(task: Task) -> float:
    """Sampling interval of a record (s), inf for another motion."""
    return min(
        (
            float(numbers[1])
            for piece in task.scene.motion.pieces()
            for family, numbers in signals_in(piece)
            if family is Family.SAMPLES
        ),
        default=math.inf,
    )


def signals_in(piece: Piece) -> list[tuple[Family, Floats]]:
    """Families and coefficients of all signals of a piece, of the ground the first."""
    if piece.family is not Family.LOADED:
        return [(piece.family, piece.coefficients)]
    rows = 1 + rows_of(piece.coefficients)
    places = [places_of(row, piece.coefficients) for row in range(rows)]
    return [(Family(place[0]), piece.coefficients[place[1] : place[2]]) for place in places]


@dataclass(frozen=True, slots=True)
class EqualSteps:
    """Equal steps of length `step` (s) from `start` (s), so many of them, on one piece."""

    start: float
    step: float
    steps: int
    piece: Piece


def segments(pieces: list[Piece], start: float, end: float, longest: float) -> Iterator[EqualSteps]:
    """Cut a run into segments of equal steps.

    Parameters
    ----------
    pieces : list of Piece
        The ground motion.
    start, end : float
        The run (s).
    longest : float
        Length that no step exceeds (s).

    Yields
    ------
    EqualSteps
        In order, without holes.
    """
    t = start
    for piece in pieces:
        stop = min(piece.end, end)
        if stop <= t:
            continue
        sampled = [numbers for family, numbers in signals_in(piece) if family is Family.SAMPLES]
        if sampled and longest <= sampled[0][1] * (1.0 + SAME_SAMPLE):
            # Records of one scene have the same samples; of others the first tells.
            yield from _between_samples(piece, sampled[0], t, stop, longest)
        else:
            yield _equal(piece, t, stop, longest)
        t = stop


def _equal(piece: Piece, start: float, stop: float, longest: float) -> EqualSteps:
    count = max(1, math.ceil((stop - start) / longest * (1.0 - SAME_SAMPLE)))
    return EqualSteps(start, (stop - start) / count, count, piece)


def _between_samples(
    piece: Piece, record: Floats, start: float, stop: float, longest: float
) -> Iterator[EqualSteps]:
    """Up to the first sample, from there in parts of the sampling interval, and what is left."""
    dt = float(record[1])
    first = next_sample(record, start, stop)
    on_sample = abs(first - dt - start) <= SAME_SAMPLE * dt
    if not on_sample:
        yield _equal(piece, start, first, longest)
        start = first
    intervals = math.floor((stop - start) / dt * (1.0 + SAME_SAMPLE))
    if intervals > 0:
        parts = math.ceil(dt / longest * (1.0 - SAME_SAMPLE))
        yield EqualSteps(start, dt / parts, parts * intervals, piece)
        start += intervals * dt
    if stop - start > SAME_SAMPLE * dt:
        yield _equal(piece, start, stop, longest)
