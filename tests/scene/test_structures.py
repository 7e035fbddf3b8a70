"""What swings together: structures, springs with what hangs on them, isolators."""

import pytest

from eventpound.scene import GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.scene.structures import isolated, mass_on, structure_names, structures_of
from tests.scene.test_modes import FLOORS, ISOLATORS, building, isolated_building


def test_structures_are_what_springs_and_dashpots_join():
    scene = Scene(
        tuple(Body(name, 1.0) for name in "abcd"),
        (Spring("s", ("a", "c"), Linear(1.0)),),
        (Dashpot(("d", "b"), 1.0),),
        (Contact("touch", "a", "b", 1.0, 0.5),),
    )
    assert structures_of(scene) == [["a", "c"], ["b", "d"]]


def test_structures_are_called_as_a_body_says_or_as_the_first():
    def names(*said: str, springs: str = "") -> list[str]:
        bodies = tuple(Body(n, 1.0, structure=s) for n, s in zip("abcd", said, strict=True))
        pairs = zip(springs[::2], springs[1::2], strict=True)
        return structure_names(
            Scene(bodies, tuple(Spring(x + y, (x, y), Linear(1.0)) for x, y in pairs))
        )

    assert names("", "T", "", "U", springs="abcd") == ["T", "U"]
    assert names("", "", "", "", springs="abcd") == ["a", "c"]
    # What two would be called, neither is.
    assert names("T", "", "T", "", springs="abcd") == ["a", "c"]
    assert names("", "d", "", "", springs="abc" + "c") == ["a", "c", "d"]


def test_what_swings_on_a_spring():
    scene, mass, *_ = building()
    for i, spring in enumerate(scene.springs):
        assert mass_on(scene, spring) == pytest.approx(mass[i:].sum(), rel=1e-14)
    bridge = Scene(
        (Body("deck1", 3.0), Body("deck2", 5.0)),
        (
            Spring("pier1", (GROUND, "deck1"), Linear(1.0)),
            Spring("pier2", ("deck2", GROUND), Linear(1.0)),
            Spring("bearing", ("deck1", "deck2"), Linear(1.0)),
        ),
    )
    # Each deck is held by the other's pier too: its own mass; between them none.
    assert [mass_on(bridge, spring) for spring in bridge.springs] == [3.0, 5.0, None]


def test_what_stands_on_isolators():
    scene = isolated_building()
    assert isolated(scene) == set(FLOORS)
    # Storeys that yield, but later; in two bearings beside each other on a footing.
    strong = BoucWen(1e7, 3e6, 0.01)
    bodies = (*scene.bodies, Body("footing", 1e5))
    springs = (
        Spring("soil", (GROUND, "footing"), Linear(1e9)),
        *(Spring(f"bearing{i}", ("footing", "base"), ISOLATORS) for i in (1, 2)),
        *(Spring(s.name, s.between, strong) for s in scene.springs[1:]),
    )
    assert isolated(Scene(bodies, springs)) == set(FLOORS)
    # A frame all of whose storeys yield, the upper ones earlier: nothing above the first floor.
    ends = (GROUND, *FLOORS)
    laws = [BoucWen(1e7, q, 0.01) for q in (4e6, 3e6, 2e6, 1e6)]
    frame = tuple(Spring(f"s{i}", ends[i : i + 2], law) for i, law in enumerate(laws))
    assert isolated(Scene(scene.bodies, frame)) == {"base"}
    # Held beside the isolators by an elastic spring elsewhere.
    held = (*scene.springs, Spring("tie", (GROUND, "f1"), Linear(1e6)))
    assert isolated(Scene(scene.bodies, held)) == set()
