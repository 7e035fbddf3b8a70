"""A scene as JSON and CSV, so that a program in any language can solve it.

    M u'' + C u' + Σ_s B_s F_s(B_sᵀ u, z_s) − W λ = −M 1 a_g(t),   g = δ + Wᵀ u

``scene.json`` holds M (kg), C (N s/m), B and W (-), the springs with their laws,
δ (m), ε (-) and the initial state (m, m/s, -); ``motion.csv`` holds t (s) and
a_g (m/s^2). SI throughout.
"""

from __future__ import annotations

import math
import os
from dataclasses import asdict

import numpy as np

from eventpound.case.case import Case
from eventpound.mechanics.model import assemble
from eventpound.motion.base import Family, GroundMotion, Piece
from eventpound.numerics.arrays import Floats
from eventpound.results.description import describe_scene, describe_spring
from eventpound.results.files import write_together
from eventpound.results.jsontext import to_json
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Series, Spring

_SAMPLES_A_PERIOD = 1000

CONVENTIONS = {
    "units": "SI: m, kg, s, N",
    "coordinates": "u is relative to the ground, positive to the right; a_g likewise",
    "equation": "M u'' + C u' + sum_s B[:,s] F_s - W lambda = -M 1 a_g(t)",
    "M": "vector of masses, the diagonal of the mass matrix",
    "matrices": "lists of rows; B has a row a body and a column a spring, W a column a contact",
    "elongation": "x = B^T u: u of the second end minus u of the first, the ground's u is 0",
    "spring_force": "F > 0 pulls the ends together",
    "linear": "F = stiffness x",
    "bilinear-elastic": (
        "F = compression (x - offset) for x < offset, extension (x - offset) above"
    ),
    "series": "parts carry one force, their elongations add up; 'condensed' is the whole",
    "bouc-wen": (
        "F = stiffness x + strength z, z' = (x' - gamma |x'| z |z|^(exponent-1)"
        " - beta x' |z|^exponent) / yield_displacement"
    ),
    "contact": "gap g = delta + W^T u >= 0, complementary to its force lambda >= 0",
    "impact": "M (v+ - v-) = W L, 0 <= W^T v+ + epsilon W^T v- complementary to L >= 0",
    "motion": (
        "motion.csv is linear between its rows; two rows at one t are the values before and"
        " after a jump; zero before its first and after its last row"
    ),
}


def export(case: Case, directory: str | os.PathLike[str]) -> None:
    """Write scene.json and motion.csv.

    Parameters
    ----------
    case : Case
        A loaded case.
    directory : path
        Where the files go; made where it is missing.

    Raises
    ------
    InputError
        Where the directory cannot be written to.
    """
    start, end = case.run.start_time, case.run.start_time + case.run.duration
    scene_json = {"title": case.title, "start": start, "end": end} | _scene(case.scene)
    t, a_g = sampled_motion(case.scene.motion, start, end)
    rows = "".join(f"{t!r},{a!r}\n" for t, a in zip(t.tolist(), a_g.tolist(), strict=True))
    write_together(
        directory,
        {"motion.csv": f"t,a_g\n{rows}".encode(), "scene.json": to_json(scene_json)},
    )


def sampled_motion(motion: GroundMotion, start: float, end: float) -> tuple[Floats, Floats]:
    """Acceleration of a motion over a run, with both values at every jump.

    A record gives its own samples; a formula is sampled a thousand times a
    period 2 pi / omega_g, and at the ends of its pieces.

    Parameters
    ----------
    motion : GroundMotion
        What moves the ground.
    start, end : float
        The run (s).

    Returns
    -------
    t, a_g : ndarray, shape (n,)
        Not decreasing times (s) and accelerations (m/s^2).
    """
    scales = motion.scales()
    step = math.inf if scales is None else scales.period / _SAMPLES_A_PERIOD
    times, values = [], []
    for piece in motion.pieces():
        low, high = max(piece.start, start), min(piece.end, end)
        if low < high:
            t = _piece_times(piece, low, high, step)
            times.append(t)
            values.append(_piece_values(motion, piece, t))
    t, a_g = np.concatenate(times), np.concatenate(values)
    repeated = np.zeros(t.size, dtype=bool)
    repeated[1:] = (t[1:] == t[:-1]) & (a_g[1:] == a_g[:-1])
    return t[~repeated], a_g[~repeated]


def _piece_times(piece: Piece, low: float, high: float, step: float) -> Floats:
    """Times of a stretch [low, high] of a piece, its ends included."""
    if piece.family is Family.SAMPLES:
        t = _sample_times(piece)
        return np.concatenate(([low], t[(t > low) & (t < high)], [high]))
    count = 1 if piece.family is Family.ZERO else math.ceil((high - low) / step)
    return np.linspace(low, high, count + 1)


def _piece_values(motion: GroundMotion, piece: Piece, t: Floats) -> Floats:
    """Acceleration at times of one piece, at its end the value before the jump."""
    if piece.family is Family.SAMPLES:
        return np.interp(t, _sample_times(piece), piece.samples)
    before_end = np.nextafter(t[-1], -math.inf)
    return motion.acceleration(np.append(t[:-1], before_end))


def _sample_times(piece: Piece) -> Floats:
    t_0, dt = piece.coefficients[:2]
    return np.asarray(t_0 + dt * np.arange(piece.samples.size))


def _scene(scene: Scene) -> dict[str, object]:
    return describe_scene(scene) | {
        "conventions": CONVENTIONS,
        "springs": [_spring(spring) for spring in scene.springs],
        **arrays_of(scene),
    }


def arrays_of(scene: Scene) -> dict[str, object]:
    """Masses, matrices, gaps and initial state of a scene, by the names of ``scene.json``."""
    model = assemble(scene)
    identity = np.eye(model.bodies)
    b_links = np.array([model.elongations(row) for row in identity])
    return {
        "M": model.mass,
        "C": b_links * model.law.damping @ b_links.T,
        "B": b_links[:, : model.springs],
        "W": np.array([model.rates(row) for row in identity]),
        "gaps": model.gap,
        "restitutions": model.restitution,
        "initial": {"u": model.u0, "v": model.v0, "z": model.z0},
    }


def _spring(spring: Spring) -> dict[str, object]:
    """Spring with the piecewise-linear law that parts in series amount to."""
    entry = describe_spring(spring)
    if isinstance(spring.law, Series):
        entry["condensed"] = asdict(reduced(spring.law))
    return entry
