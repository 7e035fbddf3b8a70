"""One gap for each joint with which nothing touches: proved by runs with it, and with 1 % less."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from eventpound import Record, Response, Ricker, design_numbers, load_case, simulate, simulate_many
from eventpound.results.shown_units import Units
from eventpound.scene import (
    BARRIER,
    GROUND,
    Backfill,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Deck,
    Joint,
    Linear,
    Point,
    Scene,
    Slider,
    Spring,
    Support,
)
from eventpound.scene.joints import joints_of
from eventpound.solvers.base import Event, EventKind

END = 5.0


class Built:
    """Parts of a scene, added one by one."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.bodies: list[Body] = []
        self.springs: list[Spring] = []
        self.dashpots: list[Dashpot] = []
        self.contacts: list[Contact] = []
        self.supports: list[Support] = []

    def drawn(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def body(self, name: str, mass: float) -> str:
        self.bodies.append(Body(name, mass))
        return name

    def link(self, ends: tuple[str, str], law: object, drag: float) -> None:
        name = f"{ends[0]}-{ends[1]}-{len(self.springs)}"
        self.springs.append(Spring(name, ends, law))
        self.dashpots.append(Dashpot(ends, drag))

    def contact(self, left: str | Point, right: str | Point, gap: float) -> None:
        name = f"c{len(self.contacts)}"
        self.contacts.append(Contact(name, left, right, gap, self.drawn(0.3, 0.9)))

    def scene(self) -> Scene:
        noise = self.rng.normal(0.0, 1.0, 180)
        smooth = np.convolve(noise, np.hanning(9) / np.hanning(9).sum(), "same")
        record = Record(4.0 * smooth / np.abs(smooth).max(), 0.02)
        return Scene(self.bodies, self.springs, self.dashpots, self.contacts, record, self.supports)


def building(b: Built, name: str, storeys: int, period: float) -> list[str]:
    """A frame that yields in its lowest storey."""
    mass = 1e5
    stiffness = mass * (2.0 * np.pi / period) ** 2 * storeys**2 / 2.0
    below, floors = GROUND, []
    for i in range(storeys):
        floor = b.body(f"{name}{i + 1}", mass)
        yielding = BoucWen(0.1 * stiffness, 0.02 * stiffness, 0.022)
        law = yielding if i == 0 and b.rng.random() < 0.5 else Linear(stiffness)
        b.link((below, floor), law, 0.04 * np.sqrt(stiffness * mass))
        floors.append(floor)
        below = floor
    return floors


def buildings(seed: int) -> Scene:
    """Two or three unlike buildings; floors meet floors, or columns between floors."""
    b = Built(seed)
    rows = [
        building(b, name, int(b.rng.integers(2, 5)), b.drawn(0.35, 1.1))
        for name in "ABC"[: int(b.rng.integers(2, 4))]
    ]
    for left, right in pairwise(rows):
        gap = b.drawn(0.01, 0.05)
        for i in range(min(len(left), len(right))):
            own = gap if seed % 2 else gap + 0.01 * i
            end: str | Point = right[i]
            if i and seed % 3 == 0:
                end = Point({right[i - 1]: 0.4, right[i]: 0.6})
            b.contact(left[i], end, own)
    return b.scene()


def bridge(seed: int) -> Scene:
    """Decks on piers, between abutments with soil, one perhaps on ground of its own."""
    b = Built(seed)
    east = "east" if seed % 2 else GROUND
    if seed % 2:
        b.supports.append(Support("east", 0.15))
    decks = [b.body(f"D{i}", b.drawn(4e5, 9e5)) for i in range(3)]
    for i in range(2):
        pier = b.body(f"P{i}", 1e5)
        stiffness = b.drawn(2e7, 6e7)
        b.link((GROUND, pier), BoucWen(0.1 * stiffness, 0.01 * stiffness, 0.011), 3e5)
        for deck in decks[i : i + 2]:
            b.link((pier, deck), Linear(b.drawn(1e7, 4e7)), 2e5)
    b.link((GROUND, decks[0]), Slider.pendulum(0.04, 2e6, 2.0), 1e4)
    b.link((decks[2], east), Backfill.of_wall(1.7, 8.0, 0.05), 1e4)
    b.link((decks[0], decks[1]), BilinearElastic(0.0, 2e7, 0.04), 1e4)
    b.contact(BARRIER, decks[0], b.drawn(0.02, 0.06))
    for k in range(2):
        gap = b.drawn(0.01, 0.04)
        for corner in range(1 + seed % 3):
            b.contact(decks[k], decks[k + 1], gap + 0.005 * corner)
    b.contact(decks[2], BARRIER if east == GROUND else east, b.drawn(0.02, 0.06))
    return b.scene()


def moat(seed: int) -> Scene:
    """A building on pendulums in a moat; its slab and first floor face the walls."""
    b = Built(seed)
    slab = b.body("slab", 4e5)
    first = b.body("first", 3e5)
    b.link((GROUND, slab), Slider.pendulum(b.drawn(0.02, 0.06), 7e6, 2.2), 5e4)
    b.link((slab, first), Linear(b.drawn(8e7, 2e8)), 5e5)
    b.link((GROUND, slab), BilinearElastic(3e7, 0.0, -b.drawn(0.05, 0.15)), 0.0)
    for floor in (slab, first):
        b.contact(BARRIER, floor, b.drawn(0.03, 0.08))
        b.contact(floor, BARRIER, b.drawn(0.03, 0.08))
    return b.scene()


KINDS: Mapping[str, Callable[[int], Scene]] = {
    "buildings": buildings,
    "bridge": bridge,
    "moat": moat,
}
ALL = [
    pytest.param(kind, seed, marks=[] if seed == 0 else [pytest.mark.sweep])
    for kind in KINDS
    for seed in range(10)
]


def needed_by(response: Response) -> list[float]:
    names = [f"contacts.{c.name}.separation_needed" for c in response.scene.contacts]
    return [response.quantity(name) or 0.0 for name in names]


def impacts(scene: Scene) -> list[Event]:
    found = simulate(scene, duration=END).recording.events
    # At rest on a gap of nothing no part strikes another.
    return [event for event in found if event.kind is EventKind.IMPACT]


def built_with(scene: Scene, gaps: list[float]) -> Scene:
    contacts = zip(scene.contacts, gaps, strict=True)
    return replace(scene, contacts=tuple(replace(c, gap=gap) for c, gap in contacts))


@pytest.mark.parametrize(("kind", "seed"), ALL)
def test_a_run_with_it_touches_nothing_and_with_less_it_does(kind, seed):
    scene = KINDS[kind](seed)
    before = simulate(scene, duration=END)
    needed = needed_by(before)
    assert not impacts(built_with(scene, needed))
    for joint in joints_of(scene):
        own = {round(needed[i] - scene.contacts[i].gap, 9) for i in joint}
        assert len(own) == 1
        less = [0.99 * gap if i in joint else gap for i, gap in enumerate(needed)]
        events = impacts(built_with(scene, less))
        # Others follow that first impact. Ends that never come nearer than at rest need no gap.
        assert events[0].contact in joint if events else min(needed[i] for i in joint) == 0.0


def test_of_today_it_does_not_depend_on_equal_gaps():
    found = []
    for gap in (0.01, 0.2):
        scene = buildings(1)
        now = simulate(built_with(scene, [gap] * len(scene.contacts)), duration=END)
        found.append(needed_by(now))
    assert found[0] == pytest.approx(found[1], rel=1e-7)


def test_many_runs_tell_it_of_their_own_gaps():
    scene, gap = buildings(1), np.array([0.0, 0.01, 0.05])
    name = "contacts.c1.separation_needed"
    many = simulate_many(scene, {"contact.c0.gap": gap}, quantities=[name], duration=END)
    for i, own in enumerate(gap):
        gaps = [own, *(c.gap for c in scene.contacts[1:])]
        one = simulate(built_with(scene, gaps), "fast", duration=END)
        assert many.table[name][i] == pytest.approx(one.quantity(name), rel=1e-7)


def joined(*links: tuple[str, str], contacts: list[tuple[str, str]]) -> Sequence[Sequence[int]]:
    names = sorted({n for pair in (*links, *contacts) for n in pair} - {GROUND, BARRIER})
    return joints_of(
        Scene(
            tuple(Body(n, 1.0) for n in names),
            tuple(Spring(f"s{i}", ends, Linear(1.0)) for i, ends in enumerate(links)),
            contacts=tuple(Contact(f"c{i}", a, b, 0.1) for i, (a, b) in enumerate(contacts)),
        )
    )


@pytest.mark.parametrize(
    ("links", "contacts", "joints"),
    [
        # Two buildings, then with a damper between them, then on one podium.
        ([("A1", "A2"), ("B1", "B2")], [("A1", "B1"), ("A2", "B2")], [[0, 1]]),
        ([("A1", "A2"), ("B1", "B2"), ("A2", "B2")], [("A1", "B1"), ("A2", "B2")], [[0, 1]]),
        (
            [("P", "A1"), ("A1", "A2"), ("P", "B1"), ("B1", "B2")],
            [("A1", "B1"), ("A2", "B2")],
            [[0, 1]],
        ),
        # Three in a row.
        (
            [("A1", "A2"), ("B1", "B2"), ("C1", "C2")],
            [("A1", "B1"), ("B1", "C1"), ("A2", "B2"), ("B2", "C2")],
            [[0, 2], [1, 3]],
        ),
        # Decks that share a pier, and the corners of one joint.
        (
            [("D1", "P"), ("P", "D2"), ("D2", "Q"), ("Q", "D3")],
            [("D1", "D2"), ("D1", "D2"), ("D2", "D3")],
            [[0, 1], [2]],
        ),
        # Both sides of a moat; two neighbours at one wall.
        ([("S", "T")], [(BARRIER, "S"), ("S", BARRIER), (BARRIER, "T")], [[0, 2], [1]]),
        ([(GROUND, "S"), (GROUND, "T")], [(BARRIER, "S"), (BARRIER, "T")], [[0], [1]]),
        # A key in its slot.
        ([("P", "D")], [("P", "D"), ("D", "P"), ("P", "D")], [[0, 2], [1]]),
    ],
)
def test_what_is_one_joint(links, contacts, joints):
    assert joined(*links, contacts=contacts) == joints


PRESSED = """
[excitation]
kind = "ricker"
amplitude = "0.2 g"
period = "0.6 s"
center = "1 s"
[[body]]
name = "deck"
mass = "100 t"
[[spring]]
between = ["ground", "deck"]
law = "linear"
stiffness = "10 MN/m"
[[dashpot]]
between = ["ground", "deck"]
coefficient = "100 kN s/m"
[[force]]
body = "deck"
value = "500 kN"
[[contact]]
name = "stop"
between = ["deck", "barrier"]
gap = "{gap}"
restitution = 0.5
[run]
start = "equilibrium"
duration = "4 s"
quantities = ["contacts.stop.separation_needed"]
"""


def test_what_leans_on_its_contact_stands_without_it(tmp_path):
    """The opened run starts in an equilibrium of its own, as a run with that gap does."""
    name, gap = "contacts.stop.separation_needed", 0.01
    (tmp_path / "case.toml").write_text(PRESSED.format(gap="1 cm"))
    case = load_case(tmp_path)
    gap = simulate(case).summary[name]
    # The force alone moves it by 5 cm.
    assert gap > 0.05
    assert design_numbers(case).set_index("quantity").loc[name, "value"] == gap
    for part, struck in ((1.0, False), (0.99, True)):
        (tmp_path / "case.toml").write_text(PRESSED.format(gap=f"{part * gap!r} m"))
        assert bool(simulate(load_case(tmp_path)).recording.events) == struck


def test_gaps_to_be_built_are_rounded_up():
    units, name = Units(), "contacts.joint.separation_needed"
    shown = [units.number(x, "m", name) for x in (0.10401, 0.09996, 0.0123401, 0.0)]
    assert shown == ["105", "100", "12.4", "0"]
    assert units.number(0.10401, "m", "contacts.joint.seat_used") == "104"


def test_a_pulse_and_one_contact_have_the_motion_without_it():
    scene = replace(buildings(1), motion=Ricker(3.0, 0.5))
    (contact, *_) = scene.contacts
    run = simulate(replace(scene, contacts=(contact,)), duration=END)
    own = run.quantity(f"contacts.{contact.name}.avoiding_gap")
    assert needed_by(run) == pytest.approx([own], rel=2e-6)


def test_corners_of_a_joint_open_together():
    """With the gaps that are told nothing touches there, and the other joint strikes as ever."""
    deck = Deck("west", "900 t", "36 m", "11 m", "40 deg")
    springs = [Spring(n, ("ground", f"west.{n}"), Linear("40 MN/m")) for n in ("x", "y", "turn")]

    def response(*gaps):
        joints = (
            Joint("left", ("barrier", "west"), gaps, 0.5),
            Joint("right", ("west", "barrier"), 0.03, 0.5),
        )
        contacts = [c for joint in joints for c in joint.contacts({"west": deck})]
        motion, across = Ricker("0.5 g", "0.8 s"), Ricker("0.3 g", "0.7 s")
        scene = Scene(
            deck.bodies(), springs, contacts=contacts, decks=[deck], motion=motion, across=across
        )
        return simulate(scene, "fast", duration=3.0, error_estimate=False)

    narrow = response(0.02, 0.02)
    needed = [
        narrow.quantity(f"contacts.left.{end}.avoiding_gap_alone") for end in ("lower", "upper")
    ]
    wide = response(*needed)
    for end, gap in zip(("lower", "upper"), needed, strict=True):
        assert gap > 0.02
        assert wide.quantity(f"contacts.left.{end}.smallest_gap") == pytest.approx(
            0.0, abs=1e-8 * gap
        )
    assert wide.quantity("contacts.right.lower.impacts") > 0
    far = [e for e in response(*(1.001 * gap for gap in needed)).recording.events if e.contact < 2]
    assert not far
