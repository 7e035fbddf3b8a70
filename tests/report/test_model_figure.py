"""The picture of a scene: who stands where, and that nothing is left out."""

from __future__ import annotations

from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex

from eventpound import modal_damping
from eventpound.case import load_case
from eventpound.cli import main
from eventpound.report.law_panel import laws_shown
from eventpound.report.model_figure import _CALLED, _LAWS, model_figure
from eventpound.report.model_layout import HIGH, LEVEL, Layout, layout_of
from eventpound.report.model_links import LinkPath, crosses, links_drawn
from eventpound.report.style import PALETTE
from eventpound.scene import (
    BARRIER,
    GROUND,
    Backfill,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Point,
    Scene,
    Series,
    Slider,
    Spring,
)
from eventpound.scene.spring import LawName
from tests.models import CASES


def storeys(name: str, count: int) -> list[Spring]:
    ends = [GROUND, *(f"{name}{i}" for i in range(1, count + 1))]
    return [Spring(f"s{b}", (a, b), Linear(1.0)) for a, b in pairwise(ends)]


def places(scene: Scene) -> dict[str, tuple[float, float]]:
    """Centres of bodies."""
    return {name: (box.x, box.y) for name, box in layout_of(scene).boxes.items()}


def test_buildings_stand_floor_over_floor_in_the_order_of_contacts() -> None:
    scene = Scene(
        tuple(Body(name, 1.0) for name in ("B1", "B2", "A1", "A2", "A3")),
        (*storeys("A", 3), *storeys("B", 2)),
        contacts=(Contact("top", "A2", "B2", 0.1, 0.5),),
    )
    place = places(scene)
    assert place["A1"][0] == place["A2"][0] == place["A3"][0] < place["B1"][0] == place["B2"][0]
    assert place["A1"][1] == place["B1"][1] < place["A2"][1] == place["B2"][1] < place["A3"][1]


def test_floors_stand_at_the_heights_of_their_storeys() -> None:
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


def test_decks_stand_in_a_row() -> None:
    scene = Scene(
        tuple(Body(name, 1.0) for name in "cab"),
        (
            *(Spring(name, (GROUND, name), Linear(1.0)) for name in "abc"),
            Spring("link", ("a", "b"), Linear(1.0)),
        ),
        contacts=(Contact("bc", "b", "c", 0.1, 0.5), Contact("ab", "a", "b", 0.1, 0.5)),
    )
    place = places(scene)
    assert place["a"][0] < place["b"][0] < place["c"][0]
    assert {y for _, y in place.values()} == {place["a"][1]}


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


def assert_nothing_is_in_the_way(layout: Layout, routes: list[LinkPath]) -> None:
    boxes = layout.boxes
    for (name, one), (other, two) in combinations(boxes.items(), 2):
        apart = max(one.left - two.right, two.left - one.right, abs(one.y - two.y) - HIGH)
        assert apart > 0.0, (name, other)
    for route in routes:
        for start, end in pairwise(route.corners):
            for name, box in boxes.items():
                assert not crosses(box, start, end), (route.link, name)


BRIDGES = [
    decks_on_piers(3),
    decks_on_piers(2),
    decks_on_piers(1, inside=2),
    decks_on_piers(3, inside=3),
    decks_on_piers(4, abutments=False),
    decks_on_piers(3, touch=False, abutments=False),
]


@pytest.mark.parametrize("scene", BRIDGES)
def test_decks_stand_on_their_piers_between_the_abutments(scene: Scene) -> None:
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


def test_two_piers_at_one_joint_stand_beside_each_other() -> None:
    scene = decks_on_piers(3, caps=2, inside=1)
    layout = layout_of(scene)
    assert_nothing_is_in_the_way(layout, links_drawn(scene, layout))


def test_a_spring_goes_round_what_is_between_its_ends() -> None:
    names = "abc"
    scene = Scene(
        tuple(Body(name, 1.0) for name in names),
        (
            *(Spring(name, (GROUND, name), Linear(1.0)) for name in names),
            Spring("tie", ("a", "c"), Linear(1.0)),
        ),
        contacts=(Contact("ab", "a", "b", 0.1, 0.5), Contact("bc", "b", "c", 0.1, 0.5)),
    )
    layout = layout_of(scene)
    routes = links_drawn(scene, layout)
    assert_nothing_is_in_the_way(layout, routes)
    assert len(routes[-1].corners) == 4


def test_bodies_of_any_scene_stand_apart() -> None:
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


def test_floor_and_column_that_meet_are_drawn_at_one_height() -> None:
    high = [Spring(s.name, s.between, s.law, 3.6) for s in storeys("A", 3)]
    low = [Spring(s.name, s.between, s.law, 3.0) for s in storeys("B", 4)]
    column = Point((("A2", 1.8 / 3.6), ("A3", 1.8 / 3.6)))
    scene = Scene(
        tuple(Body(s.between[1], 1.0) for s in (*high, *low)),
        (*high, *low),
        contacts=(Contact("B3 on column", column, "B3", 0.1, 0.5),),
    )
    (axes,) = model_figure(scene).axes
    joint = [line for line in axes.lines if to_hex(line.get_color()) == to_hex(PALETTE[2])]
    heights = {float(np.mean(line.get_ydata())) for line in joint}
    assert max(heights) == pytest.approx(min(heights))


def everything() -> Scene:
    stop = BilinearElastic(1.0, 2.0)
    return Scene(
        (Body("deck $1", 2e3), Body("deck2", 1.0)),
        (
            Spring("pier", (GROUND, "deck $1"), BoucWen(1.0, 1.0, 1.0)),
            Spring("bearing", ("deck $1", "deck2"), Linear(1.0)),
            Spring("abutment", ("deck2", GROUND), Series((Linear(1.0), stop))),
            Spring("soil", (GROUND, "deck $1"), Backfill(1.0, 1.0, 0.7)),
            Spring("slides", (GROUND, "deck2"), Slider(0.1, 1.0)),
        ),
        (Dashpot((GROUND, "deck $1"), 1.0), Dashpot(("deck2", "deck $1"), 1.0)),
        (
            Contact("joint", "deck $1", "deck2", 0.0127, 0.7),
            Contact("wall", BARRIER, "deck $1", 0.1, 1),
        ),
    )


def test_bodies_that_can_touch_stand_side_by_side() -> None:
    place = places(everything())
    assert place["deck $1"][1] == place["deck2"][1]
    assert place["deck $1"][0] < place["deck2"][0]


def test_everything_is_drawn_once_and_named() -> None:
    figure = model_figure(everything(), "A bridge")
    (axes,) = figure.axes
    texts = "|".join(text.get_text() for text in axes.texts)
    for said in ("deck \\$1\n2 t", "deck2\n1 kg", "pier", "bearing", "abutment", "joint\n12.7 mm"):
        assert texts.count(said) == 1, said
    assert texts.count("soil") == texts.count("slides") == 1
    # A spring is a line of many corners, in the colour of its law; a slider has two level plates.
    springs = [line for line in axes.lines if len(line.get_xdata()) > 10]
    own = {name: to_hex(color) for name, color in _LAWS.items()}
    sliding = own.pop("slider")
    assert sorted(to_hex(line.get_color()) for line in springs) == sorted(own.values())
    slides = [line for line in axes.lines if to_hex(line.get_color()) == sliding]
    assert sum(np.ptp(line.get_ydata()) == 0.0 < np.ptp(line.get_xdata()) for line in slides) == 2
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [*_LAWS]
    assert len(axes.patches) == 2


@pytest.mark.parametrize("name", ["bridge-el-centro", "adjacent-buildings", "row-of-eight"])
def test_bodies_do_not_overlap_and_stand_within_the_picture(name: str) -> None:
    figure = model_figure(load_case(CASES / name).scene)
    (axes,) = figure.axes
    figure.canvas.draw()
    boxes = np.array([patch.get_window_extent().extents for patch in axes.patches])
    for i, one in enumerate(boxes):
        for other in boxes[i + 1 :]:
            apart = one[2] < other[0] or other[2] < one[0] or one[3] < other[1] or other[3] < one[1]
            assert apart
    assert (boxes[:, :2] > 0.0).all()
    assert (boxes[:, 2] < figure.bbox.width).all()


def test_soil_stands_beside_its_body_at_a_wall() -> None:
    scene = everything()
    layout = layout_of(scene)
    (route,) = (r for r in links_drawn(scene, layout) if r.label == "soil")
    assert not route.upright
    assert [x < layout.boxes["deck $1"].left for x, _ in route.corners] == [True, False]


def test_laws_that_differ_are_drawn_below_the_scene() -> None:
    scene = load_case(CASES / "bridge-pulse").scene
    axes = model_figure(scene, with_laws=True).axes[1:]
    assert [a.get_title() for a in axes] == [
        "frame1", "frame2", "joint-bearing", "left-abutment, right-abutment",
    ]  # fmt: skip
    for panel, spring in zip(axes[:2], scene.springs, strict=False):
        law = spring.law
        assert isinstance(law, BoucWen)
        (loop,) = [line for line in panel.lines if len(line.get_xdata()) > 100]
        x, force = np.asarray(loop.get_xdata()), np.asarray(loop.get_ydata())
        end = 3.0 * law.yield_displacement
        assert (x.min(), x.max()) == pytest.approx((-end, end))
        # At both ends it has yielded: F = k x +- Q; the knee is over to exp(-20).
        limit = law.stiffness * end + law.strength
        assert (force.min(), force.max()) == pytest.approx((-limit, limit), rel=1e-6)
    said = axes[3].get_xlabel()
    # 150 MN/m in series with 455.328 and 1.751 MN/m.
    assert "compression 112.8 MN/m" in said
    assert "extension 1.731 MN/m" in said


def test_the_slack_of_a_cable_is_told_and_seen() -> None:
    scene = Scene(
        (Body("deck", 1e6),),
        (
            Spring("piers", (GROUND, "deck"), Linear(4e7)),
            Spring("cable", (GROUND, "deck"), BilinearElastic(0.0, 6e7, 0.02)),
        ),
    )
    axes = model_figure(scene, with_laws=True).axes[2]
    assert axes.get_xlabel().splitlines()[-1] == "offset 2 cm"
    x = np.asarray(axes.lines[-1].get_xdata())
    # The kink lies well within the picture, away from zero.
    assert 0.2 < 0.02 / (x.max() - x.min()) < 0.5


def test_laws_of_many_springs_are_one_of_each_kind() -> None:
    springs = [Spring(f"s{i}", (GROUND, f"b{i}"), BoucWen(1.0, 1.0 + i, 1.0)) for i in range(5)]
    springs += [Spring("l", (GROUND, "b0"), Linear(1.0)), Spring("m", (GROUND, "b1"), Linear(1.0))]
    assert [name for name, _ in laws_shown(springs)] == ["s0, one of 5 such laws", "l, m"]
    assert laws_shown(springs[-2:]) == []


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("bridge-pulse", "figure-07"):
        assert main(["plot", "--model", str(CASES / name), "--out", str(tmp_path / name)]) == 0
        assert capsys.readouterr().out.strip() == str(tmp_path / name / "model.png")
        assert (tmp_path / name / "model.png").stat().st_size > 5000


def test_dashpots_of_modal_damping_are_drawn_beside_springs_alone() -> None:
    springs = storeys("A", 4)
    bodies = tuple(Body(spring.between[1], 1.0) for spring in springs)
    scene = Scene(bodies, tuple(springs), modal_damping(bodies, springs, 0.05))
    drawn = [r.link.between for r in links_drawn(scene, layout_of(scene)) if r.link not in springs]
    assert sorted(drawn) == sorted(spring.between for spring in springs)
    # A damper across two storeys is no modal damping.
    damper = Dashpot(("A1", "A3"), 1.0)
    routes = links_drawn(Scene(bodies, tuple(springs), (damper,)), layout_of(scene))
    assert damper in [route.link for route in routes]


def test_corners_of_one_joint_are_named_one_above_the_other() -> None:
    joint = [
        Contact(name, "A1", "B1", gap, 0.5) for name, gap in (("acute", 0.03), ("obtuse", 0.05))
    ]
    bodies, springs = (Body("A1", 1e5), Body("B1", 1e5)), (*storeys("A", 1), *storeys("B", 1))
    axes = model_figure(Scene(bodies, springs, contacts=tuple(joint))).axes[0]
    (said,) = [text.get_text() for text in axes.texts if "acute" in text.get_text()]
    assert said.split("\n")[::2] == ["acute", "obtuse"]


def test_every_law_has_its_look() -> None:
    assert {_CALLED.get(word, word) for word in LawName} <= set(_LAWS)
