"""The energy of a state, and the ledger that must close at the end of a run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eventpound.mechanics.contact_elements import NO_LAW
from eventpound.mechanics.contact_laws import stored
from eventpound.mechanics.model import WORK_OF_SUPPORTS, Model
from eventpound.motion.base import GroundMotion
from eventpound.motion.delayed import travelled
from eventpound.motion.loaded import LoadedMotion
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Energy, Event
from eventpound.solvers.events.scales import SceneScales


def stored_energy(model: Model, u: Floats, v: Floats) -> tuple[float, float]:
    """Kinetic energy, and that of the springs' ``k x`` parts and contact elements (J).

    u, v: of shape (N,).
    """
    own, springs = slice(model.supports, None), model.elastic[: model.plain]
    kinetic = 0.5 * float(model.mass[own] @ v[own] ** 2)
    compression = np.array([law.compression for law in springs], float)
    extension = np.array([law.extension for law in springs], float)
    x = model.elongations(u)[: model.plain] - np.array([law.offset for law in springs], float)
    k = np.where(x < 0.0, compression, extension)
    return kinetic, 0.5 * float(k @ x**2) + stored(model.elements, model.gaps(u))


def impact_terms(
    model: Model, motion: GroundMotion, events: Sequence[Event]
) -> tuple[float, Floats]:
    """Kinetic energy lost in impacts, and work of each support in them (J).

    An impulse Λ at a support moves it by nothing and gives ``Λ s'`` to what it strikes. Forces of
    contacts with a law of their own have done their work already.
    """
    lost = float(sum(event.energy_lost for event in events))
    given = np.zeros(model.supports)
    if not isinstance(motion, LoadedMotion):
        return lost, given
    for event in events:
        if model.elements.kind[event.contact] != NO_LAW:
            continue
        for end, sign in ((model.left[event.contact], 1.0), (model.right[event.contact], -1.0)):
            if 0 <= end < model.supports and event.impulse > 0.0:
                (_, v), (_, v_0) = (
                    travelled(m, np.array(event.t))
                    for m in (motion.loads[end].signal, motion.ground)
                )
                given[end] += sign * event.impulse * float(v - v_0)
    return lost, given


def energy_ledger(
    model: Model,
    scales: SceneScales,
    u: Floats,
    v: Floats,
    work: Floats,
    impact: float,
    struck: Floats | None = None,
) -> Energy:
    """The ledger at the state u, v.

    Parameters
    ----------
    model, scales
        The scene.
    u, v : ndarray, shape (N,)
        Displacement (m) and velocity (m/s).
    work : ndarray, shape (E,)
        Input, viscous and hysteretic work and that of supports up to there (J).
    impact : float
        Kinetic energy lost in impacts, what elements still hold included (J).
    struck : ndarray, shape (number of supports,), optional
        Work of the supports in impacts up to there (J).
    """
    impact -= stored(model.elements, model.gaps(u))
    impact += stored(model.elements, model.gaps(model.u0))
    kinetic, elastic = stored_energy(model, u, v)
    put_in, viscous, hysteretic = (float(value) for value in work[:WORK_OF_SUPPORTS])
    supports = work[WORK_OF_SUPPORTS:] + (0.0 if struck is None else struck)
    initial = sum(stored_energy(model, model.u0, model.v0))
    rest = initial + put_in + float(supports.sum())
    rest -= kinetic + elastic + hysteretic + viscous + impact
    terms = (initial, abs(put_in), kinetic, elastic, abs(hysteretic), viscous, impact)
    closure = rest / max(*terms, *np.abs(supports).tolist(), scales.energy)
    return Energy(
        initial,
        put_in,
        kinetic,
        elastic,
        hysteretic,
        viscous,
        impact,
        closure,
        tuple(supports.tolist()),
    )
