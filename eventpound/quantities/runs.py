"""What the list of quantities is told of runs: their extremes, final states and recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from eventpound.case.case import DEFAULTS, Stated
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.quantities.contacts import ContactNumbers, blank_numbers, of_recordings
from eventpound.scene.pi_columns import ScaleColumns
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Extremes, Recording

if TYPE_CHECKING:
    from eventpound.quantities.between import Between


@dataclass(frozen=True)
class Runs:
    """Runs of n variants of a scene, as arrays; `eventpound.BatchResponse` says what each is."""

    scene: Scene
    parameters: Mapping[str, Floats]
    success: Bools
    message: list[str]
    t: Floats
    u: Floats
    v: Floats
    z: Floats
    displacement: Extremes
    elongation: Extremes
    smallest_gap: Floats
    largest_gap: Floats
    impacts: Floats
    resting_time: Floats
    steps: Ints
    acceleration: Extremes | None
    base_shear: Extremes | None
    further: Mapping[str, Floats] = field(default_factory=dict)
    recordings: Sequence[Recording] = ()
    scales: ScaleColumns | None = None
    free: Callable[[str], Floats | None] | None = None
    between: Callable[[], Between] | None = None
    apart: Callable[[tuple[int, ...]], Floats] | None = None
    stated: Stated = DEFAULTS
    struck: ContactNumbers | None = None

    @cached_property
    def contact_numbers(self) -> ContactNumbers:
        """Numbers of the contacts; NaN where impacts were not kept."""
        if self.struck is not None:
            return self.struck
        if self.recordings:
            return of_recordings(self.recordings, self.stated.threshold_speed)
        return blank_numbers(self.t.size, len(self.scene.contacts))
