"""What the compiled callbacks and steps of a SUNDIALS object are handed.

A callback gets one address. It is that of a `DATA`, which says where the arrays
of the mode, of the forcing and of the moving frame are, and, where SUNDIALS finds
events, where the `ROOTS` of its root functions are (`eventpound.solvers.events.roots`).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.mechanics.packing import observed_size, unpack_observed
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.borrowing import array_at
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.lcp import EPS
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.roots import (
    lift,
    marks_of,
    noise_of,
    on_the_root,
    root_functions,
    values_and_rates,
)
from eventpound.solvers.events.step_check import CLEAR, HAPPENED, Examined

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
BRACKET = 100.0
"""Width of the bracket that SUNDIALS leaves of a root, in roundings of ``|t| + |h|``."""
_FALLING, _RISING = -1, 1
ROOTS = np.dtype(
    [
        (name, np.int64)
        for name in (
            "calls", "fresh", "forces", "count", "bodies", "links", "contacts_size", "hysteretic",
            "contacts", "kinks", "noise", "lifted", "seen", "seen_size", "pairs",
        )
    ],
    align=True,
)  # fmt: skip
"""Counts, and addresses of arrays; `fresh` until the functions are first asked for, `forces`
where contact forces are among them."""


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

        `roots`: address of a `ROOTS`, 0 for none.
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


class RootFunctions:
    """A `ROOTS` and the arrays that it names.

    Parameters
    ----------
    model : Model
        The scene.
    length, force : float
        Gaps or elongations (m) and contact forces (N) below which a sign means nothing.
    """

    def __init__(self, model: Model, length: float, force: float) -> None:
        self._noise = length, force
        counts = model.bodies, model.links, model.contacts, model.hysteretic.size
        seen = np.zeros(observed_size(*counts))
        self._data = np.zeros(1, ROOTS)
        data = self._data
        data["bodies"], data["links"], data["contacts_size"], data["hysteretic"] = counts
        data["seen"], data["seen_size"] = seen.ctypes.data, seen.size
        self._kept: tuple[Any, ...] = (seen,)
        self._mode: Mode
        self._pairs = np.zeros((0, 2))
        self.address = data.ctypes.data

    @property
    def calls(self) -> int:
        """How often the functions were asked for."""
        return int(self._data["calls"][0])

    @property
    def count(self) -> int:
        """Values, each with its rate."""
        return self._pairs.shape[0]

    def point_to(self, mode: Mode) -> None:
        """Be the functions of a mode, from a start on."""
        noise = noise_of(mode.contacts, mode.kinks, *self._noise)
        self._mode, self._pairs = mode, np.zeros((noise.size, 2))
        arrays = {
            "contacts": mode.contacts,
            "kinks": mode.kinks,
            "noise": noise,
            "lifted": np.zeros(noise.size),
            "pairs": self._pairs,
        }
        for name, array in arrays.items():
            self._data[name] = array.ctypes.data
        data = self._data
        data["count"], data["fresh"], data["forces"] = noise.size, 1, mode.contacts[1].any()
        self._kept = (self._kept[0], *arrays.values())

    def set_up(
        self,
        initialise: Callable[[int, int, int], int],
        set_direction: Callable[[int, int], int],
        memory: int,
        callback: int,
    ) -> None:
        """Make SUNDIALS look for the roots: where values fall, and where their rates rise.

        Parameters
        ----------
        initialise, set_direction : callable
            ``CVodeRootInit`` and ``CVodeSetRootDirection``, or IDA's.
        memory, callback : int
            Addresses of the object and of the functions.
        """
        flag = initialise(memory, 2 * self.count, callback)
        if flag == 0 and self.count:
            directions = np.tile(np.array((_FALLING, _RISING), ctypes.c_int), self.count)
            flag = set_direction(memory, directions.ctypes.data)
        if flag != 0:
            raise MemoryError(f"SUNDIALS could not set up its search for roots (flag {flag})")

    def marks(self) -> tuple[Bools, Bools, Bools]:
        """What happened where values have fallen: closing (K,), released (K,), kinked (L,)."""
        return marks_of(self._mode.contacts, self._mode.kinks, self._pairs[:, 0] < 0.0)


Numbers = tuple[int, int, float, float, int, float, int]
"""A flag of SUNDIALS, then those of a `Stretch`."""
Steps = Callable[[float, int, float, Bounds, Examined], Numbers]
"""The compiled loop of an integrator."""


@kernel
def first_zero(roots: Any, pairs: Floats, start: float, tau: float, whole: float) -> float:
    """`on_the_root` for a root at `tau` (s) of a step from `start` to `whole` (s)."""
    noise = array_at(roots.noise, roots.count, np.float64)
    reach = BRACKET * EPS * (abs(whole) + whole - start)
    return on_the_root(pairs, noise, start, tau, reach)


def steps_to_roots(
    steps: Steps,
    at_root: Callable[[float, float, Floats, float, Floats], tuple[int, float]],
    tau: float,
    first: int,
    excess: float,
    bounds: Bounds,
    e: Examined,
) -> Numbers:
    """Steps as of `eventpound.solvers.events.integrator.Integrator.advance`, and up to an event.

    Parameters
    ----------
    steps : callable
        The compiled loop of an integrator.
    at_root : callable
        What a root at a time (s) means: `eventpound.solvers.sundials.root_stepping.at_root`
        from its second argument on.
    tau, first, excess, bounds, e
        Of `Integrator.advance`.
    """
    taken = 0
    while True:
        rest = bounds._replace(most=bounds.most - taken)
        flag, row, start, end, verdict, excess, done = steps(tau, first, excess, rest, e)
        taken += done
        if flag != ROOT_RETURN:
            return flag, row, start, end, verdict, excess, taken
        verdict, end = at_root(start, end, e.z_bound, max(e.z_allowed, excess), e.y[1 - row])
        if verdict != CLEAR:
            return flag, row, start, end, verdict, excess, taken + int(verdict == HAPPENED)
        # The bottom of a dip that stays above zero: the step goes on.
        tau, first = start, row


@kernel
def seen_of(roots: Any) -> Any:
    """The `Observed` of a `ROOTS`."""
    return unpack_observed(
        array_at(roots.seen, roots.seen_size, np.float64),
        roots.bodies,
        roots.links,
        roots.contacts_size,
        roots.hysteretic,
    )


@kernel
def evaluate(roots: Any, out: Floats) -> None:
    """The functions (2 n,) of what has been observed into `seen_of`."""
    pairs = out.reshape(roots.count, 2)
    values_and_rates(
        seen_of(roots),
        array_at(roots.contacts, (2, roots.contacts_size), np.bool_),
        array_at(roots.kinks, (2, roots.links), np.float64),
        pairs,
    )
    lifted = array_at(roots.lifted, roots.count, np.float64)
    if roots.fresh == 1:
        lift(pairs, array_at(roots.noise, roots.count, np.float64), lifted)
        roots.fresh = 0
    root_functions(pairs, lifted)
    roots.calls += 1
