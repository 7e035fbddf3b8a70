"""Modes of a scene, each built once: the equations of motion while contacts and branches stay.

Which transitions there are `eventpound.contact.modes` tabulates.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from eventpound.contact.modes import ends_of_stick
from eventpound.mechanics.clusters import Clusters, between_of, form_clusters_of_few, have_ends
from eventpound.mechanics.elements import branch_ends, has_branches, memory_on_branches
from eventpound.mechanics.link_law import STRENGTH, YIELDING
from eventpound.mechanics.model import Model
from eventpound.mechanics.monitored import places_in
from eventpound.mechanics.oblique import are_tied, slips_of, with_slips
from eventpound.mechanics.observables import Bodies, bodies_of
from eventpound.mechanics.reduced import Branches, Reduced, reduce
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.by_address import with_address
from eventpound.numerics.compiled import in_python
from eventpound.solvers.events.event_bounds import Guards
from eventpound.solvers.events.run import Dynamics


@dataclass(frozen=True)
class Mode:
    """Everything the kernels need while modes and branches stay as they are.

    `dynamics`, by address as its parts `system` and `bodies`, is what compiled code takes of it.
    `branch` (L,): side of the kink each link is on, 0 where it has none.
    """

    branch: Ints
    clusters: Clusters
    system: Reduced
    bodies: Bodies
    guards: Guards
    dynamics: Dynamics

    @cached_property
    def directed(self) -> Reduced:
        """The same equations with directions of links that are an integrator's own."""
        return with_address(self.system._replace(direction=np.zeros_like(self.system.direction)))

    @cached_property
    def unwatched(self) -> Dynamics:
        """The same where an integrator finds events: only extremes are looked for."""
        none, never = np.zeros_like(self.guards.unlocked), np.full(self.branch.size, np.inf)
        guards = self.guards._replace(
            open_contacts=none, unlocked=none, kink_low=-never, kink_high=never
        )
        return with_address(Dynamics(self.system, self.bodies, guards))


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
        self.places = places_in(model)
        self.rubbed = np.zeros((5, model.rubbing.size))
        self._modes: dict[tuple[bytes, ...], Mode] = {}
        self._branched = [
            (h, a)
            for h, a in enumerate(model.hysteretic.tolist())
            if in_python(has_branches)(a, model.law.memory)
        ]

    def mode(
        self,
        resting: Bools,
        branch: Ints,
        pressed: Bools | None = None,
        opening: Floats | None = None,
    ) -> Mode:
        """The mode with these contacts at rest and these branches.

        Which of them are pressed matters only where forces are not unique. Sliders stick at the
        openings (K,) of their contacts (m), which change from stick to stick.
        """
        pressed = resting if pressed is None else pressed
        key: tuple[bytes, ...] = (resting.tobytes(), branch.tobytes())
        model, own = self.model, self.model.own_contacts
        if opening is not None and resting[own:].any():
            key = (*key, opening[own:][resting[own:]].tobytes())
            model = replace(model, gap=opening.copy())
        known = self._modes.get(key)
        if known is not None and not known.clusters.tree:
            key = (*key, pressed.tobytes())
            known = self._modes.get(key)
        if known is None:
            known = self._modes[key] = self._build(model, resting, branch, pressed)
        return known

    def place_ends(self, mode: Mode, u: Floats, z: Floats) -> None:
        """Say where branches of memories end, from displacements (N,) and z (H,) on them."""
        model, guards = self.model, mode.guards
        at_rest = mode.clusters.resting - model.own_contacts
        sticking = model.sliders[at_rest[at_rest >= 0]] if model.sliders.size > 0 else at_rest[:0]
        for h, a in self._branched:
            branch, offset = int(mode.branch[a]), float(model.elastic.offset[a])
            if branch != 0 and a not in sticking:
                x = float(model.elongations(u)[a])
                guards.kink_low[a], guards.kink_high[a] = in_python(branch_ends)(
                    a, model.law.memory, branch, offset, x, float(z[h])
                )

    def _build(self, model: Model, resting: Bools, branch: Ints, pressed: Bools) -> Mode:
        memory = in_python(memory_on_branches)(model.law.memory, branch)
        if memory is not model.law.memory:
            model = replace(model, law=model.law._replace(memory=memory))
        between, rubs = between_of(model), model.rubbing.size > 0
        clusters = form_clusters_of_few(between, resting, pressed)
        if rubs:
            own = model.rubbing, model.friction
            slips = in_python(slips_of)(*own, between, branch, clusters.resting)
            clusters = in_python(with_slips)(clusters, slips, model.rubbing.size, between)
        branches = Branches(*model.elastic.on_side(branch))
        links = model.link_ends, model.law, model.mass, model.hysteretic
        entries = model.ledger_entries if self.ledger else 0
        system = in_python(reduce)(*links, clusters, branches, entries)
        bodies = bodies_of(model, clusters, system, *branches, np.zeros(model.hysteretic.size))
        guards = self._guards(model, resting, branch, clusters)
        if rubs:
            bodies = bodies._replace(
                slips=np.column_stack((model.rubbing, model.holding))[slips.which],
                drag=slips.drag,
                rubbed=self.rubbed,
            )
            # What others keep from sliding does not stop.
            tied = in_python(are_tied)(slips.left, slips.right, clusters)
            kept = model.slides[slips.which[tied]]
            guards.kink_low[kept], guards.kink_high[kept] = -np.inf, np.inf
        bodies, system = with_address(bodies), with_address(system)
        dynamics = with_address(Dynamics(system, bodies, guards))
        return Mode(branch.copy(), clusters, system, bodies, guards, dynamics)

    def _guards(self, model: Model, resting: Bools, branch: Ints, clusters: Clusters) -> Guards:
        """What a mode has to watch, whatever slips."""
        opened, unlocked = ~resting, resting.copy()
        opened[model.laws] = opened[model.own_contacts :] = False
        first_holding = model.contacts - model.rubbing.size
        unlocked[clusters.resting] = in_python(have_ends)(clusters, first_holding)
        kink_low = np.where(branch > 0, model.elastic.offset, -np.inf)
        kink_high = np.where(branch < 0, model.elastic.offset, np.inf)
        kink_low[model.sliders], kink_high[model.sliders] = -np.inf, np.inf
        turns = branch == YIELDING
        turns[model.sliders] = turns[model.slides] = True
        presses, friction = np.full(model.contacts, -1), np.zeros(model.contacts)
        presses[model.holding] = model.rubbing
        friction[model.holding] = model.friction[model.rubbing]
        return Guards(
            opened,
            unlocked,
            bool((branch[model.plain :] < 0).any()),
            *_force_limits(model),
            kink_low,
            kink_high,
            turns,
            self.force_noise,
            self.places,
            presses,
            friction,
        )


def _force_limits(model: Model) -> tuple[Floats, Floats]:
    """Forces between which contacts stay at rest (N), shape (K,), of a model on its branches."""
    low, high = np.zeros(model.contacts), np.full(model.contacts, np.inf)
    for j, slip in enumerate(model.law.memory[model.sliders, STRENGTH], model.own_contacts):
        low[j], high[j] = in_python(ends_of_stick)(slip)
    return low, high
