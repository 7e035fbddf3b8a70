"""The descriptor form of each mode of a run, and the tolerances of its unknowns."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from eventpound.mechanics.descriptor import Descriptor, descriptor_form
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.by_address import with_address
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.scales import SceneScales
from eventpound.solvers.sundials.memory import Tolerances, step_tolerances
from eventpound.tolerances import FINEST_RTOL, LEDGER_WEIGHT

LOCAL_SHARE = 0.01
"""Part of the tolerance given to one step. The errors of BDF's steps damp a motion: they add up
without cancelling, so this is a tenth of what CVODE's Adams is given."""


@dataclass(frozen=True)
class DescriptorMode:
    """A mode as IDA sees it.

    Parameters
    ----------
    descriptor : Descriptor
        With an address.
    algebraic : ndarray of bool, shape (size,)
        Unknowns whose rates do not appear.
    rtol : float
        Relative tolerance of the motion.
    atol : ndarray, shape (size,)
        Absolute tolerances of the motion.
    """

    descriptor: Descriptor
    algebraic: Bools
    rtol: float
    atol: Floats

    def local_tolerances(self, frame: Floats) -> Tolerances:
        """Relative and absolute tolerances of a step."""
        share = max(LOCAL_SHARE, FINEST_RTOL / self.rtol)
        return step_tolerances(share, self.rtol, self.atol, frame)


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
            replace(model, gap=mode.bodies.gap),
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
                np.asarray(self.atol["displacement"])[:N],
                np.asarray(self.atol["velocity"])[:N],
                np.broadcast_to(self.atol["z"], model.hysteretic.size),
                np.full(d.opening.size, self.rtol * self.scales.force),
                np.full(d.size - d.ledger if self.ledger else 0, self.atol["energy"]),
            ]
        )
        return DescriptorMode(with_address(d), algebraic, self.rtol, atol)
