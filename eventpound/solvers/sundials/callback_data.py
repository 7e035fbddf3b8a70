"""What the compiled callbacks and steps of a SUNDIALS object are handed.

A callback gets one address. It is that of a `DATA`, which says where the arrays
of the mode, of the forcing and of the moving frame are.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.solvers.events.integrator import Bounds

DATA = np.dtype(
    [
        (name, np.int64)
        for name in (
            "calls", "size", "family", "ints", "ints_size", "floats", "floats_size",
            "coefficients", "coefficients_size", "samples", "samples_size", "frame", "frame_size",
            "roots",
        )
    ]
    + [("start", np.float64)],
    align=True,
)  # fmt: skip
"""Addresses and lengths of arrays, and numbers."""
ROOT_RETURN = 2
"""Flag of CVODE and IDA where one of their root functions, if they have any, has a root."""


class Handed:
    """A `DATA` and the arrays that it names, which live as long as it does."""

    def __init__(self) -> None:
        self._data = np.zeros(1, DATA)
        self._kept: tuple[Any, ...] = ()
        self.address = self._data.ctypes.data

    @property
    def calls(self) -> int:
        """How often a callback has counted itself."""
        return int(self._data["calls"][0])

    def point_to(
        self,
        ints: Ints,
        floats: Floats,
        size: int,
        forcing: Forcing,
        frame: Floats,
        roots: int = 0,
    ) -> None:
        """Name the arrays of a mode, a forcing and a frame; `size` is that of the state.

        `roots`: address of a `eventpound.solvers.sundials.root_functions.ROOTS`, 0 for none.
        """
        coefficients, samples = map(np.ascontiguousarray, (forcing.coefficients, forcing.samples))
        self._kept = (ints, floats, coefficients, samples, frame)
        places = [place for each in self._kept for place in (each.ctypes.data, each.shape[-1])]
        # All at once, in the order of `DATA`: name by name takes several times as long.
        self._data[0] = (self.calls, size, forcing.family, *places, roots, forcing.start)


@kernel
def handed_arrays(given: Any) -> tuple[Ints, Floats, Forcing, Floats]:
    """The mode, the forcing and the frame of a `DATA`."""
    forcing = Forcing(
        given.family,
        array_at(given.coefficients, given.coefficients_size, np.float64),
        array_at(given.samples, given.samples_size, np.float64),
        given.start,
    )
    return (
        array_at(given.ints, given.ints_size, np.int64),
        array_at(given.floats, given.floats_size, np.float64),
        forcing,
        array_at(given.frame, (4, given.frame_size), np.float64),
    )


@scalar_kernel
def at_bounds(end: float, steps: int, bounds: Bounds) -> bool:
    """Whether the step that ends at the local time `end` (s) is the last."""
    return end >= bounds.stop or steps == bounds.most
