"""Where bodies and structures stand in the drawing of a model."""

import numpy as np
import pytest

from eventpound.report.model_layout import HIGH, LEVEL, layout_of
from eventpound.report.model_links import links_drawn
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from tests.report.test_model_figure import assert_nothing_is_in_the_way, places, storeys


def test_floors_stand_at_the_heights_of_their_storeys():
    high = [Spring(s.name, s.between, s.law, 3.6) for s in storeys("A", 3)]
    low = [Spring(s.name, s.between, s.law, 3.0) for s in storeys("B", 4)]
    scene = Scene(tuple(Body(s.between[1], 1.0) for s in (*high, *low)), (*high, *low))
    heights = {name: y for name, (_, y) in places(scene).items()}
    for name, y in heights.items():
        true = int(name[1]) * (3.6 if name[0] == "A" else 3.0)
        assert y / heights["A1"] == pytest.approx(true / 3.6)
    # The lowest storey leaves room for a spring, whatever the others are.
    flat = Scene(scene.bodies, (*high, *(Spring(s.name, s.between, s.law, 0.5) for s in low)))
    boxes = layout_of(flat).boxes
    assert boxes["B2"].bottom - boxes["B1"].top > 0.5 * HIGH


def decks_on_piers(
    decks: int, *, caps: int = 1, inside: int = 0, touch: bool = True, abutments: bool = True
) -> Scene:
    """Decks on bearings: caps at each joint, piers within each deck, bearings at the ends."""
    bodies = [f"deck{i}" for i in range(decks)]
    carriers = {f"cap{i}{k}": (i, i + 1) for i in range(decks - 1) for k in range(caps)}
    carriers |= {f"pier{i}{k}": (i,) for i in range(decks) for k in range(inside)}
    # Columns before bearings, and carriers after decks: as a case may have them.
    springs = [Spring(f"column {name}", (GROUND, name), Linear(1.0)) for name in carriers]
    springs += [
        Spring(f"bearing {name}-{i}", (name, f"deck{i}"), BoucWen(1.0, 1.0, 1.0))
        for name, on in carriers.items()
        for i in on
    ]
    contacts = [Contact(f"joint{i}", *bodies[i : i + 2], 0.1, 0.5) for i in range(decks - 1)]
    ends = [("left", GROUND, bodies[0]), ("right", bodies[-1], GROUND)]
    if abutments:
        springs += [Spring(name, (a, b), BoucWen(1.0, 1.0, 1.0)) for name, a, b in ends]
    walls = [(name, *(BARRIER if x == GROUND else x for x in two)) for name, *two in ends]
    contacts += [Contact(name, a, b, 0.1, 0.5) for name, a, b in walls]
    return Scene(
        tuple(Body(name, 1.0) for name in [*bodies, *carriers]),
        tuple(springs),
        tuple(Dashpot((GROUND, name), 1.0) for name in carriers),
        tuple(contacts) if touch else (),
    )


BRIDGES = [
    decks_on_piers(3),
    decks_on_piers(2),
    decks_on_piers(1, inside=2),
    decks_on_piers(3, inside=3),
    decks_on_piers(4, abutments=False),
    decks_on_piers(3, touch=False, abutments=False),
]


@pytest.mark.parametrize("scene", BRIDGES)
def test_decks_stand_on_their_piers_between_the_abutments(scene):
    layout = layout_of(scene)
    routes = links_drawn(scene, layout)
    assert_nothing_is_in_the_way(layout, routes)
    assert len(routes) == len(scene.springs) + len(scene.dashpots)
    decks = [box for name, box in layout.boxes.items() if name.startswith("deck")]
    assert [deck.x for deck in decks] == sorted(deck.x for deck in decks)
    for name, box in layout.boxes.items():
        assert box.y == LEVEL * (2 if name.startswith("deck") else 1)
        assert decks[0].left <= box.left < box.right <= decks[-1].right
    for route in routes:
        # Columns and bearings are upright, and a bearing stands below its deck.
        assert route.upright, route.link
        for end in set(route.link.between) - {GROUND}:
            assert layout.boxes[end].left < route.corners[-1][0] < layout.boxes[end].right


def test_two_piers_at_one_joint_stand_beside_each_other():
    scene = decks_on_piers(3, caps=2, inside=1)
    layout = layout_of(scene)
    assert_nothing_is_in_the_way(layout, links_drawn(scene, layout))


def test_bodies_of_any_scene_stand_apart():
    rng = np.random.default_rng(5)
    for _ in range(300):
        names = [f"b{i}" for i in range(rng.integers(1, 9))]
        ends = [GROUND, *names]
        pairs = {tuple(rng.choice(len(ends), 2, replace=False)) for _ in range(rng.integers(0, 14))}
        springs = [Spring(f"s{i}-{j}", (ends[i], ends[j]), Linear(1.0)) for i, j in pairs]
        meet = [tuple(rng.choice(len(ends), 2, replace=False)) for _ in range(rng.integers(0, 5))]
        walls = [BARRIER, *names]
        contacts = [Contact(f"c{k}", walls[i], walls[j], 0.1, 0.5) for k, (i, j) in enumerate(meet)]
        bodies = tuple(Body(name, 1.0) for name in names)
        scene = Scene(bodies, tuple(springs), (), tuple(contacts))
        layout = layout_of(scene)
        assert layout.boxes.keys() == set(names)
        assert_nothing_is_in_the_way(layout, [])
        assert len(links_drawn(scene, layout)) == len(springs)
