"""Rigid blocks on a wall with friction, and what they do in closed form."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from eventpound.motion import GroundMotion, NoMotion
from eventpound.numerics.arrays import Floats
from eventpound.scene import BARRIER, Contact, Deck, Force, Scene
from eventpound.scene.deck import DeckStart

GRAVITY = 9.81
MASS = 1e4


def corner_contacts(
    deck: Deck, corners: int, friction: float, restitution: float = 0.0, gap: float = 0.0
) -> list[Contact]:
    """Contacts of the lower corners with a wall below, whose normal is y."""
    places = deck.corners[:corners]
    return [
        Contact(f"c{i}", BARRIER, deck.toward(at, (0.0, 1.0)), gap, restitution, friction=friction)
        for i, at in enumerate(places)
    ]


def block(
    friction: float, slope: float = 0.0, speed: float = 0.0, motion: GroundMotion | None = None
) -> Scene:
    """A block of 4 m x 2 m at rest on a plane, which is down to the right by an angle (rad)."""
    deck = Deck("B", MASS, 4.0, 2.0)
    weight = MASS * GRAVITY
    pulls = [Force("B.y", -weight * math.cos(slope))]
    if slope != 0.0:
        pulls.append(Force("B.x", weight * math.sin(slope)))
    return Scene(
        deck.bodies(DeckStart(velocity=(speed, 0.0))),
        contacts=corner_contacts(deck, 2, friction),
        motion=motion or NoMotion(),
        forces=pulls,
        decks=[deck],
    )


def slid(friction: float, slope: float, speed: float, t: float) -> float:
    """Where a block on a slope is after a time (m)."""
    drives, holds = GRAVITY * math.sin(slope), friction * GRAVITY * math.cos(slope)
    later = math.copysign(max(0.0, abs(drives) - holds), drives)
    if speed == 0.0:
        return 0.5 * later * t * t
    a = drives - math.copysign(holds, speed)
    stops = -speed / a if speed * a < 0.0 else math.inf
    if t <= stops:
        return speed * t + 0.5 * a * t * t
    return 0.5 * speed * stops + 0.5 * later * (t - stops) ** 2


def struck_corner(
    deck: Deck, v: Floats, friction: float, restitution: float
) -> tuple[Floats, Floats]:
    """Velocities (u', v', θ') after its first corner has struck the wall, and (Λ_N, Λ_T).

    From the regions of slip and stick in closed form.
    """
    m, J, (x, y) = deck.mass, deck.inertia_about_centre, deck.corners[0]
    rows = np.array([[0.0, 1.0, x], [1.0, 0.0, -y]])
    normal, slip = rows @ v
    a, b, c = 1.0 / m + x * x / J, 1.0 / m + y * y / J, -x * y / J
    mu, approach = friction, -(1.0 + restitution) * normal
    # A wall at the left end pushes along y, and γ_T is along -x: the tangent is to the left.
    slip, c = -slip, -c
    if slip * (a - mu * c) > approach * (mu * b - c):
        N, T = approach / (a - mu * c), -mu * approach / (a - mu * c)
    elif slip * (a + mu * c) < approach * (-mu * b - c):
        N, T = approach / (a + mu * c), mu * approach / (a + mu * c)
    else:
        N, T = np.array([[b, -c], [-c, a]]) @ np.array([approach, -slip]) / (a * b - c * c)
    impulses = np.array([N, T])
    return v + (impulses * [1.0, -1.0]) @ rows / np.array([m, m, J]), impulses


def expanded_corner(
    deck: Deck, v: Floats, friction: float, restitution: float
) -> tuple[Floats, Floats]:
    """The same by Poisson's law: it strikes without restitution, and gives back a part of Λ_N.

    What is given back opens it, since ``a - μ |c| > 0``; it stops the slip, or all of μ resists.
    """
    after, compressed = struck_corner(deck, v, friction, 0.0)
    m, J, (x, y) = deck.mass, deck.inertia_about_centre, deck.corners[0]
    rows = np.array([[0.0, 1.0, x], [-1.0, 0.0, y]])
    b, c, N = 1.0 / m + y * y / J, x * y / J, restitution * compressed[0]
    T = -(rows[1] @ after + c * N) / b
    given = np.array([N, np.clip(T, -friction * N, friction * N)])
    return after + given @ rows / np.array([m, m, J]), compressed + given


@cache
def slid_under(amplitude: float, period: float, most: float, end: float) -> float:
    """Displacement of a mass whose friction accelerates it by at most so much, to some 1e-7 m."""
    h, x, v = 1e-6, 0.0, 0.0
    for i in range(round(end / h)):
        a = -amplitude * math.sin(2.0 * math.pi * (i + 0.5) * h / period)
        free = v + h * a
        new = math.copysign(max(0.0, abs(free) - h * most), free)
        x, v = x + 0.5 * h * (v + new), new
    return x
