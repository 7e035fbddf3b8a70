"""A case as it was understood: a case again, in SI with every default filled in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from types import MappingProxyType
from typing import Any

from eventpound.case.decks import deck_tables, is_of_deck
from eventpound.case.run_options import DEFAULTS, RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import NEWTON
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.plan_point import ALONG
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Spring, law_keys, storey_keys

_OF_CAPACITY = "capacities", "capacity_dimensions", "fractile"
"""Of what is stated: it has a table of its own."""
SOURCED = ("body", "spring", "contact")
"""Tables of a case that may say where their numbers are from."""


def understood_case(
    title: str,
    excitation: Mapping[str, object],
    scene: Scene,
    options: RunOptions,
    solver: SolverOptions,
    sources: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> dict[str, object]:
    """Tables of the case that says everything in SI.

    Parameters
    ----------
    title : str
        Of the case.
    excitation : mapping
        ``[excitation]`` in SI.
    scene : Scene
        Its bodies, springs, dashpots (Rayleigh damping among them) and contacts.
    options, solver : RunOptions, SolverOptions
        The options.
    sources : mapping of str to sequence of str
        Where numbers are from, of each of the `SOURCED`, empty where that is not said.

    Returns
    -------
    dict
        Loading it gives the same case.
    """
    found: dict[str, Any] = {
        "title": title,
        **({} if scene.impact_law == NEWTON else {"impact_law": scene.impact_law}),
        "excitation": dict(excitation),
        **parts_written(
            [body for body in scene.bodies if not is_of_deck(body.name, scene.decks)],
            scene.springs,
            scene.dashpots,
        ),
        "contact": [
            {
                "between": contact.written,
                "name": contact.name,
                "gap": contact.gap,
                **contact_law_keys(contact),
            }
            for contact in scene.contacts
        ],
        "run": _run(options),
        "solver": {
            "name": solver.name,
            "rtol": solver.rtol,
            "atol": dict(solver.atol),
            **solver.settings,
        },
    }
    if scene.decks:
        found["deck"] = deck_tables(scene.decks, {body.name: body for body in scene.bodies})
    if scene.seats:
        found["seat"] = [{"name": s.name, "between": list(s.between)} for s in scene.seats]
    if options.stated.capacities:
        found["capacity"] = {"fractile": options.stated.fractile, **dict(options.stated.capacities)}
    for kind, said in sources.items():
        # What joints, bearings and piers stand for comes last, and has none of its own.
        for row, source in zip(found[kind], said, strict=False):
            row |= {"source": source} if source else {}
    return found


def parts_written(
    bodies: Sequence[Body], springs: Sequence[Spring], dashpots: Sequence[Dashpot]
) -> dict[str, list[Any]]:
    """Tables of bodies, springs and dashpots, by the keys of a case (SI)."""
    return {
        "body": [
            {
                "name": body.name,
                "mass": body.mass,
                "initial": {"displacement": body.displacement, "velocity": body.velocity},
                **({"structure": body.structure} if body.structure else {}),
                **({} if body.direction == ALONG else {"direction": body.direction}),
            }
            for body in bodies
        ],
        "spring": [
            {"between": s.written, "name": s.name, **storey_keys(s), **law_keys(s.law)}
            for s in springs
        ],
        "dashpot": [{"between": d.written, "coefficient": d.coefficient} for d in dashpots],
    }


def sources_of(understood: Mapping[str, Any]) -> dict[str, list[str]]:
    """Where numbers of a case as it was understood are from."""
    return {kind: [row.get("source", "") for row in understood.get(kind, ())] for kind in SOURCED}


def contact_law_keys(contact: Contact) -> dict[str, object]:
    """Restitution, law and friction of a contact, by the keys of a case."""
    keys: dict[str, object] = {"restitution": contact.restitution}
    keys |= {"friction": contact.friction} if contact.friction else {}
    if contact.law is not None:
        law = contact.law
        keys |= {"law": law.kind, "stiffness": law.stiffness, "damping": law.damping}
        keys |= {} if law.tension else {"tension": False}
    return {key: value for key, value in keys.items() if value is not None}


def _run(run_options: RunOptions) -> dict[str, object]:
    """Options but those that are left open, and stated numbers but defaults."""
    apart = ("stated", "in_equilibrium")
    given = {key: v for key, v in asdict(run_options).items() if key not in apart and v is not None}
    # What a suite leaves to each record is no number.
    options = {key: v for key, v in given.items() if v == v}
    usual = asdict(DEFAULTS)
    stated = {key: v for key, v in asdict(run_options.stated).items() if key not in _OF_CAPACITY}
    return options | {key: v for key, v in stated.items() if v != usual[key]}
