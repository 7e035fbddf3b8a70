"""The table of contact modes and transitions, written down once.

A contact is open or resting. What an instant demands of it, with g its gap
and γ the rate of the gap:

    before    g    γ      duty                  after
    open      > 0  any    none                  open
    open      = 0  > 0    none                  open
    open      = 0  < 0    impact                γ⁺ = -ε γ⁻, or more
    open      = 0  = 0    acceleration problem  resting (rest) or open
    resting   = 0  = 0    impact elsewhere      γ⁺ > 0: open (separation)
    resting   = 0  = 0    acceleration problem  open (detachment) or resting

A contact with a law is neither: its element is a link with a kink, and closes and opens by its
branch. Its gap counts as infinite here.

Impacts come first and are repeated until no closed contact approaches; the
acceleration problem over all contacts with g = γ = 0 follows. It is solved at
the start of a run, after every impact, where a contact force reaches zero,
and where the ground acceleration jumps.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eventpound.mechanics.clusters import Clusters, form_clusters_of_few
from eventpound.mechanics.model import Model
from eventpound.mechanics.observables import Bodies, view
from eventpound.mechanics.points import with_points
from eventpound.mechanics.reduced import Branches, Reduced, reduce
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import in_python, scalar_kernel
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.event_bounds import Watched
from eventpound.solvers.events.run import Dynamics

NONE, IMPACT, ACCELERATION = range(3)
"""What an instant demands of a contact: nothing, an impact, the acceleration problem."""


@scalar_kernel
def duty(gap: float, gap_rate: float) -> int:
    """What an instant demands of a contact, from g (m) and γ (m/s)."""
    if gap == 0.0 and gap_rate < 0.0:
        return IMPACT
    return ACCELERATION if gap == 0.0 and gap_rate == 0.0 else NONE


@scalar_kernel
def transition_code(was_resting: bool, rests: bool, gap_rate: float) -> int:
    """How a contact changed its mode: 0 not, 1 a rest began, 2 detachment, 3 separation.

    Parameters
    ----------
    was_resting, rests : bool
        Mode before and after.
    gap_rate : float
        γ after (m/s).
    """
    if was_resting == rests:
        return 0
    if rests:
        return 1
    return 3 if gap_rate > 0.0 else 2


@dataclass(frozen=True)
class Mode:
    """Everything the kernels need while modes and branches stay as they are.

    `dynamics`, on loan as its parts `system` and `bodies` are, is what compiled code takes of it.
    `branch` (L,): side of the kink each link is on, 0 where it has none.
    """

    branch: Ints
    clusters: Clusters
    system: Reduced
    bodies: Bodies
    watched: Watched
    dynamics: Dynamics

    @cached_property
    def directed(self) -> Reduced:
        """The same equations with directions of links that are an integrator's own."""
        return on_loan(self.system._replace(direction=np.zeros_like(self.system.direction)))

    @cached_property
    def unwatched(self) -> Dynamics:
        """The same where an integrator finds events: only extremes are looked for."""
        none, never = np.zeros_like(self.watched.unlocked), np.full(self.branch.size, np.inf)
        watched = self.watched._replace(
            open_contacts=none, unlocked=none, kink_low=-never, kink_high=never
        )
        return on_loan(Dynamics(self.system, self.bodies, watched))


class ModeTable:
    """Builds each mode of a scene once.

    Parameters
    ----------
    model : Model
        The scene.
    ledger : bool
        Whether the energy ledger is kept.
    force_noise : float
        Contact forces below this (N) have no meaningful sign.
    """

    def __init__(self, model: Model, *, ledger: bool, force_noise: float) -> None:
        self.model = model
        self.ledger = ledger
        self.force_noise = force_noise
        self.kinked = model.elastic.compression != model.elastic.extension
        self._modes: dict[tuple[bytes, ...], Mode] = {}

    def branches(self, u: Floats, v: Floats, a: Floats, onset: float, noise: float) -> Ints:
        """Side of the kink of every link: by the elongation, on the kink by its rates.

        Where it has none, it goes as the ground moves away from its body.

        Parameters
        ----------
        u, v, a : ndarray, shape (N,)
            Motion of the bodies.
        onset : float
            `eventpound.motion.forcing.ground_onset`.
        noise : float
            Elongations this close to the kink (m) are on it.
        """
        side = self.model.elongations(u) - self.model.elastic.offset
        side[np.abs(side) <= noise] = 0.0
        for rate in (v, a, np.full(u.size, -onset)):
            side = np.where(side == 0.0, self.model.elongations(rate), side)
        return np.where(self.kinked, np.where(side < 0.0, -1, 1), 0)

    def clear_sides(self, u: Floats, noise: float) -> Ints:
        """`branches` of links beyond `noise` (m) from their kinks, 0 of all others."""
        side = self.model.elongations(u) - self.model.elastic.offset
        clear = self.kinked & (np.abs(side) > noise)
        return np.where(clear, np.sign(side), 0.0).astype(np.int64)

    def mode(self, resting: Bools, branch: Ints, pressed: Bools | None = None) -> Mode:
        """The mode with these contacts at rest and these branches.

        Which of them are pressed matters only where forces are not unique.
        """
        pressed = resting if pressed is None else pressed
        key: tuple[bytes, ...] = (resting.tobytes(), branch.tobytes())
        known = self._modes.get(key)
        if known is not None and not known.clusters.tree:
            key = (*key, pressed.tobytes())
            known = self._modes.get(key)
        if known is None:
            known = self._modes[key] = self._build(resting, branch, pressed)
        return known

    def _build(self, resting: Bools, branch: Ints, pressed: Bools) -> Mode:
        model = self.model
        at_points = np.zeros(model.contacts, np.bool_)
        at_points[model.points] = True
        ordinary, projection = resting & ~at_points, None
        clusters = form_clusters_of_few(
            model.left, model.right, model.gap, ordinary, pressed, model.bodies
        )
        if (resting & at_points).any():
            clusters, projection = with_points(model, clusters, resting & at_points, pressed)
        branches = Branches(*model.elastic.on_side(branch))
        system = in_python(reduce)(
            model.link_ends,
            model.law,
            model.mass,
            model.hysteretic,
            clusters,
            branches,
            model.ledger_entries if self.ledger else 0,
        )
        if projection is not None:
            system = system._replace(projection=projection)
        frozen = np.zeros(model.hysteretic.size)
        bodies = on_loan(view(model, clusters, system, *branches, frozen))
        system = on_loan(system)
        unlocked = resting.copy()
        unlocked[clusters.resting[clusters.locked | clusters.redundant]] = False
        opened = ~resting
        opened[model.laws] = False
        kink = model.elastic.offset
        watched = Watched(
            opened,
            unlocked,
            bool((branch[model.plain :] < 0).any()),
            np.where(branch > 0, kink, -np.inf),
            np.where(branch < 0, kink, np.inf),
            self.force_noise,
            model.springs,
        )
        dynamics = on_loan(Dynamics(system, bodies, watched))
        return Mode(branch.copy(), clusters, system, bodies, watched, dynamics)
