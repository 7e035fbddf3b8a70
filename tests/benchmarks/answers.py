"""What of a run is judged, and how far one run is from another.

Judged are the smallest displacement of each body and the final displacements,
as parts of the largest |u|, and the times of impacts as parts of the end time.
(The largest displacement of a body at a barrier is the barrier, whatever the
tolerance, so it says nothing.) Slow impacts do not count: of the closing
speeds between two parts of the largest, `SLOWEST`, the widest gap parts the slow
from the others, so that a loose tolerance moves none across.
"""

import math
from dataclasses import dataclass

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import EventKind, Recording

SLOWEST = (1e-4, 1e-2)
"""Parts of the largest closing speed between which slow impacts begin."""


@dataclass(frozen=True)
class Impact:
    """One impact: time (s), position in ``scene.contacts``, closing speed (m/s)."""

    time: float
    contact: int
    speed: float


@dataclass(frozen=True)
class Answer:
    """What of a run is judged.

    Parameters
    ----------
    u_min, u_max, final : ndarray, shape (N,)
        Smallest, largest and final displacement (m).
    impacts : tuple of Impact
        In order of time.
    """

    u_min: Floats
    u_max: Floats
    final: Floats
    impacts: tuple[Impact, ...]

    @property
    def length(self) -> float:
        """Largest |u| (m); 1 where nothing moves."""
        return max(np.abs(self.u_min).max(), np.abs(self.u_max).max()) or 1.0


@dataclass(frozen=True)
class Deviation:
    """Distance from the true answer, as a part of scale, and what is wrong besides.

    Parameters
    ----------
    error : float
        Largest of the judged errors; not a number where there is none.
    remark : str
        Empty where the impacts are the true ones.
    """

    error: float
    remark: str = ""

    def __str__(self) -> str:
        number = "-" if math.isnan(self.error) else f"{self.error:.1e}"
        return f"{number} ({self.remark})" if self.remark else number


def answer_of(recording: Recording) -> Answer:
    """What of a recording is judged."""
    impacts = tuple(
        Impact(event.t, event.contact, -event.gap_velocity_before)
        for event in recording.events
        if event.kind is EventKind.IMPACT and event.gap_velocity_before < 0.0
    )
    extremes = recording.displacement
    return Answer(extremes.minimum, extremes.maximum, recording.u, impacts)


def deviation(found: Answer, true: Answer, end: float) -> Deviation:
    """How far an answer is from the true one.

    Parameters
    ----------
    found, true : Answer
        The two.
    end : float
        Length of the run (s).
    """
    displacements = np.concatenate((found.u_min - true.u_min, found.final - true.final))
    error = float(np.abs(displacements).max()) / true.length
    threshold = _threshold(np.array([impact.speed for impact in true.impacts]))
    late = [0.0]
    for contact in {impact.contact for impact in (*found.impacts, *true.impacts)}:
        times, wanted = (
            np.array([i.time for i in a.impacts if i.contact == contact and i.speed > threshold])
            for a in (found, true)
        )
        if times.size != wanted.size:
            return Deviation(error, f"{times.size} impacts, not {wanted.size}")
        late.append(float(np.abs(times - wanted).max(initial=0.0)) / end)
    return Deviation(max(error, *late))


def _threshold(speeds: Floats) -> float:
    """Closing speed from which impacts count (m/s)."""
    if not speeds.size:
        return 0.0
    low, high = (part * speeds.max() for part in SLOWEST)
    between = np.sort(speeds[(speeds > low) & (speeds < high)])
    bounds = np.concatenate(([low], between, [high]))
    widest = int(np.argmax(np.diff(np.log(bounds))))
    return float(np.sqrt(bounds[widest] * bounds[widest + 1]))
