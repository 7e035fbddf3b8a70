"""A scene that goes on where another run ended, as at an aftershock.

Displacements, velocities and internal variables are all that a run knows of its past. Which
contacts rest follows from them: those that are closed, whose gaps stand still, and that are
pressed. A contact with a law of its own is the exception: while it is closed, its law remembers how
it was struck.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from eventpound.basics.given import number
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.check import check_scene
from eventpound.scene.contact import BARRIER
from eventpound.scene.ends import opening
from eventpound.scene.linkage import starts_of_supports
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Hysteretic
from eventpound.units import Dimension

FinalState = Mapping[str, Mapping[str, float]]
"""As `eventpound.Response.final`: u and v of each body (m, m/s), variables of each memory."""
_DIMENSIONS = {"u": Dimension.LENGTH, "v": Dimension.VELOCITY}


def state_of(scene: Scene, u: Floats, v: Floats, z: Floats) -> FinalState:
    """The state of a scene: u (m) and v (m/s), shape (N,), and z, shape (H,)."""
    state: dict[str, dict[str, float]] = {
        body.name: {"u": float(u[i]), "v": float(v[i])} for i, body in enumerate(scene.bodies)
    }
    for i, (spring, name) in enumerate(scene.memory):
        state.setdefault(spring, {})[name] = float(z[i])
    return state


def continued(scene: Scene, final: FinalState, start: float = 0.0) -> Scene:
    """The scene in the state that a run of its bodies and springs ended in.

    Parameters
    ----------
    scene : Scene
        Whose initial displacements, velocities and z are replaced.
    final : mapping
        A state of each body and of each spring with a memory, by name.
    start : float
        When the run starts (s).

    Raises
    ------
    InputError
        Where a state is missing, is of something else or has no numbers, or contacts overlap.
    """
    state = _read(scene, final)
    bodies = [
        replace(body, displacement=state[body.name]["u"], velocity=state[body.name]["v"])
        for body in scene.bodies
    ]
    places = {body.name: body.displacement for body in bodies}
    places |= {BARRIER: 0.0, GROUND: 0.0, **starts_of_supports(scene, start)}
    springs = []
    for spring in scene.springs:
        law = spring.law
        if isinstance(law, Hysteretic):
            # What moves with the ground has no place of its own.
            at = dict.fromkeys(spring.ends, 0.0) | places
            law = law.going_on(float(opening(spring, 0.0, at)), state[spring.name])
        springs.append(replace(spring, law=law))
    later = replace(scene, bodies=tuple(bodies), springs=tuple(springs))
    check_scene(later, start)
    _refuse_closed(later, places)
    return later


def _read(scene: Scene, final: FinalState) -> dict[str, dict[str, float]]:
    """The numbers of a state, all of them and no others."""
    keys = {body.name: ["u", "v"] for body in scene.bodies}
    for name, key in scene.memory:
        keys.setdefault(name, []).append(key)
    if others := [repr(name) for name in final if name not in keys]:
        accepted = f"states of {', '.join(keys)}"
        raise InputError(f"start: found a state of {', '.join(others)}; accepted: {accepted}")
    found: dict[str, dict[str, float]] = {}
    for name, wanted in keys.items():
        state = final.get(name)
        if not isinstance(state, Mapping) or set(state) != set(wanted):
            accepted = f"numbers {', '.join(wanted)}"
            raise InputError(f"start: {name}: found {state!r}; accepted: {accepted}")
        found[name] = {
            key: number(f"start: {name}: {key}", state[key], _DIMENSIONS.get(key, Dimension.NUMBER))
            for key in wanted
        }
    return found


def _refuse_closed(scene: Scene, displacements: Mapping[str, float]) -> None:
    """Refuse contacts with a law of their own that are closed."""
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
