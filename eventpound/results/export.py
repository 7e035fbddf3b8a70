"""A scene as JSON and CSV, so that a program in any language can solve it.

    M u'' + C u' + Σ_s B_s F_s(B_sᵀ u, z_s) − W λ = −M 1 a_g(t),   g = δ + Wᵀ u

``scene.json`` holds M (kg), C (N s/m), B and W (-), the springs with their laws,
δ (m), ε (-) and the initial state (m, m/s, -); ``motion.csv`` holds t (s) and
a_g (m/s^2). SI throughout. A scene with supports has C_s, B_s and W_s beside them and
columns of their motion, one with forces a column each; one in plan has iota and a_across.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from itertools import pairwise
from typing import get_args

import numpy as np

from eventpound.case.case import Case
from eventpound.case.run_options import Way, warn_left_out
from eventpound.errors import InputError
from eventpound.mechanics.model import assemble, differences
from eventpound.mechanics.supported import influence, support_motion
from eventpound.motion.base import Family, GroundMotion, Piece
from eventpound.numerics.arrays import Floats
from eventpound.results.files import write_together
from eventpound.results.jsontext import to_json
from eventpound.results.manifest import describe_scene
from eventpound.scene.body import Body
from eventpound.scene.contact_law import NEWTON
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Law, Series

_SAMPLES_A_PERIOD = 1000

CONVENTIONS = {
    "units": "SI: m, kg, s, N",
    "coordinates": "u is relative to the ground, positive to the right; a_g likewise",
    "equation": "M u'' + C u' + sum_s B[:,s] F_s - W lambda = -M 1 a_g(t)",
    "M": "vector of masses, the diagonal of the mass matrix",
    "matrices": "lists of rows; B has a row a body and a column a spring, W a column a contact",
    "elongation": "x = B^T u: u of the second end minus u of the first, the ground's u is 0",
    "spring_force": "F > 0 pulls the ends together",
    **{law.word.value: law.equation for law in get_args(Law)},
    "initial": "z of each spring that has one, in their order; then each epsilon",
    "contact": "gap g = delta + W^T u >= 0, complementary to its force lambda >= 0",
    "impact": "M (v+ - v-) = W L, 0 <= W^T v+ + epsilon W^T v- complementary to L >= 0",
    "motion": (
        "motion.csv is linear between its rows; two rows at one t are the values before and"
        " after a jump; zero before its first and after its last row"
    ),
}
ADDED: dict[str, tuple[Callable[[Scene], object], str]] = {
    "contact laws": (
        lambda scene: any(contact.law for contact in scene.contacts),
        "a contact with a law has no impact; its lambda is, while d = -g > 0, k d (linear),"
        " k d + 2 damping sqrt(k m) d' (kelvin-voigt; where tension is false not below 0),"
        " k d^1.5 (hertz), k d^1.5 (1 + damping d'/d0') with d0' the d' as it closed (hertz-damp),"
        " k d^1.5 + 2 damping sqrt(k sqrt(d) m) d' while d' > 0 and then k d^1.5 (jankowski);"
        " k is its stiffness, m = 1/sum_i W_i^2/M_i",
    ),
    "weight": (
        lambda scene: any(spring.weight for spring in scene.springs),
        "a spring with a weight P and a height h pulls with F - (P/h) x (P-Delta)",
    ),
    "supports": (
        lambda scene: scene.supports,
        "motion.csv has their displacement s, velocity sv = s' and acceleration sa = s'' relative"
        " to the ground; sa is linear between rows. C_s has a column a support, B_s and W_s a row:"
        " M u'' + C u' + C_s s' + sum_s B[:,s] F_s - W lambda = -M 1 a_g(t),"
        " x = B^T u + B_s^T s, g = delta + W^T u + W_s^T s, gap rates W^T v + W_s^T s'",
    ),
    "forces": (
        lambda scene: scene.forces,
        "motion.csv has the force p.<body> (N) on bodies, to be added to -M 1 a_g(t)",
    ),
    "in plan": (
        lambda scene: scene.in_plan,
        "iota has a row a body: -M (iota[:,0] a_g + iota[:,1] a_across) stands in the place of"
        " -M 1 a_g. A deck is three bodies: x, y and r theta, r the radius at its contacts",
    ),
    "friction": (
        lambda scene: scene.rubbing,
        "W_T has a column a contact: W_T^T v is how fast it slides, W_T lambda_T stands beside"
        " W lambda; while it is closed -frictions lambda <= lambda_T <= frictions lambda, and"
        " lambda_T = -frictions lambda sign(W_T^T v) while it slides; in an impact W_T L_T stands"
        " beside W L, with L_T of L and of W_T^T v+ likewise",
    ),
}
"""Conventions of what not every scene has, and whether one has it."""


def conventions_added(scene: Scene) -> dict[str, str]:
    """Conventions of what a scene has beside bodies, springs and contacts under Newton's law."""
    return {key: said for key, (there, said) in ADDED.items() if there(scene)}


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
        Where the directory cannot be written to, the case has many motions, or its impacts
        follow another law than Newton's.
    """
    case.refuse_suite()
    refuse_other_laws(case.scene, "export")
    warn_left_out(case.run, Way.EXPORT)
    start, end = case.run.start_time, case.run.start_time + case.run.duration
    scene_json = {"title": case.title, "start": start, "end": end} | _scene(case.scene, start)
    columns = _motion_columns(case.scene, start, end)
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    lines = "".join(",".join(map(repr, row)) + "\n" for row in rows)
    write_together(
        directory,
        {"motion.csv": f"{','.join(columns)}\n{lines}".encode(), "scene.json": to_json(scene_json)},
    )


def refuse_other_laws(scene: Scene, where: str) -> None:
    """Refuse impacts by another law than Newton's; a message begins with where that is."""
    if scene.impact_law != NEWTON:
        raise InputError(f"{where}: found impact_law = {scene.impact_law!r}; accepted: {NEWTON}")


def _motion_columns(scene: Scene, start: float, end: float) -> dict[str, Floats]:
    """Columns of ``motion.csv``: the ground, supports, forces."""
    moved = [support.moved_by(scene.motion) for support in scene.supports]
    pushed = [force.history for force in scene.forces]
    second = [scene.across] if scene.in_plan else []
    signals = [scene.motion, *moved, *pushed, *second]
    t, values = sampled_signals(signals, start, end)
    columns = {"t": t, "a_g": values[0]} | ({"a_across": values[-1]} if second else {})
    for support, a in zip(scene.supports, values[1 : 1 + len(moved)], strict=True):
        s, rate = support_motion(support, scene.motion, t)
        own = {"s": s, "sv": rate, "sa": a - values[0]}
        columns |= {f"{key}.{support.name}": column for key, column in own.items()}
    mass = {body.name: body.mass for body in scene.bodies}
    own_values = values[1 + len(moved) : len(values) - len(second)]
    for force, value in zip(scene.forces, own_values, strict=True):
        key = f"p.{force.body}"
        own_part = value * (mass[force.body] if force.per_mass else 1.0)
        columns[key] = columns.get(key, 0.0) + own_part
    return columns


def sampled_signals(
    motions: Sequence[GroundMotion], start: float, end: float
) -> tuple[Floats, Floats]:
    """Accelerations of motions over a run, with both values at every jump of any of them.

    A record gives its own samples; a formula is sampled a thousand times a
    period 2 pi / omega_g, and at the ends of its pieces.

    Parameters
    ----------
    motions : sequence of GroundMotion
        One or more.
    start, end : float
        The run (s).

    Returns
    -------
    t : ndarray, shape (n,)
        Not decreasing times (s), two at a jump of any of them.
    values : ndarray, shape (number of motions, n)
        Accelerations (m/s^2).
    """
    pieces = [motion.pieces() for motion in motions]
    borders = {piece.end for each in pieces for piece in each}
    inside = sorted(border for border in borders if start < border < end)
    times, values = [], []
    for low, high in pairwise([start, *inside, end]):
        parts = [next(piece for piece in each if piece.end > low) for each in pieces]
        found = [
            _piece_times(part, low, high, _step(motion))
            for motion, part in zip(motions, parts, strict=True)
        ]
        t = np.unique(np.concatenate(found))
        times.append(t)
        values.append(
            np.array([_piece_values(m, part, t) for m, part in zip(motions, parts, strict=True)])
        )
    t, table = np.concatenate(times), np.concatenate(values, axis=1)
    repeated = np.zeros(t.size, dtype=bool)
    repeated[1:] = (t[1:] == t[:-1]) & (table[:, 1:] == table[:, :-1]).all(axis=0)
    return t[~repeated], table[:, ~repeated]


def _step(motion: GroundMotion) -> float:
    """Between the rows of a formula (s)."""
    scales = motion.scales()
    return math.inf if scales is None else scales.period / _SAMPLES_A_PERIOD


def _piece_times(piece: Piece, low: float, high: float, step: float) -> Floats:
    """Times of a stretch [low, high] of a piece, its ends included."""
    if piece.family is Family.SAMPLES:
        t = _sample_times(piece)
        return np.concatenate(([low], t[(t > low) & (t < high)], [high]))
    count = 1 if piece.family is Family.ZERO else max(1, math.ceil((high - low) / step))
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


def _scene(scene: Scene, start: float) -> dict[str, object]:
    # The law of a contact has its constant, where a restitution gives it, too.
    laws = (c.law and replace(c.law, damping=c.damping) for c in scene.contacts)
    contacts = (replace(c, law=law) for c, law in zip(scene.contacts, laws, strict=True))
    described = describe_scene(replace(scene, contacts=tuple(contacts)))
    # Parts in series amount to a law of two pieces.
    condensed = (
        {"condensed": asdict(reduced(spring.law))} if isinstance(spring.law, Series) else {}
        for spring in scene.springs
    )
    parts = [influence(scene, body.direction) for body in scene.bodies]
    return described | {
        "conventions": CONVENTIONS | conventions_added(scene),
        "springs": [row | own for row, own in zip(described["springs"], condensed, strict=True)],
        **arrays_of(scene, start),
        **({"iota": parts} if scene.in_plan else {}),
    }


def arrays_of(scene: Scene, start: float = 0.0) -> dict[str, object]:
    """Masses, matrices, gaps and state at the start, by the names of ``scene.json``."""
    # Supports are ends as bodies are, and come first.
    count = len(scene.supports)
    moved = [support_motion(support, scene.motion, np.array(start)) for support in scene.supports]
    ends = tuple(
        Body(support.name, 1.0, float(s), float(rate))
        for support, (s, rate) in zip(scene.supports, moved, strict=True)
    )
    model = assemble(replace(scene, bodies=(*ends, *scene.bodies), supports=(), forces=()))
    b_links = model.elongations(np.eye(model.bodies))
    C, B = b_links * model.law.damping @ b_links.T, b_links[:, : model.springs]
    W = model.rates(np.eye(model.bodies))
    W_T = differences(model.with_points(np.eye(model.bodies)), *model.tangent.T)
    return {
        "M": model.mass[count : model.bodies],
        "C": C[count:, count:],
        "B": B[count:],
        "W": W[count:],
        **({"C_s": C[count:, :count], "B_s": B[:count], "W_s": W[:count]} if count else {}),
        "gaps": model.gap,
        "restitutions": model.restitution,
        **({"W_T": W_T[count:], "frictions": model.friction} if scene.rubbing else {}),
        "initial": {
            "u": model.u0[count : model.bodies],
            "v": model.v0[count : model.bodies],
            "z": model.z0,
        },
    }
