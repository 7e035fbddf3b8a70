"""A scene in words and numbers (SI), as the manifest and the export hold it."""

from __future__ import annotations

from dataclasses import asdict
from hashlib import sha256

import numpy as np

from eventpound.motion.base import GroundMotion
from eventpound.scene.contact import Contact
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.ends import written
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Spring, law_keys, storey_keys


def describe_scene(scene: Scene) -> dict[str, object]:
    """Bodies, springs, dashpots and contacts of a scene with all their parameters.

    Parameters
    ----------
    scene : Scene
        What moves.

    Returns
    -------
    dict
        Lists ``bodies`` (mass in kg, initial state in m and m/s), ``springs``
        (ends, law and its parameters in N/m, N, m), ``dashpots`` (N s/m),
        ``contacts`` (gap in m, restitution), the ``motion``'s kind, and ``supports`` and
        ``forces`` where there are some.
    """
    return {
        "bodies": [asdict(body) for body in scene.bodies],
        "springs": [describe_spring(spring) for spring in scene.springs],
        "dashpots": [_dashpot(dashpot) for dashpot in scene.dashpots],
        "contacts": [_contact(contact) for contact in scene.contacts],
        "motion": scene.motion.kind,
        **driven(scene),
    }


def _dashpot(dashpot: Dashpot) -> dict[str, object]:
    """Its ends and coefficient."""
    return {"between": dashpot.written, "coefficient": dashpot.coefficient}


def _contact(contact: Contact) -> dict[str, object]:
    """Its parameters; a law only where it has one."""
    row = asdict(contact) | {"left": written(contact.left), "right": written(contact.right)}
    return row if contact.law is not None else {k: v for k, v in row.items() if k != "law"}


def driven(scene: Scene) -> dict[str, object]:
    """Supports and forces, of a scene that has some: kinds of motion, and hashes of their numbers.

    A hash is of the smooth pieces: of their ends, formulas and samples.
    """
    found: dict[str, object] = {}
    if scene.supports:
        found["supports"] = [
            {
                "name": support.name,
                "delay": support.delay,
                "motion": support.moved_by(scene.motion).kind,
                "pieces_sha256": pieces_hash(support.moved_by(scene.motion)),
            }
            for support in scene.supports
        ]
    if scene.forces:
        found["forces"] = [
            {
                "body": force.body,
                "kind": force.history.kind,
                "per_mass": force.per_mass,
                "pieces_sha256": pieces_hash(force.history),
            }
            for force in scene.forces
        ]
    return found


def pieces_hash(motion: GroundMotion) -> str:
    """SHA-256 of the pieces of a motion."""
    whole = sha256()
    for piece in motion.pieces():
        whole.update(np.array([piece.start, piece.end, int(piece.family)], "<f8").tobytes())
        whole.update(piece.coefficients.astype("<f8").tobytes())
        whole.update(piece.samples.astype("<f8").tobytes())
    return whole.hexdigest()


def describe_spring(spring: Spring) -> dict[str, object]:
    """Ends and law of a spring.

    Parameters
    ----------
    spring : Spring
        A spring of a scene.

    Returns
    -------
    dict
        ``name``, ``between``, ``law`` and the parameters of the law (SI).
    """
    keys = law_keys(spring.law)
    return {
        "name": spring.name,
        "between": spring.written,
        **storey_keys(spring),
        **keys,
    }
