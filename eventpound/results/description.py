"""A scene in words and numbers (SI), as the manifest and the export hold it."""

from __future__ import annotations

from dataclasses import asdict
from hashlib import sha256
from typing import Any

import numpy as np

from eventpound.case.understood import parts_written
from eventpound.motion.base import GroundMotion, moves
from eventpound.scene.contact import Contact
from eventpound.scene.ends import written
from eventpound.scene.scene import Scene


def describe_scene(scene: Scene) -> dict[str, Any]:
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
        ``contacts`` (gap in m, restitution), the ``motion``'s kind, and ``across``, ``supports``
        and ``forces`` where there are some.
    """
    tables = parts_written(scene.bodies, scene.springs, scene.dashpots)
    return {
        "bodies": [_flat(table) for table in tables["body"]],
        "springs": [{"name": table["name"], **table} for table in tables["spring"]],
        "dashpots": tables["dashpot"],
        "contacts": [_contact(contact) for contact in scene.contacts],
        "motion": scene.motion.kind,
        **driven(scene),
    }


def _contact(contact: Contact) -> dict[str, object]:
    """Its parameters; a law only where it has one."""
    row = asdict(contact) | {"left": written(contact.left), "right": written(contact.right)}
    return row if contact.law is not None else {k: v for k, v in row.items() if k != "law"}


def _flat(body: dict[str, Any]) -> dict[str, object]:
    """A table of a body with its state beside its mass."""
    return {"name": body["name"], "mass": body["mass"], **body.pop("initial"), **body}


def driven(scene: Scene) -> dict[str, object]:
    """What moves a scene beside the ground motion: kinds of motion, and hashes of their numbers.

    A hash is of the smooth pieces: of their ends, formulas and samples.
    """
    found: dict[str, object] = {}
    if moves(scene.across):
        found["across"] = {"motion": scene.across.kind, "pieces_sha256": pieces_hash(scene.across)}
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
