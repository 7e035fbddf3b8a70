"""A scene that goes on where another run ended, as at an aftershock.

Displacements, velocities and z are all that a run knows of its past. Which contacts rest follows
from them: those that are closed, whose gaps stand still, and that are pressed. A contact with a law
of its own is the exception: while it is closed, its law remembers how it was struck.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from eventpound.errors import InputError
from eventpound.scene.check import check_scene, starts_of_supports
from eventpound.scene.contact import BARRIER, opening
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen, Hysteretic

FinalState = Mapping[str, Mapping[str, float]]
"""As `eventpound.Response.final`: u and v of each body (m, m/s), z of each spring that has one."""
_BEYOND = 0.1
"""Part of its bound by which z may exceed it at the end of a run of the largest tolerance."""


def continued(scene: Scene, final: FinalState, start: float = 0.0) -> Scene:
    """The scene in the state that a run of its bodies and springs ended in.

    Parameters
    ----------
    scene : Scene
        Whose initial displacements, velocities and z are replaced.
    final : mapping
        A state of each body and of each Bouc-Wen spring, by name.
    start : float
        When the run starts (s).

    Raises
    ------
    InputError
        Where a state is missing, is of something else or has no numbers, or contacts overlap.
    """
    names = [*(body.name for body in scene.bodies), *scene.hysteretic_springs]
    if others := [repr(name) for name in final if name not in names]:
        accepted = f"states of {', '.join(names)}"
        raise InputError(f"start: found a state of {', '.join(others)}; accepted: {accepted}")
    bodies = []
    for body in scene.bodies:
        u, v = _numbers(final, body.name, ("u", "v"))
        bodies.append(replace(body, displacement=u, velocity=v))
    springs = []
    for spring in scene.springs:
        law = spring.law
        if isinstance(law, Hysteretic) and not isinstance(law, BoucWen):
            found = f"{spring.name!r} (law {law.word}), whose memory a scene cannot begin with"
            raise InputError(f"start: found {found}; accepted: Bouc-Wen springs and elastic ones")
        if isinstance(law, BoucWen):
            (z,) = _numbers(final, spring.name, ("z",))
            # What a tolerance leaves beyond the bound is a spring that has yielded.
            within = float(np.clip(z, -law.bound, law.bound))
            law = replace(law, initial_z=within if abs(z - within) <= _BEYOND * law.bound else z)
        springs.append(replace(spring, law=law))
    later = replace(scene, bodies=tuple(bodies), springs=tuple(springs))
    check_scene(later, start)
    _refuse_closed(later, start)
    return later


def _numbers(final: FinalState, name: str, keys: Sequence[str]) -> list[float]:
    """Numbers of a state."""
    state = final.get(name)
    found = [state.get(key) for key in keys] if isinstance(state, Mapping) else []
    numbers = [float(v) for v in found if isinstance(v, float | int) and np.isfinite(v)]
    if len(numbers) != len(keys):
        raise InputError(f"start: {name}: found {state!r}; accepted: numbers {', '.join(keys)}")
    return numbers


def _refuse_closed(scene: Scene, start: float) -> None:
    """Refuse contacts with a law of their own that are closed."""
    displacements = {body.name: body.displacement for body in scene.bodies}
    displacements |= {BARRIER: 0.0, GROUND: 0.0, **starts_of_supports(scene, start)}
    closed = [
        contact.name
        for contact in scene.contacts
        if contact.law is not None and opening(contact, contact.gap, displacements) < 0.0
    ]
    if closed:
        raise InputError(
            f"start: found {', '.join(closed)} closed, whose law remembers how it was struck; "
            "accepted: the end of a run at which contacts with laws of their own are open"
        )
