"""Scenes of decks in plan, drawn at random."""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion import NoMotion, Ricker
from eventpound.scene import BARRIER, GROUND, Dashpot, Deck, Joint, Linear, Scene, Spring
from eventpound.scene.deck import DeckStart, place_in_a_row


def random_plan(seed: int) -> tuple[Scene, list[Joint], float]:
    """One to three decks in a row, joints between them and at barriers, and the time of a run (s).

    Parameters
    ----------
    seed : int
        The same scene for the same seed.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 4))
    skew = float(rng.choice([0.0, *rng.uniform(-1.0, 1.0, 3)]))
    restitution = float(rng.choice([0.0, 0.5, 0.7, 1.0]))
    gaps = rng.uniform(0.005, 0.03, count + 1)
    bare = [
        Deck(f"D{i}", rng.uniform(3e5, 2e6), rng.uniform(20.0, 60.0), rng.uniform(8.0, 16.0), skew)
        for i in range(count)
    ]
    places = place_in_a_row(bare, [float(gap) for gap in gaps[1:-1]])
    decks = [
        Deck(d.name, d.mass, d.length, d.width, d.skew, (x, 0.0))
        for d, (x, _) in zip(bare, places, strict=True)
    ]
    joints = []
    ends = [BARRIER, *(deck.name for deck in decks), BARRIER]
    for i, gap in enumerate(gaps.tolist()):
        if i in (0, count) and rng.random() < 0.4:
            continue
        both = (gap, gap) if rng.random() < 0.5 else (gap, gap * rng.uniform(0.8, 1.2))
        joints.append(Joint(f"J{i}", (ends[i], ends[i + 1]), both, restitution))
    springs, dashpots = [], []
    for deck in decks:
        for word in ("x", "y", "turn"):
            end = GROUND, f"{deck.name}.{word}"
            k = deck.mass * (2.0 * math.pi / rng.uniform(0.6, 2.0)) ** 2
            springs.append(Spring(f"k-{end[1]}", end, Linear(k)))
            dashpots.append(Dashpot(end, 0.1 * math.sqrt(k * deck.mass)))
    shaken = rng.random() < 0.6
    starts = [
        DeckStart(
            (0.0, 0.0), tuple(rng.uniform(-0.2, 0.2, 2)), 0.0, float(rng.uniform(-0.01, 0.01))
        )
        for _ in decks
    ]
    scene = Scene(
        [b for d, s in zip(decks, starts, strict=True) for b in d.bodies(None if shaken else s)],
        springs,
        dashpots,
        [c for joint in joints for c in joint.contacts({d.name: d for d in decks})],
        Ricker(rng.uniform(2.0, 5.0), rng.uniform(0.5, 1.2)) if shaken else NoMotion(),
        decks=decks,
        across=Ricker(rng.uniform(1.0, 3.0), rng.uniform(0.5, 1.2)) if shaken else NoMotion(),
        attack=float(rng.choice([0.0, rng.uniform(-1.5, 1.5)])),
    )
    return scene, joints, 2.5
