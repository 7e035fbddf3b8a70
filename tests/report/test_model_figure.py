"""The picture of a scene: who stands where, and that nothing is left out."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from matplotlib.colors import to_hex

from eventpound.case import load_case
from eventpound.cli import main
from eventpound.report.model_figure import _CALLED, _LAWS, model_figure
from eventpound.report.model_layout import HIGH, Layout, layout_of
from eventpound.report.model_links import LinkPath, crosses
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


def test_buildings_stand_floor_over_floor_in_the_order_of_contacts():
    scene = Scene(
        tuple(Body(name, 1.0) for name in ("B1", "B2", "A1", "A2", "A3")),
        (*storeys("A", 3), *storeys("B", 2)),
        contacts=(Contact("top", "A2", "B2", 0.1, 0.5),),
    )
    place = places(scene)
    assert place["A1"][0] == place["A2"][0] == place["A3"][0] < place["B1"][0] == place["B2"][0]
    assert place["A1"][1] == place["B1"][1] < place["A2"][1] == place["B2"][1] < place["A3"][1]


def test_decks_stand_in_a_row():
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


def assert_nothing_is_in_the_way(layout: Layout, routes: list[LinkPath]) -> None:
    boxes = layout.boxes
    for (name, one), (other, two) in combinations(boxes.items(), 2):
        apart = max(one.left - two.right, two.left - one.right, abs(one.y - two.y) - HIGH)
        assert apart > 0.0, (name, other)
    for route in routes:
        for start, end in pairwise(route.corners):
            for name, box in boxes.items():
                assert not crosses(box, start, end), (route.link, name)


def test_floor_and_column_that_meet_are_drawn_at_one_height():
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


def test_bodies_that_can_touch_stand_side_by_side():
    place = places(everything())
    assert place["deck $1"][1] == place["deck2"][1]
    assert place["deck $1"][0] < place["deck2"][0]


def test_everything_is_drawn_once_and_named():
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
def test_bodies_do_not_overlap_and_stand_within_the_picture(name):
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


def test_laws_that_differ_are_drawn_below_the_scene():
    scene = load_case(CASES / "bridge-pulse").scene
    axes = model_figure(scene, with_laws=True).axes[1:]
    assert [a.get_title() for a in axes] == [
        "frame1", "frame2", "joint-bearing", "left-abutment, right-abutment",
    ]  # fmt: skip
    for panel, spring in zip(axes[:2], scene.springs, strict=False):
        law = spring.law
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


def test_the_slack_of_a_cable_is_told_and_seen():
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


def test_command(tmp_path, capsys):
    for name in ("bridge-pulse", "figure-07"):
        assert main(["plot", "--model", str(CASES / name), "--out", str(tmp_path / name)]) == 0
        assert capsys.readouterr().out.strip() == str(tmp_path / name / "model.png")
        assert (tmp_path / name / "model.png").stat().st_size > 5000


def test_corners_of_one_joint_are_named_one_above_the_other():
    joint = [
        Contact(name, "A1", "B1", gap, 0.5) for name, gap in (("acute", 0.03), ("obtuse", 0.05))
    ]
    bodies, springs = (Body("A1", 1e5), Body("B1", 1e5)), (*storeys("A", 1), *storeys("B", 1))
    axes = model_figure(Scene(bodies, springs, contacts=tuple(joint))).axes[0]
    (said,) = [text.get_text() for text in axes.texts if "acute" in text.get_text()]
    assert said.split("\n")[::2] == ["acute", "obtuse"]


def test_every_law_has_its_look():
    assert {_CALLED.get(word, word) for word in LawName} <= set(_LAWS)
