"""``manifest.json``: what was run, on what, with what; enough to run it again.

The scene stands in it in words and numbers (SI), as the export has it.

It is written last and holds the SHA-256 of the other files, so a set of
results is complete where its manifest is there and agrees with them.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import PurePath
from typing import Any

import numpy as np

from eventpound.case.case import Case
from eventpound.case.understood import parts_written
from eventpound.motion.base import Family, GroundMotion, moves
from eventpound.motion.record import Record
from eventpound.response import Response
from eventpound.results.jsontext import canonical
from eventpound.scene.contact import Contact
from eventpound.scene.ends import written
from eventpound.scene.scene import Scene

FORMAT = "eventpound-results/1"
"""Name and number of the form of the files."""

WITHOUT_IMPACTS = (
    "absolute acceleration in m/s^2, impacts left out; with them: Response.at(t, logger=interval)"
)
"""What the accelerations of a history are, where bodies can collide."""
_PACKAGES = ("eventpound", "numpy", "scipy", "scikit-sundae")


def describe_run(
    response: Response, case: Case | None = None, started: datetime | None = None
) -> dict[str, object]:
    """Manifest of a run, without the hashes of the files.

    Parameters
    ----------
    response : Response
        What the run returned.
    case : Case, optional
        The case it came from.
    started : datetime, optional
        When the run began.

    Returns
    -------
    dict
        Described key by key on the page "results" of the docs.
    """
    return {
        "format": FORMAT,
        "complete": response.success,
        "started": None if started is None else started.isoformat(),
        "wall_time": response.work.seconds,
        "options": _options(response),
        **case_in_manifest(case),
        "record": _record_file(case) | _samples(response.scene.motion),
        "versions": versions(),
        "machine": machine(),
        # The header of history.csv has names only, and a spectrum of these would be far too low.
        **({"columns": {"a.": WITHOUT_IMPACTS}} if response.scene.contacts else {}),
    }


def case_in_manifest(case: Case | None) -> dict[str, object]:
    """What manifests say of a case: as it was understood, with its hash and that of its file."""
    if case is None:
        return dict.fromkeys(("case", "case_sha256", "case_file_sha256"))
    return {
        "case": case.understood,
        "case_sha256": sha256(canonical(case.understood)),
        "case_file_sha256": case.source_hash,
    }


def versions(packages: Sequence[str] = _PACKAGES) -> dict[str, str | None]:
    """Versions of Python and of the packages that numbers come from."""
    return {"python": platform.python_version()} | {p: _version(p) for p in packages}


def solved_by(solver: str, rtol: float) -> str:
    """What computed numbers, and the versions of what they come from: a sentence or two."""
    by = ", ".join(f"{name} {version}" for name, version in versions().items() if version)
    return f"Solver {solver}, relative tolerance {rtol:g}. {by}."


def machine() -> dict[str, str]:
    """What it ran on, without a name."""
    return {
        "architecture": platform.machine(),
        "system": platform.system(),
        "python_implementation": platform.python_implementation(),
    }


def sha256(content: bytes) -> str:
    """SHA-256 in hexadecimal digits.

    Parameters
    ----------
    content : bytes
        What is hashed.
    """
    return hashlib.sha256(content).hexdigest()


def _options(response: Response) -> dict[str, object]:
    task = response.task
    return {
        "solver": response.solver,
        "rtol": task.rtol,
        "atol": dict(task.atol),
        "start": task.start,
        "end": task.end,
        "outputs": len(task.output_times),
        "energy": task.energy,
        "settings": dict(task.settings),
    }


def _record_file(case: Case | None) -> dict[str, object]:
    """The file of a record; its name only, for its folder means nothing elsewhere."""
    if case is None or case.record is None:
        return {}
    record = case.record
    return {
        "file": PurePath(record.file).name,
        "file_sha256": record.sha256,
        "format": record.format,
        "units": record.units,
    }


def _samples(motion: GroundMotion) -> dict[str, object]:
    """Samples of a record as they were used: scaled, in m/s^2, little-endian doubles."""
    for piece in motion.pieces():
        if piece.family is Family.SAMPLES:
            return {
                "samples_sha256": sha256(piece.samples.astype("<f8").tobytes()),
                "samples": len(piece.samples),
                "start": piece.coefficients[0],
                "time_step": piece.coefficients[1],
                **_shocks(motion),
            }
    return {}


def _shocks(motion: GroundMotion) -> dict[str, object]:
    """When the records of a sequence begin (s), what they are called, and their factors."""
    if not isinstance(motion, Record) or not motion.begins.size:
        return {}
    names = [name for name, _ in motion.shocks]
    factors = [factor for _, factor in motion.shocks]
    return {"begins": motion.begins.tolist(), "shocks": names, "factors": factors}


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


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
    whole = hashlib.sha256()
    for piece in motion.pieces():
        whole.update(np.array([piece.start, piece.end, int(piece.family)], "<f8").tobytes())
        whole.update(piece.coefficients.astype("<f8").tobytes())
        whole.update(piece.samples.astype("<f8").tobytes())
    return whole.hexdigest()
