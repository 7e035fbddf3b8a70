"""What the callbacks and steps of a SUNDIALS object are handed.

A compiled callback gets one address: that of the table of a group
(`eventpound.numerics.by_address`), which stays where it is while the mode, the forcing and the
moving frame in it change. Where SUNDIALS finds events, the `Roots` of its root functions
(`eventpound.solvers.events.roots`) are part of it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import types

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.model import Model
from eventpound.mechanics.monitored import places_of
from eventpound.mechanics.observables import Bodies, Observed, blank_observed, observe_motion
from eventpound.mechanics.reduced import Forcing, Reduced
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.by_address import change_group, type_by_address, with_address
from eventpound.numerics.compiled import callback, in_python, kernel
from eventpound.solvers.events.event_bounds import Guards
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.roots import (
    lift,
    located_of,
    noise_of,
    root_functions,
    values_and_rates,
)

_FALLING, _RISING = -1, 1


class Roots(NamedTuple):
    """Root functions of a mode, n of them; with an address.

    fresh (1,): whether they are still to be asked for the first time. guards: of the `Mode`.
    noise, lifted (n,), pairs (n, 2): as `eventpound.solvers.events.roots` has them. observed:
    scratch, with an address.
    """

    fresh: Bools
    guards: Guards
    noise: Floats
    lifted: Floats
    pairs: Floats
    observed: Observed


class SegmentData(NamedTuple):
    """The segment that CVODE or IDA integrates.

    calls (2,): of the right-hand side or residual, those for Jacobians included; of Jacobians.
    system: of the mode, whose directions of links are the segment's own; it, `bodies` and `roots`
    have addresses. frame: the moving frame.
    """

    calls: Ints
    system: Reduced
    bodies: Bodies
    forcing: Forcing
    frame: Floats
    roots: Roots


_CALLBACKS: dict[tuple[Any, Any], Any] = {}


def address_of(
    function: Callable[..., Any], given: Any, pointers: int, *, reals: int = 1, after: int = 0
) -> int:
    """Address of a function that SUNDIALS calls, compiled when it is first asked for.

    Parameters
    ----------
    function : callable
        In Numba's part of Python, of numbers, then addresses, what it is handed, more addresses.
    given : named tuple
        What it is handed, with an address.
    pointers, reals, after : int
        How many addresses and numbers come before what it is handed, and addresses after it.
    """
    kind = type_by_address(given)
    if (function, kind) not in _CALLBACKS:
        before = (types.float64,) * reals + (types.intp,) * pointers
        signature = types.intc(*before, kind, *(types.intp,) * after)
        _CALLBACKS[function, kind] = callback(function, signature)
    return int(_CALLBACKS[function, kind].address)


def no_roots(bodies: int = 0, links: int = 0, contacts: int = 0, hysteretic: int = 0) -> Roots:
    """`Roots` without functions of a scene with so many of each, with an address."""
    gaps, forces = np.zeros((2, contacts), np.bool_)
    (least, most), (low, high) = np.zeros((2, contacts)), np.zeros((2, links))
    turns, at = np.zeros(links, np.bool_), in_python(places_of)(0, 0, 0)
    presses, friction = np.full(contacts, -1), np.zeros(contacts)
    return with_address(
        Roots(
            np.zeros(1, np.bool_),
            Guards(
                *(gaps, forces, False, least, most, low, high, turns, 0.0, at, presses, friction)
            ),
            np.zeros(0),
            np.zeros(0),
            np.zeros((0, 2)),
            with_address(blank_observed(bodies, links, contacts, hysteretic)),
        )
    )


NO_ROOTS = no_roots()
"""Those of a run whose events SUNDIALS does not find."""


class RootFunctions:
    """The root functions of a run, whose `Roots` live as long as it does.

    Parameters
    ----------
    model : Model
        The scene.
    length : float
        The scene's own, L (m).
    time : float
        The scene's own, T (s).

    Attributes
    ----------
    present : Roots
        Those of the present mode, at the same address for all.
    """

    def __init__(self, model: Model, length: float, time: float) -> None:
        self._length, self._time = length, time
        self._mode: Mode
        self.present = no_roots(*model.counts)

    @property
    def count(self) -> int:
        """Values, each with its rate."""
        return int(self.present.noise.size)

    @property
    def directions(self) -> list[int]:
        """Which way each function, (2 n,), passes zero at a root."""
        return [_FALLING, _RISING] * self.count

    def point_to(self, mode: Mode) -> None:
        """Be the functions of a mode, from a start on."""
        guards, noise = mode.guards, noise_of(mode.guards, self._length, self._time)
        self._mode, fresh, observed = mode, self.present.fresh, self.present.observed
        fresh[0] = True
        lifted, pairs = np.zeros(noise.size), np.zeros((noise.size, 2))
        roots = Roots(fresh, guards, noise, lifted, pairs, observed)
        change_group(self.present, roots)

    def located(self) -> tuple[Bools, Bools, Bools]:
        """The events where values have fallen: closing (K,), released (K,), kinked (L,)."""
        return located_of(self._mode.guards, self.present.pairs[:, 0] < 0.0)


@kernel
def put_roots(tau: float, y: Floats, segment: SegmentData, out: Floats) -> None:
    """Fill `out` (2 n,) with the functions of a state in the frame, which is overwritten."""
    system, forcing, roots = segment.system, segment.forcing, segment.roots
    to_frame(segment.frame, forcing.start + tau, -1.0, system.iq, system.iv, y)
    observe_motion(tau, y, np.empty(y.size), system, segment.bodies, forcing, roots.observed)
    pairs = out.reshape(roots.noise.size, 2)
    values_and_rates(roots.observed, roots.guards, pairs)
    if roots.fresh[0]:
        lift(pairs, roots.noise, roots.lifted)
        roots.fresh[0] = False
    root_functions(pairs, roots.lifted)
