"""The picture of a scene: who stands where, and that nothing is left out."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex

from eventpound.case import load_case
from eventpound.cli import main
from eventpound.report.model_figure import _LAWS, layout_of, model_figure
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Series,
    Spring,
)

CASES = Path(__file__).parents[2] / "cases"


def storeys(name: str, count: int) -> list[Spring]:
    ends = [GROUND, *(f"{name}{i}" for i in range(1, count + 1))]
    return [Spring(f"s{b}", (a, b), Linear(1.0)) for a, b in pairwise(ends)]


def test_buildings_stand_floor_over_floor_in_the_order_of_contacts() -> None:
    scene = Scene(
        tuple(Body(name, 1.0) for name in ("B1", "B2", "A1", "A2", "A3")),
        (*storeys("A", 3), *storeys("B", 2)),
        contacts=(Contact("top", "A2", "B2", 0.1, 0.5),),
    )
    place = layout_of(scene).place
    assert place["A1"][0] == place["A2"][0] == place["A3"][0] < place["B1"][0] == place["B2"][0]
    assert place["A1"][1] == place["B1"][1] < place["A2"][1] == place["B2"][1] < place["A3"][1]


def test_decks_stand_in_a_row() -> None:
    scene = Scene(
        tuple(Body(name, 1.0) for name in "cab"),
        (
            *(Spring(name, (GROUND, name), Linear(1.0)) for name in "abc"),
            Spring("link", ("a", "b"), Linear(1.0)),
        ),
        contacts=(Contact("bc", "b", "c", 0.1, 0.5), Contact("ab", "a", "b", 0.1, 0.5)),
    )
    place = layout_of(scene).place
    assert place["a"][0] < place["b"][0] < place["c"][0]
    assert {y for _, y in place.values()} == {place["a"][1]}


def test_contacts_in_a_ring_end() -> None:
    scene = Scene(
        (Body("a", 1.0), Body("b", 1.0)),
        contacts=(Contact("ab", "a", "b", 1.0, 0.5), Contact("ba", "b", "a", 1.0, 0.5)),
    )
    assert len(layout_of(scene).place) == 2


def everything() -> Scene:
    stop = BilinearElastic(1.0, 2.0)
    return Scene(
        (Body("deck $1", 2e3), Body("deck2", 1.0)),
        (
            Spring("pier", (GROUND, "deck $1"), BoucWen(1.0, 1.0, 1.0)),
            Spring("bearing", ("deck $1", "deck2"), Linear(1.0)),
            Spring("abutment", ("deck2", GROUND), Series((Linear(1.0), stop))),
        ),
        (Dashpot((GROUND, "deck $1"), 1.0), Dashpot(("deck2", "deck $1"), 1.0)),
        (
            Contact("joint", "deck $1", "deck2", 0.0127, 0.7),
            Contact("wall", BARRIER, "deck $1", 0.1, 1),
        ),
    )


def test_everything_is_drawn_once_and_named() -> None:
    figure = model_figure(everything(), "A bridge")
    (axes,) = figure.axes
    texts = "|".join(text.get_text() for text in axes.texts)
    for said in ("deck \\$1\n2 t", "deck2\n1 kg", "pier", "bearing", "abutment", "joint\n1.27 cm"):
        assert texts.count(said) == 1, said
    # A spring is a line of many corners, in the colour of its law.
    springs = [line for line in axes.lines if len(line.get_xdata()) > 10]
    assert sorted(to_hex(line.get_color()) for line in springs) == sorted(
        to_hex(color) for _, color in _LAWS
    )
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


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("bridge-pulse", "figure-07"):
        assert main(["plot", "--model", str(CASES / name), "--out", str(tmp_path / name)]) == 0
        assert capsys.readouterr().out.strip() == str(tmp_path / name / "model.png")
        assert (tmp_path / name / "model.png").stat().st_size > 5000
