"""Figures for papers: kinds of files, widths, windows, names, texts that stay within."""

import itertools
import re

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from eventpound import InputError, load_case, plot, simulate
from eventpound.case import write_template
from eventpound.cli import main
from eventpound.report.displacements import displacement_figure, shades_of
from eventpound.report.notes import wrapped
from eventpound.report.style import Paper, on_paper, plain_logarithms
from eventpound.report.view import View
from eventpound.results import gather


@pytest.fixture(scope="module")
def buildings(tmp_path_factory):
    case = load_case(write_template(tmp_path_factory.mktemp("b") / "case", "buildings"))
    return gather(simulate(case, rtol=1e-6), case)


def test_bodies_have_their_names_and_structures_a_colour(buildings):
    axes = displacement_figure(buildings).axes[1]
    names = [f"A{i}" for i in range(1, 6)] + [f"B{i}" for i in range(1, 5)]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == names
    assert View(buildings).structures == [names[:5], names[5:]]
    shades = shades_of(View(buildings))
    assert len(set(shades.values())) == len(names)
    # Blue beside red: which of them a colour has more of.
    bluer = [shades[name][2] > shades[name][0] for name in names]
    assert bluer == [True] * 5 + [False] * 4


def test_kinds_width_and_resolution(tmp_path, make_results):
    written = plot(make_results(), tmp_path, Paper(("pdf", "svg", "png"), 90.0, 200))
    assert {path.suffix for path in written} == {".pdf", ".svg", ".png"}
    assert (tmp_path / "loops.pdf").read_bytes().startswith(b"%PDF")
    width = re.search(r'<svg [^>]*width="([0-9.]+)pt"', (tmp_path / "loops.svg").read_text())
    assert float(width[1]) == pytest.approx(90.0 / 25.4 * 72.0, abs=0.1)
    assert imread(tmp_path / "displacements.png").shape[1] == int(90.0 / 25.4 * 200.0)


def test_files_of_one_figure_are_the_same(make_results):
    drawn = ({"a.png": displacement_figure(make_results())} for _ in range(2))
    one, two = (on_paper(figure, Paper(("svg", "pdf"))) for figure in drawn)
    assert one == two


def test_a_window_of_time(tmp_path, make_results):
    results = make_results()
    assert plot(results, tmp_path, xlim=(0.3, 1.5))
    with pytest.raises(InputError, match="in which there are no rows to draw"):
        plot(results, tmp_path, xlim=(90.0, 91.0))


@pytest.mark.parametrize("ends", [(0.1, 3.0), (0.02, 1.0), (1.0, 9.0), (0.05, 10.0)])
def test_numbers_of_a_logarithmic_axis_do_not_print_over_each_other(ends):
    figure = Figure(figsize=(3.5, 2.4), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(ends, (0.0, 1.0))
    plain_logarithms(axes, y=False)
    axes.set_xlim(*ends)
    figure.canvas.draw()
    ticks = [*axes.get_xticklabels(), *axes.get_xticklabels(minor=True)]
    shown = [t for t in ticks if t.get_text() and ends[0] <= t.get_position()[0] <= ends[1]]
    boxes = sorted((t.get_window_extent().extents for t in shown), key=lambda box: box[0])
    assert len(boxes) >= 3
    assert all(one[2] < two[0] for one, two in itertools.pairwise(boxes))


def test_texts_are_broken_between_words_and_formulas_stay_whole():
    text = "Elastic structure beside a barrier: $a_g = 3.9$ m/s², rtol 1e-9, end at $t = 6\\,T_g$"
    lines = wrapped(text, 30)
    assert " ".join(lines) == text
    assert len(lines) > 2
    assert all(line.count("$") % 2 == 0 for line in lines)
    assert wrapped("short", 30) == ["short"]


def test_a_long_title_stays_within_the_figure(tmp_path):
    case = """title = "%s"
[excitation]
kind = "ricker"
[pi]
structure = "elastic"
delta = 0.2
epsilon = 0.6
periods = 2
[study]
quantities = ["pi_um"]
[[study.axis]]
key = "pi.omega_s"
from = 0.2
to = 3
count = 5
[[figure]]
y = "pi_um"
note = "%s"
"""
    (tmp_path / "case.toml").write_text(case % ("many words " * 12, "a note of many words " * 8))
    assert main(["study", str(tmp_path)]) == 0
    picture = imread(tmp_path / "results" / "study.png")[:, :, :3]
    # No ink at the edges, where a text that is cut would leave some.
    edges = np.concatenate([picture[:, :3].reshape(-1, 3), picture[:, -3:].reshape(-1, 3)])
    assert (edges > 0.9).all()
