"""The figures show the numbers of the tables, with units, and cut nothing off."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from eventpound.report.displacements import displacement_figure
from eventpound.report.loops import loop_figure
from eventpound.report.run_figures import figures, plot
from eventpound.units import STANDARD_GRAVITY


def panel(figure, word):
    return next(axes for axes in figure.axes if word in axes.get_ylabel())


def line(axes, label):
    return next(x for x in axes.get_lines() if x.get_label() == label)


def circles(axes):
    """Numbers of open and filled circles."""
    marked = [x for x in axes.get_lines() if x.get_marker() == "o"]
    opened = sum(len(x.get_xdata()) for x in marked if x.get_markerfacecolor() == "white")
    return opened, sum(len(x.get_xdata()) for x in marked) - opened


def legend_texts(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def assert_nothing_cut_off(figure):
    """Axes with their labels, ticks and legends, and the title, lie within the picture."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    width, height = canvas.get_width_height()
    boxes = [axes.get_tightbbox(canvas.get_renderer()) for axes in figure.axes]
    boxes += [text.get_window_extent() for text in figure.texts]
    for box in boxes:
        # One pixel: circles and texts are rounded to whole ones.
        assert min(box.x0, box.y0) > -1.0
        assert box.x1 < width + 1.0
        assert box.y1 < height + 1.0


def test_displacements_in_centimetres(make_results):
    results = make_results(bodies=2)
    axes = panel(displacement_figure(results), "displacement")
    assert axes.get_ylabel() == "displacement (cm)"
    for name in ("deck0", "deck1"):
        np.testing.assert_allclose(
            line(axes, name).get_ydata(), 100.0 * results.history[f"u.{name}"], rtol=1e-15
        )


@pytest.mark.parametrize(("scale", "unit"), [(100.0, "m"), (1.0, "cm"), (0.01, "mm")])
def test_unit_by_range(make_results, scale, unit):
    figure = displacement_figure(make_results(scale=scale, contacts=False))
    assert panel(figure, "displacement").get_ylabel() == f"displacement ({unit})"


def test_ground_in_g(make_results):
    results = make_results()
    axes = panel(displacement_figure(results), "ground")
    assert axes.get_ylabel().endswith("(g)")
    drawn = max((x for x in axes.get_lines()), key=lambda x: len(x.get_xdata()))
    np.testing.assert_allclose(
        drawn.get_ydata(), results.history["a_g"] / STANDARD_GRAVITY, rtol=1e-15
    )


def test_barrier_stands_where_the_body_touches_it(make_results):
    axes = panel(displacement_figure(make_results()), "displacement")
    dashed = [x for x in axes.get_lines() if x.get_linestyle() == "--"]
    assert [x.get_ydata()[0] for x in dashed] == pytest.approx([2.0])
    assert "barrier" in legend_texts(axes)


def test_circles_count_the_events(make_results):
    figure = displacement_figure(make_results(bodies=2, bounces=7))
    assert circles(panel(figure, "gap")) == (14, 2)
    # A contact of two bodies is marked on both of them.
    assert circles(panel(figure, "displacement")) == (21, 3)
    assert legend_texts(panel(figure, "gap")) == [
        "joint0: deck0 | deck1",
        "joint1: deck1 | barrier",
        "impact",
        "detachment",
        "in contact",
    ]


def test_circles_lie_on_the_displacement(make_results):
    axes = panel(displacement_figure(make_results()), "displacement")
    for drawn in axes.get_lines():
        if drawn.get_marker() == "o":
            # The gap is closed there, so the body is at the barrier, 2 cm; events between
            # two samples lie on the chord, which sags by less than the sample step's motion.
            assert np.abs(drawn.get_ydata() - 2.0).max() < 100 * 0.03 * np.pi * 6 / 9 * 0.02


def test_panels_follow_the_scene(make_results):
    plain = displacement_figure(make_results(contacts=False, ground=0.0))
    assert [axes.get_ylabel() for axes in plain.axes] == ["displacement (cm)"]
    many = displacement_figure(make_results(bodies=6))
    assert [axes.get_ylabel().split()[0] for axes in many.axes] == [
        "ground",
        "displacement",
        "gap",
        "contact",
    ]
    assert circles(panel(many, "gap")) == (0, 0)
    assert circles(panel(many, "contact")) == (36, 6)
    assert many.axes[0].get_xlim() == many.axes[-1].get_xlim() == (0.0, 12.0)


def test_many_bodies_get_a_colour_bar(make_results):
    results = make_results(bodies=30)
    figure = displacement_figure(results)
    assert panel(figure, "displacement").get_legend() is None
    (bar,) = (axes for axes in figure.axes if axes.get_label() == "<colorbar>")
    names = [text.get_text() for text in bar.get_yticklabels()]
    bodies = [body["name"] for body in results.summary["scene"]["bodies"]]
    assert (names[0], names[-1]) == (bodies[0], bodies[-1])
    assert set(names) <= set(bodies)


@pytest.mark.parametrize(
    ("bodies", "bounces"),
    [
        *((1, 300), (3, 3), (8, 300)),
        *(pytest.param(n, 300, marks=pytest.mark.sweep) for n in (2, 3, 4, 30)),
        pytest.param(30, 3, marks=pytest.mark.sweep),
    ],
)
def test_nothing_is_cut_off(make_results, bodies, bounces):
    for figure in figures(make_results(bodies=bodies, bounces=bounces)).values():
        assert_nothing_cut_off(figure)


def test_long_names_are_not_cut_off(make_results):
    results = make_results(bodies=1)
    scene = results.summary["scene"]
    name = "the expansion joint at the west abutment"
    scene["contacts"][0]["name"] = name
    columns = results.history_columns
    columns = columns | {f"gap.{name}": columns["gap.joint0"]}
    assert_nothing_cut_off(displacement_figure(replace(results, history_columns=columns)))


def test_incomplete_run_says_so(make_results):
    results = make_results()
    failed = replace(results, summary=results.summary | {"success": False, "message": "stuck"})
    assert displacement_figure(failed).get_suptitle() == "A row — incomplete: stuck"
    assert displacement_figure(results).get_suptitle() == "A row"


def test_loops(make_results):
    results = make_results(bodies=2)
    first = loop_figure(results).axes[0]
    assert (first.get_xlabel(), first.get_ylabel()) == ("elongation (cm)", "force (kN)")
    assert first.get_title() == "frame0 (bouc-wen)"
    drawn = max(first.get_lines(), key=lambda x: len(x.get_xdata()))
    np.testing.assert_allclose(drawn.get_xdata(), 100 * results.history["u.deck0"], rtol=1e-15)
    np.testing.assert_allclose(
        drawn.get_ydata(), results.history["force.frame0"] / 1000, rtol=1e-15
    )


def test_elongation_between_bodies(make_results):
    results = make_results(bodies=2)
    results.summary["scene"]["springs"][0]["between"] = ["deck0", "deck1"]
    drawn = max(loop_figure(results).axes[0].get_lines(), key=lambda x: len(x.get_xdata()))
    history = results.history
    np.testing.assert_allclose(
        drawn.get_xdata(), 100 * (history["u.deck1"] - history["u.deck0"]), rtol=1e-14, atol=1e-15
    )


def test_no_loops_of_linear_springs(make_results):
    assert list(figures(make_results(hysteretic=False))) == ["displacements.png"]


def test_run_that_failed_at_once(make_results):
    results = make_results(bodies=2)
    at_start = replace(
        results,
        history_columns={name: values[:1] for name, values in results.history_columns.items()},
        event_columns={name: [] for name in results.event_columns},
    )
    for figure in figures(at_start).values():
        assert_nothing_cut_off(figure)


def test_files_are_pictures(make_results, tmp_path):
    paths = plot(make_results(), tmp_path)
    assert [path.name for path in paths] == ["displacements.png", "loops.png"]
    assert sorted(tmp_path.iterdir()) == paths
    for path in paths:
        assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_nothing_heavy_is_imported_before_drawing_and_pyplot_never():
    code = "import sys, eventpound.report; print({'matplotlib', 'pandas'} & set(sys.modules));"
    code += "import eventpound.report.run_figures; print('matplotlib.pyplot' in sys.modules)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["set()", "False"]
