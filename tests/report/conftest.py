"""Results made by hand: bodies that bounce on a barrier and on each other, in closed form."""

import numpy as np
import pytest

from eventpound.quantities.history import EVENT_COLUMNS
from eventpound.results import StoredResults
from eventpound.results.manifest import describe_scene
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring

DURATION = 12.0
REST_FROM = 9.0
AMPLITUDE = 0.03


def _scene(bodies, contacts, hysteretic):
    law = BoucWen(1e7, 2e6, 0.01) if hysteretic else Linear(1e7)
    names = [f"deck{i}" for i in range(bodies)]
    ends = [*names, BARRIER]
    return Scene(
        tuple(Body(name, 1e6) for name in names),
        tuple(Spring(f"frame{i}", (GROUND, name), law) for i, name in enumerate(names)),
        contacts=tuple(Contact(f"joint{i}", ends[i], ends[i + 1], 0.02, 0.7) for i in range(bodies))
        if contacts
        else (),
    )


def _events(scene, bounces):
    """Impacts at k T / bounces up to the rest, which opens at DURATION - 1."""
    rows = []
    for contact in scene.contacts:
        times = REST_FROM * np.arange(1, bounces + 1) / bounces
        rows += [(t, "impact", 0, contact.name, -0.1, 0.07, 1.0, 0.0, 1) for t in times]
        rows.append((REST_FROM, "rest", 0, contact.name, 0.0, 0.0, 0.0, 0.0, 1))
        rows.append((DURATION - 1, "detachment", 0, contact.name, 0.0, 0.0, 0.0, 0.0, 1))
    return {name: [row[i] for row in rows] for i, name in enumerate(EVENT_COLUMNS)}


def _history(scene, bounces, ground, scale):
    t = np.unique(np.concatenate((np.linspace(0, DURATION, 601), [REST_FROM, DURATION - 1])))
    gap = AMPLITUDE * np.abs(np.sin(np.pi * bounces * t / REST_FROM))
    gap[(t >= REST_FROM) & (t <= DURATION - 1)] = 0.0
    columns = {"t": t, "a_g": ground * np.sin(5.0 * t)}
    for i, body in enumerate(scene.bodies):
        columns[f"u.{body.name}"] = scale * (0.02 - gap) * (len(scene.bodies) - i)
    for body, spring in zip(scene.bodies, scene.springs, strict=True):
        columns[f"force.{spring.name}"] = 1e7 * columns[f"u.{body.name}"]
    for contact in scene.contacts:
        columns[f"gap.{contact.name}"] = gap
        columns[f"lambda.{contact.name}"] = np.zeros(t.size)
    return columns


@pytest.fixture
def make_results():
    """Builder of results of a row of bodies against a barrier on the right."""

    def build(bodies=1, bounces=6, contacts=True, hysteretic=True, ground=4.0, scale=1.0):
        scene = _scene(bodies, contacts, hysteretic)
        return StoredResults(
            summary={"scene": describe_scene(scene), "success": True, "message": "done"},
            history_columns=_history(scene, bounces, ground, scale),
            event_columns=_events(scene, bounces),
            manifest={"case": {"title": "A row"}},
        )

    return build
