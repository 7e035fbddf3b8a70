"""The numbers of a run that one looks at first, as ``summary.json`` holds them.

    ductility  mu = max_t |x| / u_y       of a Bouc-Wen spring, x its elongation (m)
    Pi_um      = max_t |u| / L_e          of every body (founding paper, eq. 8)
    residual   = u at the end of the run  (m)

All values are SI; what does not exist in a scene is left out, what has no value
(the scales of a free motion, a force that is not unique) is None.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from eventpound.quantities.base import parts_of
from eventpound.quantities.batch_response import BatchResponse
from eventpound.quantities.lookup import FREE, Named, find, tabled
from eventpound.response import Response
from eventpound.results.description import describe_scene
from eventpound.scene.pi_terms import pi_terms
from eventpound.scene.scene import Scene


def summarise(
    response: Response,
    error_estimate: Mapping[str, object] | None = None,
) -> dict[str, object]:
    """Summary of a run.

    Parameters
    ----------
    response : Response
        What the run returned.
    error_estimate : mapping, optional
        Errors of peaks and final values, as `eventpound.accuracy.estimate` finds them, in
        place of those of the response.

    Returns
    -------
    dict
        Described key by key on the page "results" of the docs.
    """
    recording, runs = response.recording, response.runs
    summary: dict[str, Any] = {
        "solver": response.solver,
        "success": response.success,
        "message": response.message,
    }
    for named in tabled(runs):
        _put(summary, named, named.of_one(runs))
    for kind in ("springs", "contacts"):
        summary.setdefault(kind, {})
    for name, value in response.named.items():
        _put_named(summary, response.scene, name, value)
    scales = response.scene.motion.scales()
    known = (None,) * 3 if scales is None else (scales.a_g, scales.omega_g, scales.length)
    summary["scales"] = dict(zip(("a_g", "omega_g", "L_e"), known, strict=True))
    estimate = response.error_estimate if error_estimate is None else error_estimate
    return summary | {
        "pi": _pi(response.scene, runs),
        "error_estimate": estimate,
        "constraint_drift": asdict(recording.drift) if recording.drift else None,
        "work": asdict(response.work),
        "scene": describe_scene(response.scene),
        **({} if response.energy is None else {"energy": _ledger(response)}),
    }


def _ledger(response: Response) -> dict[str, Any]:
    """The energy ledger, with the work of each support by its name."""
    ledger = asdict(response.energy) if response.energy else {}
    works = ledger.pop("supports", ())
    names = [support.name for support in response.scene.supports]
    return ledger | ({"supports": dict(zip(names, works, strict=True))} if names else {})


def _put(summary: dict[str, Any], named: Named, value: object) -> None:
    """Put a value where its path says; the name of its owner is one key, dots and all."""
    before, _, after = parts_of(named.quantity.path)
    if not named.quantity.owner:
        keys = before.split(".")
    else:
        end = len(named.name) - len(after)
        keys = [*before.split(".")[:-1], named.name[len(before) : end], *after.split(".")[1:]]
    table = summary
    for key in keys[:-1]:
        table = table.setdefault(key, {})
    table[keys[-1]] = value


def _put_named(summary: dict[str, Any], scene: Scene, name: str, value: object) -> None:
    """Put a quantity that was named; of the first body where it says none, as others do."""
    if name.startswith(FREE):
        summary = summary.setdefault(FREE.removesuffix("."), {})
        name = name.removeprefix(FREE)
    if find(scene, f"{name}.{scene.bodies[0].name}"):
        name = f"{name}.{scene.bodies[0].name}"
    named = find(scene, name)
    assert named is not None
    _put(summary, named, value)


def _pi(scene: Scene, runs: BatchResponse) -> dict[str, float]:
    """Π-terms seen from the first body, and Π_um of every body."""
    terms = pi_terms(scene)
    for i, body in enumerate(scene.bodies if runs.scales else ()):
        named = find(scene, f"pi_um.{body.name}")
        assert named is not None
        terms["um" if i == 0 else f"um.{body.name}"] = float(named.of(runs)[0])
    return terms
