"""The descriptor form of each mode of a run, the tolerances of its unknowns, and its kinks.

A contact law has a kink where an approach ends, and where a force that is cut would pull. As
`eventpound.solvers.events.reversals` does for CVODE, each law keeps to the side of its kink on
which it is (`Descriptor.way`), and a step of IDA ends where it leaves that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.mechanics.contact_elements import SMOOTH_CODES
from eventpound.mechanics.contact_laws import side_of_kink
from eventpound.mechanics.descriptor import Descriptor, descriptor_form
from eventpound.mechanics.descriptor_motion import dot
from eventpound.mechanics.model import Model
from eventpound.mechanics.observables import Observed
from eventpound.mechanics.reduced import Reduced
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python, kernel
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.reversals import HELD_BELOW, first_reversal, take_directions
from eventpound.solvers.events.scales import SceneScales
from eventpound.solvers.sundials.descriptor_steps import Tolerances
from eventpound.solvers.sundials.memory import BENT_SHARE, NO_RTOL

LOCAL_SHARE = 0.01
"""Part of the tolerance given to one step. The errors of BDF's steps damp a motion: they add up
without cancelling, so this is a tenth of what CVODE's Adams is given."""
FINEST = 1e-14
"""Smallest relative tolerance of a step; below it rounding decides which steps are accepted."""

LEDGER_WEIGHT = 1e-6
"""Factor of the rows of the ledger in the scene's own scales, those of the momentum being 1."""


@dataclass(frozen=True)
class DescriptorMode:
    """A mode as IDA sees it.

    Parameters
    ----------
    mode : Mode
        The mode of the event loop.
    descriptor : Descriptor
        On loan.
    algebraic : ndarray of bool, shape (size,)
        Unknowns whose rates do not appear.
    rtol : float
        Relative tolerance of the motion.
    atol : ndarray, shape (size,)
        Absolute tolerances of the motion.
    """

    mode: Mode
    descriptor: Descriptor
    algebraic: Bools
    rtol: float
    atol: Floats

    def take_elements(self) -> None:
        """Take over the damping of closed contact elements, which may depend on their closings.

        None keeps to a side of its kink.
        """
        d, plain = self.descriptor, self.descriptor.plain
        d.law.damping[plain:] = self.mode.bodies.damping[plain:]
        d.way[:] = 0.0

    def local_tolerances(self, frame: Floats) -> Tolerances:
        """Relative and absolute tolerances of a step."""
        share = LOCAL_SHARE
        if (self.descriptor.z_of_link < SMOOTH_CODES).any():
            share *= BENT_SHARE
        share = max(share, FINEST / self.rtol)
        if frame.shape[1] > 0:
            # Positions in a moving frame are larger than what they stand for.
            return Tolerances(NO_RTOL, 2.0 * share * self.atol)
        return Tolerances(share * self.rtol, share * self.atol)


class DescriptorModes:
    """Makes each descriptor form once.

    Parameters
    ----------
    model : Model
        The scene.
    scales : SceneScales
        Its scales.
    atol : dict
        Of `eventpound.solvers.events.scales.tolerances`.
    rtol : float
        Relative tolerance of the motion.
    ledger : bool
        Whether the energy ledger is kept.
    """

    def __init__(
        self,
        model: Model,
        scales: SceneScales,
        atol: dict[str, Floats | float],
        rtol: float,
        *,
        ledger: bool,
    ) -> None:
        self.model, self.scales, self.atol, self.rtol = model, scales, atol, rtol
        self.ledger = ledger
        self._known: dict[int, DescriptorMode] = {}

    def of(self, mode: Mode) -> DescriptorMode:
        """The descriptor form of a mode of the event loop, which keeps each for the whole run."""
        if id(mode) not in self._known:
            self._known[id(mode)] = self._build(mode)
        return self._known[id(mode)]

    def _build(self, mode: Mode) -> DescriptorMode:
        model = self.model
        d = descriptor_form(
            model,
            mode.clusters,
            mode.branch,
            ledger=model.ledger_entries if self.ledger else 0,
            ledger_weight=LEDGER_WEIGHT * self.scales.speed / self.scales.energy,
        )
        N, first = model.bodies, 2 * model.bodies + model.hysteretic.size
        algebraic = np.zeros(d.size, np.bool_)
        algebraic[d.dependent] = algebraic[N + d.dependent] = True
        algebraic[first : first + d.opening.size] = True
        atol = np.concatenate(
            [
                np.asarray(self.atol["displacement"]),
                np.asarray(self.atol["velocity"]),
                np.broadcast_to(self.atol["z"], model.hysteretic.size),
                np.full(d.opening.size, self.rtol * self.scales.force),
                np.full(d.size - d.ledger if self.ledger else 0, self.atol["energy"]),
            ]
        )
        return DescriptorMode(mode, on_loan(d), algebraic, self.rtol, atol)


def take_ways(y: Floats, system: Reduced, d: Descriptor) -> None:
    """Let the law of every closed element with a kink keep to its present side.

    `y` (size,): state of the event loop, whose mode `system` is.
    """
    direction = np.zeros(system.link.size)
    in_python(take_directions)(y, system, HELD_BELOW, direction)
    d.way[system.link[system.plain :] - d.plain] = direction[system.plain :]


@kernel
def may_pass_kink(before: Observed, y: Floats, h: float, d: Descriptor) -> bool:
    """Whether a law may leave its side within a step.

    Parameters
    ----------
    before : Observed
        What was seen at the start of the step.
    y : ndarray, shape (size,)
        Unknowns at its end, relative to the ground.
    h : float
        Its length (s).
    d : Descriptor
        The mode.
    """
    N = d.mass.size
    for p in range(d.way.size):
        link, way = d.plain + p, d.way[p]
        if way == 0.0:
            continue
        law = d.z_of_link[link], d.stiffness[link], d.preload[link], d.law.damping[link]
        x, x_rate = before.elongation[0, link], before.elongation[1, link]
        x_second = before.elongation[2, link]
        # The middle of the parabola through both ends: what leaves its side twice is seen.
        ahead = side_of_kink(*law, x + 0.5 * h * x_rate, x_rate + 0.5 * h * x_second)
        end = side_of_kink(*law, dot(d.B[link], y[:N]), dot(d.B[link], y[N : 2 * N]))
        if min(way * ahead, way * end) < 0.0:
            return True
    return False


@kernel
def first_kink(dense: Dense, last: float, origin: float, system: Reduced, d: Descriptor) -> float:
    """When in a step a law first leaves its side, and then keeps to the other (s).

    Parameters
    ----------
    dense, last, origin, system
        As of `eventpound.solvers.events.reversals.first_reversal`; inf where none does.
    d : Descriptor
        The mode.
    """
    direction = np.zeros(system.link.size)
    for a in range(system.plain, direction.size):
        direction[a] = d.way[system.link[a] - d.plain]
    tau = first_reversal(dense, last, origin, system, direction)
    for a in range(system.plain, direction.size):
        d.way[system.link[a] - d.plain] = direction[a]
    return tau
