"""What was understood of a case: tables of its parts with what follows from them (SI).

K0 initial and K_s post-yield stiffness, F_y yield force, Q strength, u_y yield displacement,
alpha = K_s/K0, W weight of the mass that swings on a spring (`eventpound.scene.structures`),
T = 2 pi sqrt(m/k) its period, ratio = c / (2 sqrt(k m)) of a dashpot beside it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from eventpound.case.case import Case
from eventpound.case.decks import is_of_deck
from eventpound.case.suite import SECOND
from eventpound.case.understood import contact_law_keys, sources_of
from eventpound.errors import InputError
from eventpound.mechanics.contact_elements import drag
from eventpound.mechanics.supported import peak_of, support_motion
from eventpound.motion.base import GroundMotion, moves
from eventpound.motion.record import Record
from eventpound.scene.at_rest import at_rest, springs_at_rest, stiffness_of, theta_at_rest
from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import Element
from eventpound.scene.deck import Deck
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.modes import modes_of
from eventpound.scene.periods import period_of
from eventpound.scene.pi_terms import number_of_terms, pi_terms
from eventpound.scene.scene import Scene
from eventpound.scene.spring import (
    Backfill,
    BilinearElastic,
    BoucWen,
    Series,
    Slider,
    Spring,
    storey_keys,
)
from eventpound.scene.structures import mass_on, structures_of
from eventpound.units import STANDARD_GRAVITY

MOST_BODIES = 300
"""Of a structure whose modes are looked for: their cost grows with the third power."""
Row = dict[str, Any]


def inputs_of(case: Case) -> dict[str, Any]:
    """Everything that was understood, as JSON may hold it.

    Parameters
    ----------
    case : Case
        Of one run, or of a suite, which has no motion of its own.

    Returns
    -------
    dict
        ``title``, ``bodies``, ``springs``, ``dashpots``, ``contacts`` (a row each), ``at_rest``
        (names of springs, as `eventpound.scene.at_rest.springs_at_rest`), ``decks``, ``frames``,
        ``supports`` and ``forces`` where there are some, ``structures``
        with their ``initial`` and ``post_yield`` modes, ``motion``, ``run``, ``solver`` and
        ``pi``. What a part does not have is left out of its row.
    """
    scene = case.scene
    resting = at_rest(scene, case.run.start_time)
    carried = {spring.name: _mass_on(case, spring) for spring in scene.springs}
    found: dict[str, Any] = {
        "title": case.title,
        **({"decks": [_deck(deck) for deck in scene.decks]} if scene.decks else {}),
        "bodies": [
            {"name": b.name, "mass": b.mass, "weight": b.mass * STANDARD_GRAVITY}
            for b in scene.bodies
            if not is_of_deck(b.name, scene.decks)
        ],
        "springs": [
            _spring(spring, stiffness_of(still), carried[spring.name])
            for spring, still in zip(scene.springs, resting.springs, strict=True)
            if spring.frame is None
        ],
        **_frames(scene),
        "at_rest": springs_at_rest(scene, case.run.start_time),
        "dashpots": _dashpots(resting, carried),
        "contacts": [_contact(scene, contact) for contact in scene.contacts],
        **_driven(case),
        "structures": [_structure(resting, group) for group in structures_of(scene)],
        "motion": _motion(case),
        **_second(case),
        "run": case.run.times,
        "solver": {"name": case.solver.name, "rtol": case.solver.rtol, **case.solver.settings},
        "pi": pi_terms(scene) if scene.bodies else {},
        "pi_number": number_of_terms(scene),
    }
    for kind, sources in sources_of(case.understood).items():
        rows = found["bodies" if kind == "body" else f"{kind}s"]
        for row, source in zip(rows, sources, strict=False):
            row |= {"source": source} if source else {}
    return found


def _deck(deck: Deck) -> Row:
    """A deck in plan; ``r`` makes a displacement of its turn."""
    (x, y), mass = deck.centre, deck.mass
    return {
        "name": deck.name,
        "mass": mass,
        "weight": mass * STANDARD_GRAVITY,
        "long": deck.length,
        "wide": deck.width,
        "skew": math.degrees(deck.skew),
        "x": x,
        "y": y,
        "inertia": deck.inertia_about_centre,
        "radius": deck.radius,
    }


def _frames(scene: Scene) -> dict[str, list[Row]]:
    """Frames by their matrices, a row each; nothing of a scene that has none."""
    rows: dict[str, Row] = {}
    own = {spring.sides[1] for spring in scene.springs if spring.frame is not None}
    for spring in scene.springs:
        if spring.frame is not None:
            row = rows.setdefault(spring.frame, {"name": spring.frame, "couplings": 0, "held": 0})
            row["couplings" if spring.sides[0] in own else "held"] += 1
    return {"frames": [*rows.values()]} if rows else {}


def _driven(case: Case) -> dict[str, list[Row]]:
    """Supports and forces, a row each; nothing of a scene that has none."""
    scene, found = case.scene, dict[str, list[Row]]()
    if scene.supports:
        end, shaken = case.run.start_time + case.run.duration, case.records_at()
        rows = []
        for support in scene.supports:
            row: Row = {"name": support.name, "kind": support.moved_by(scene.motion).kind}
            rows.append(row)
            own = case.records_at(support.name)
            row |= own if support.delay is None else {"delay": support.delay}
            if own or (shaken and support.delay is not None):
                row["kind"] = "record"
                continue
            if (motion := support.motion) is not None and moves(motion):
                scales = motion.scales()
                row |= {"a_g": peak_of(motion)}
                row |= {} if scales is None else {"period": scales.period}
            if end == end:
                s, rate = support_motion(support, scene.motion, np.array(end))
                row |= {"s_end": float(s), "sv_end": float(rate)}
        found["supports"] = rows
    if scene.forces:
        mass = {body.name: body.mass for body in scene.bodies}
        found["forces"] = [
            {
                "body": force.body,
                "kind": "history" if force.history.kind == "record" else force.history.kind,
                "peak": peak_of(force.history) * (mass[force.body] if force.per_mass else 1.0),
                **({"peak/m": peak_of(force.history)} if force.per_mass else {}),
            }
            for force in scene.forces
        ]
    return found


def _mass_on(case: Case, spring: Spring) -> float | None:
    """The mass a case names for a spring, else what swings on it (kg)."""
    given = case.carried.get(spring.name)
    own = [body.mass for body in case.scene.bodies if body.name in spring.ends]
    # A case that names none has the mass of the spring's own body here.
    return given if given is not None and given not in own else mass_on(case.scene, spring)


def _spring(spring: Spring, at_rest: float, mass: float | None) -> Row:
    law = spring.law
    row: Row = {"name": spring.name, "between": spring.written, "law": law.word.value}
    row |= storey_keys(spring)
    if isinstance(law, BilinearElastic | Series):
        return row | asdict(reduced(law)) | {"at_rest": at_rest}
    if isinstance(law, Backfill | Slider):
        return row | law.numbers | ({"at_rest": at_rest} if isinstance(law, Backfill) else {})
    if spring.weight is not None:
        row["theta"] = theta_at_rest(spring)
    k_0 = row["K0"] = law.initial_stiffness if isinstance(law, BoucWen) else law.stiffness
    if isinstance(law, BoucWen):
        row |= {"K_s": law.stiffness, "F_y": k_0 * law.yield_displacement}
        row |= {"Q": law.strength, "u_y": law.yield_displacement}
        row["alpha"] = law.stiffness / k_0 if k_0 else 0.0
        row |= law.numbers if law.second else {}
    if mass is not None:
        row |= {"mass": mass, "T_initial": _finite(period_of(mass, at_rest))}
        if isinstance(law, BoucWen):
            row["F_y/W"] = row["F_y"] / (mass * STANDARD_GRAVITY)
            row["T_post_yield"] = _finite(period_of(mass, stiffness_of(spring, True)))
    return row


def _dashpots(scene: Scene, carried: Mapping[str, float | None]) -> list[Row]:
    rows = []
    for dashpot in scene.dashpots:
        ends = dashpot.written
        row: Row = {"between": ends, "coefficient": dashpot.coefficient}
        beside = [s for s in scene.springs if set(s.sides) == set(dashpot.sides)]
        masses = {carried[s.name] for s in beside}
        mass = masses.pop() if len(masses) == 1 else None
        for word, yielded in (("ratio_initial", False), ("ratio_post_yield", True)):
            k = sum(stiffness_of(s, yielded) for s in beside)
            if mass is not None and k > 0.0:
                # The product of the two may be too small for a double.
                critical = 2.0 * math.sqrt(k) * math.sqrt(mass)
                row[word] = _finite(dashpot.coefficient / critical)
        rows.append(row)
    return rows


def _contact(scene: Scene, contact: Contact) -> Row:
    """A contact; of one with a law its constants, ``c`` that of a dashpot (N s/m)."""
    ends = contact.written
    row: Row = {"name": contact.name, "between": ends, "gap": contact.gap}
    row |= contact_law_keys(contact)
    law = contact.law
    masses = {body.name: body.mass for body in scene.bodies}
    inverse = sum(w * w / masses[end] for end, w in contact.direction if end in masses)
    if contact.at_point:
        row["effective_mass"] = 1.0 / inverse
    if law is None:
        return row
    mass = row["effective_mass"] = 1.0 / inverse
    if law.element.damped:
        row["damping"] = contact.damping
    if law.element is Element.KELVIN_VOIGT:
        row["c"] = drag(law.element, contact.damping or 0.0, law.stiffness, mass)
    return row


def _structure(scene: Scene, group: list[str]) -> Row:
    """Bodies of a structure and its modes, at rest and with every spring yielded."""
    row: Row = {"bodies": group}
    if len(group) > MOST_BODIES:
        return row
    hysteretic = any(isinstance(s.law, BoucWen) and set(s.ends) & set(group) for s in scene.springs)
    for key, yielded in (("initial", False), ("post_yield", True)):
        if yielded and not hysteretic:
            continue
        try:
            modes = modes_of(scene, group, yielded)
        except InputError:
            continue
        numbers = {"period": modes.period, "share": modes.share, "damping": modes.damping}
        if modes.share_across is not None:
            numbers["share_across"] = modes.share_across
        each = zip(*(values.tolist() for values in numbers.values()), strict=True)
        row[key] = [dict(zip(numbers, map(_finite, mode), strict=True)) for mode in each]
    return row


def _motion(case: Case) -> Row:
    """The ground motion, or what a suite does with its records."""
    if told := case.records_at():
        return told
    row = _motion_itself(case.scene.motion)
    if case.record is not None:
        said = {key: getattr(case.record, key) for key in ("event", "date", "station", "component")}
        row |= {"file": case.record.file, **{key: text for key, text in said.items() if text}}
    return row


def _second(case: Case) -> dict[str, Row]:
    """The second component, and the direction of the first; nothing of a scene along a line."""
    if not case.scene.in_plan:
        return {}
    second = case.scene.across
    row = _motion_itself(second) | {"attack": math.degrees(case.scene.attack)}
    if isinstance(second, Record) and second.source is not None:
        row["file"] = second.source.file
    return {"across": row | case.records_at(SECOND)}


def _motion_itself(motion: GroundMotion) -> Row:
    row: Row = {"kind": motion.kind}
    scales = motion.scales()
    if moves(motion):
        peak = peak_of(motion)
        row |= {"a_g": peak, "a_g/g": peak / STANDARD_GRAVITY, "end": _finite(motion.end)}
    if scales is not None:
        row |= {"period": scales.period, "L_e": scales.length}
    if isinstance(motion, Record):
        row |= {"time_step": motion.time_step, "samples": motion.samples.size}
        row |= {"begins": motion.begins.tolist()} if motion.begins.size else {}
    return row


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
