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

from eventpound.response import Response
from eventpound.results.description import describe_scene
from eventpound.scene.pi_terms import peak_term, pi_terms
from eventpound.scene.spring import BoucWen
from eventpound.solvers.base import EventKind, Extremes


def summarise(
    response: Response,
    avoiding_gap: Mapping[str, float] | None = None,
    error_estimate: Mapping[str, object] | None = None,
) -> dict[str, object]:
    """Summary of a run.

    Parameters
    ----------
    response : Response
        What the run returned.
    avoiding_gap : mapping of str to float, optional
        Smallest gap (m) that would have avoided each contact, by its name, as
        a second run without contacts finds it.
    error_estimate : mapping, optional
        Errors of peaks and final values, as `eventpound.accuracy.estimate` finds them, in
        place of those of the response.

    Returns
    -------
    dict
        Described key by key in ``docs/results.md``.
    """
    recording = response.recording
    bodies = [body.name for body in response.scene.bodies]
    summary: dict[str, object] = {
        "solver": response.solver,
        "success": response.success,
        "message": response.message,
        "t_final": recording.t,
        "peaks": peaks_of(response),
        "residual": {n: recording.u[i] for i, n in enumerate(bodies)},
        "acceleration": {n: _extremes(recording.acceleration, i) for i, n in enumerate(bodies)},
        "springs": _springs(response),
        "base_shear": _extremes(recording.base_shear, 0),
        "impacts": response.impacts,
        "contacts": contacts_of(response, avoiding_gap or {}),
        "final": response.final,
        "scales": _scales(response),
        "pi": _pi(response),
        "error_estimate": response.error_estimate if error_estimate is None else error_estimate,
        "constraint_drift": asdict(recording.drift) if recording.drift else None,
        "work": asdict(response.work),
        "scene": describe_scene(response.scene),
    }
    if response.energy is not None:
        summary["energy"] = asdict(response.energy)
    return summary


def peaks_of(response: Response) -> dict[str, dict[str, float]]:
    """Extremes of the displacement of every body (m), by its name."""
    found, bodies = response.recording.displacement, response.scene.bodies
    return {body.name: _extremes(found, i) for i, body in enumerate(bodies)}


def _extremes(x: Extremes, i: int) -> dict[str, float]:
    """Both extremes of quantity i and the larger in size, the earlier one of equals."""
    high, low = float(x.maximum[i]), float(x.minimum[i])
    t_high, t_low = float(x.time_of_maximum[i]), float(x.time_of_minimum[i])
    upward = high > -low or (high == -low and t_high <= t_low)
    return {
        "max": high,
        "t_max": t_high,
        "min": low,
        "t_min": t_low,
        "abs_max": high if upward else -low,
        "t_abs_max": t_high if upward else t_low,
    }


def _springs(response: Response) -> dict[str, dict[str, float]]:
    springs = {}
    for i, spring in enumerate(response.scene.springs):
        entry = {
            f"{key}_elongation": value
            for key, value in _extremes(response.recording.elongation, i).items()
        }
        if isinstance(spring.law, BoucWen):
            entry["ductility"] = entry["abs_max_elongation"] / spring.law.yield_displacement
        springs[spring.name] = entry
    return springs


def contacts_of(
    response: Response, avoiding_gap: Mapping[str, float]
) -> dict[str, dict[str, object]]:
    """What became of every contact, by its name; `avoiding_gap` as for `summarise`."""
    recording = response.recording
    contacts: dict[str, dict[str, object]] = {}
    for i, contact in enumerate(response.scene.contacts):
        events = [event for event in recording.events if event.contact == i]
        unique = bool(recording.unique_forces[i])
        contacts[contact.name] = {
            "impacts": sum(
                event.count
                for event in events
                if event.kind in (EventKind.IMPACT, EventKind.ACCUMULATION)
            ),
            "resting_time": recording.resting_time[i],
            "max_impulse": max((event.impulse for event in events), default=0.0),
            "max_force": recording.max_force[i] if unique else None,
            "unique_force": unique,
            "smallest_gap": recording.smallest_gap[i],
        }
        if contact.name in avoiding_gap:
            contacts[contact.name]["avoiding_gap"] = avoiding_gap[contact.name]
    return contacts


def _scales(response: Response) -> dict[str, float | None]:
    scales = response.scene.motion.scales()
    if scales is None:
        return {"a_g": None, "omega_g": None, "L_e": None}
    return {"a_g": scales.a_g, "omega_g": scales.omega_g, "L_e": scales.length}


def _pi(response: Response) -> dict[str, float]:
    """Π-terms seen from the first body, and Π_um of every body."""
    terms = pi_terms(response.scene)
    for i, body in enumerate(response.scene.bodies):
        peak = _extremes(response.recording.displacement, i)["abs_max"]
        term = peak_term(response.scene, peak)
        if term is not None:
            terms["um" if i == 0 else f"um.{body.name}"] = term
    return terms
