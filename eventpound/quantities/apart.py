"""The smallest gap that would have avoided a contact: a run in which it cannot close.

As long as nothing touches there, the motion is that of this run: no search is needed. Either no
other contact can close, or the others are as they are, and their impacts count.

A spring of no stiffness in the place of a contact records how far it is used up. No spring can
stand for a contact at a point: that is left so wide that it does not close. Of the width, a power
of two, no digit of a gap is lost but some three at its end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.quantities.runs import Runs
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.ends import End
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Linear, Spring

_WIDER = 1024.0
_SHUT = 1e-6
"""Part of a width that is left where a contact has closed, or nearly so."""


def avoiding_gaps(scene: Scene, widened: Sequence[int], run: Callable[[Scene], Runs]) -> Floats:
    """Gaps that would have avoided contact.

    Parameters
    ----------
    scene : Scene
        With its contacts.
    widened : sequence of int
        Contacts that cannot close; the others strike as ever.
    run : callable
        Runs another scene in its place, n times where it stands for n variants.

    Returns
    -------
    ndarray, shape (n, len(widened))
        Of each of them (m); NaN where a run failed.
    """
    at_point = np.array([scene.contacts[i].at_point for i in widened], np.bool_)
    kept = [i for i, c in enumerate(scene.contacts) if c.at_point or i not in widened]
    wide = [kept.index(i) for i in widened if i in kept]
    width = 1.0
    while True:
        many = run(_apart(scene, widened, width))
        smallest = many.smallest_gap[:, wide]
        if not (smallest <= _SHUT * width).any():
            break
        width *= _WIDER
    used = np.empty((many.t.size, at_point.size))
    used[:, at_point] = width - smallest
    used[:, ~at_point] = -many.elongation.minimum[:, len(scene.springs) :]
    return np.maximum(used, 0.0)


def _apart(scene: Scene, widened: Sequence[int], width: float) -> Scene:
    """The scene with springs in the place of some contacts, those at points wide."""
    taken = {spring.name for spring in scene.springs}
    springs = []
    for contact in (scene.contacts[i] for i in widened):
        if not contact.at_point:
            springs.append(_probe(contact, taken))
            taken.add(springs[-1].name)
    contacts = tuple(
        replace(contact, gap=width) if i in widened else contact
        for i, contact in enumerate(scene.contacts)
        if contact.at_point or i not in widened
    )
    return replace(scene, contacts=contacts, springs=(*scene.springs, *springs))


def _probe(contact: Contact, taken: set[str]) -> Spring:
    """A spring that resists nothing, of a name of its own."""
    name = f"gap of {contact.name}"
    while name in taken:
        name += "'"
    return Spring(name, (_fixed(contact.left), _fixed(contact.right)), Linear(0.0))


def _fixed(end: End) -> str:
    return GROUND if end == BARRIER else str(end)
