"""The work-precision diagram shows the numbers of the tables, and the floor."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from eventpound import load_case
from eventpound.accuracy.compare import entries, judge_entries
from eventpound.accuracy.comparison_tables import run_table
from eventpound.accuracy.reference import CertifiedBounds
from eventpound.report.work_precision import graph_measure, peak_measure, work_precision_figure
from tests.models import CASES


@pytest.fixture(scope="module")
def comparison():
    asked = entries([("fast", {}), ("cvode", {"method": "BDF"})], [1e-4, 1e-6, 1e-8], [])
    return judge_entries(load_case(CASES / "elastic-barrier"), asked, repeats=1)


def test_points_are_those_of_the_table(comparison):
    table = run_table(comparison)
    peaks, graph = work_precision_figure(comparison).axes
    for axes, column in ((peaks, "peak_error"), (graph, "graph_distance")):
        lines = [line for line in axes.get_lines() if len(line.get_xdata()) == 3]
        assert len(lines) == 2
        for line, (_, rows) in zip(lines, table.groupby("solver", sort=False), strict=True):
            np.testing.assert_allclose(line.get_xdata(), 1e3 * rows["seconds"])
            np.testing.assert_allclose(line.get_ydata(), rows[column])
        assert axes.get_xscale() == axes.get_yscale() == "log"
        assert axes.get_xlabel() == "wall time (ms)"


def test_the_floor_is_that_of_the_reference(comparison):
    figure = work_precision_figure(comparison)
    for axes, measure in zip(figure.axes, (peak_measure, graph_measure), strict=True):
        floor = measure(comparison).floor
        # Two runs at rtol 1e-13; errors of some hundred steps.
        assert 0.0 < floor < 1e-10
        assert f"reference known to {floor:.0e}" in [text.get_text() for text in axes.texts]
        (band,) = axes.patches
        assert band.get_y() + band.get_height() == pytest.approx(floor)
        low, high = axes.get_ylim()
        assert low < floor < high


def test_ends_are_named_and_nothing_is_cut_off(comparison):
    figure = work_precision_figure(comparison)
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert texts.count("1e-4") == texts.count("1e-8") == 2
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    width, height = canvas.get_width_height()
    for axes in figure.axes:
        box = axes.get_tightbbox(canvas.get_renderer())
        assert min(box.x0, box.y0) > -1.0
        assert box.x1 < width + 1.0
        assert box.y1 < height + 1.0
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["fast", "cvode method=BDF", "closer than the reference is known"]


def test_a_certificate_is_named(comparison, tmp_path):
    stated = CertifiedBounds(tmp_path / "certificate.json", {})
    certified = replace(comparison, reference=replace(comparison.reference, stated=stated))
    peaks, graph = work_precision_figure(certified).axes
    assert any(text.get_text().startswith("certified to") for text in peaks.texts)
    # A certificate says nothing of the motion as a whole.
    assert any(text.get_text().startswith("reference known to") for text in graph.texts)


def test_errors_against_the_rigid_law_are_drawn():
    asked = entries([("cvode", {})], [1e-5, 1e-8], [])
    found = judge_entries(load_case(CASES / "pair-with-law"), asked, repeats=1)
    table = run_table(found)
    figure = work_precision_figure(found)
    for axes, column in zip(figure.axes, ("rigid_peak_error", "rigid_graph_distance"), strict=True):
        (dotted,) = [line for line in axes.get_lines() if line.get_linestyle() == ":"]
        np.testing.assert_allclose(dotted.get_ydata(), table[column][:2])
        level = [line.get_ydata() for line in axes.get_lines() if line.get_linestyle() == "-."]
        np.testing.assert_allclose(np.ravel(level)[0], table[column][2])
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[1:3] == ["against the rigid law", "contact laws alone"]
