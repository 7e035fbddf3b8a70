"""Figures of a study: what is in them, and the page of all of them."""

import numpy as np
import pytest
from matplotlib.collections import QuadMesh

from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.report.gallery import about_case
from eventpound.report.study_figure import study_figures
from eventpound.report.symbols import axis_label, value_label
from eventpound.study.engine import Batch
from eventpound.study.running import run_study
from eventpound.study.table import read_table
from tests.study.conftest import ELASTOPLASTIC

FIGURE = """
[figure]
name = "gaps"
x = "pi.Q"
y = "pi_um"
curves = "pi.delta"
columns = "excitation.reverse"
grey = "free.pi_um"
regions = 0.1
marks = [0.5]
"""


@pytest.fixture
def drawn(make_study):
    """Maker of the figures of a study, with its table."""

    def make(text):
        case = make_study(text)
        out = case.directory / "results"
        run_study(case.study, out, Batch())
        table = read_table(out)
        return dict(study_figures(case, case.figures[0], table)), table

    return make


def test_panels_have_the_curves_of_the_table(drawn):
    figures, table = drawn(ELASTOPLASTIC + FIGURE)
    axes, other = figures["gaps.png"].axes
    assert [a.get_title() for a in (axes, other)] == ["normal", "reverse"]
    for panel, reverse in ((axes, "False"), (other, "True")):
        part = table[table["excitation.reverse"] == reverse]
        lines = panel.get_lines()
        # A mark, the grey line, a curve for each gap.
        assert len(lines) == 4
        grey, *curves = lines[1:]
        assert grey.get_ydata().tolist() == part["free.pi_um"].tolist()[:40]
        for line, delta in zip(curves, (0.1, 0.5), strict=True):
            curve = part[part["pi.delta"] == delta]
            assert line.get_xdata().tolist() == curve["pi.Q"].tolist()
            assert line.get_ydata().tolist() == curve["pi_um"].tolist()


def test_what_is_negative_is_in_the_picture(drawn):
    figure = FIGURE.replace('y = "pi_um"', 'y = "peaks.0.min"').replace('grey = "free.pi_um"', "")
    study = ELASTOPLASTIC.replace('"pi_um",', '"pi_um", "peaks.0.min",')
    figures, table = drawn(study + figure)
    for panel, reverse in zip(figures["gaps.png"].axes, ("False", "True"), strict=True):
        least = table[table["excitation.reverse"] == reverse]["peaks.0.min"].min()
        assert panel.get_ylabel() == "least displacement of 0 (m)"
        assert panel.get_ylim()[0] <= least < 0.0


def test_a_map_has_the_values_of_the_table(drawn):
    """Over both axes, each cell around its values; colours are the same in all panels."""
    figure = 'x = "pi.Q"\ny = "peaks.0.abs_max"\ncurves = "pi.delta"\nkind = "map"\nmarks = [0.5]\n'
    figure = f'[figure]\n{figure}columns = "excitation.reverse"\ny_scale = "logarithmic"\n'
    study = ELASTOPLASTIC.replace('"pi_um",', '"peaks.0.abs_max",', 1)
    study = study.replace("[excitation]", "[excitation]\namplitude = 0.05")
    figures, table = drawn(study + figure)
    (axes, other, *bars) = figures["study.png"].axes
    assert len(bars) == 2
    for panel, reverse in ((axes, "False"), (other, "True")):
        (mesh,) = [c for c in panel.collections if isinstance(c, QuadMesh)]
        part = table[table["excitation.reverse"] == reverse]
        grid = np.ma.getdata(mesh.get_array()).reshape(2, 40)
        for row, delta in zip(grid, (0.1, 0.5), strict=True):
            peaks = part[part["pi.delta"] == delta]["peaks.0.abs_max"]
            assert row == pytest.approx(100.0 * peaks.to_numpy(), rel=1e-14)
        borders = mesh.get_coordinates()[:, 0, 1]
        # In a logarithmic axis the middle of 0.1 and 0.5 is the root of their product.
        assert borders[1] == pytest.approx(0.05**0.5)
        assert panel.get_title().endswith("$u_{max}$ of 0 (cm)")
        assert panel.get_ylabel() == axis_label("pi.delta")
        least, most = (100.0 * f(table["peaks.0.abs_max"]) for f in (min, max))
        assert mesh.get_clim() == pytest.approx((least, most))


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        ('curves = "pi.delta"\ngrey = "free.pi_um"\n', "found 'map'; accepted: a figure with"),
        ("", "kind: found 'map'; accepted: a figure with curves"),
        (
            'curves = "excitation.reverse"\n',
            "kind: found map of 'pi.Q' over 'excitation.reverse'; acc",
        ),
        (
            'curves = "pi.delta"\ncolumns = "excitation.reverse"\nline = [[0.1, 0.2, 0.3]]\n',
            r"line: found \[\[0.1, 0.2, 0.3\]\]; accepted: points",
        ),
        (
            'curves = "pi.delta"\n',
            "kind: found several runs in one place of the map; accepted: excitation.rev",
        ),
    ],
)
def test_what_no_map_shows_is_refused(make_study, extra, said):
    figure = f'[figure]\nx = "pi.Q"\ny = "pi_um"\nkind = "map"\n{extra}'
    with pytest.raises(InputError, match=said):
        make_study(ELASTOPLASTIC + figure)


def test_regions_are_where_contact_changes_the_peak(drawn):
    figures, table = drawn(ELASTOPLASTIC + FIGURE)
    for panel, reverse in zip(figures["gaps.png"].axes, ("False", "True"), strict=True):
        curve = table[(table["excitation.reverse"] == reverse) & (table["pi.delta"] == 0.1)]
        spans = [(p.get_x(), p.get_x() + p.get_width()) for p in panel.patches]
        columns = (curve["pi.Q"], curve["amplification"], curve["pi_um"])
        for x, gain, peak in zip(*columns, strict=True):
            inside = any(low <= x <= high for low, high in spans)
            change = abs(peak - peak / gain)
            assert inside == (abs(gain - 1.0) > 0.05 and change > 0.1)


def test_the_gain_stands_below_each_panel(drawn):
    figures, table = drawn(ELASTOPLASTIC + FIGURE + "gain = true\n")
    panels, strips = figures["gaps.png"].axes[:2], figures["gaps.png"].axes[2:]
    for panel, strip, reverse in zip(panels, strips, ("False", "True"), strict=True):
        curve = table[(table["excitation.reverse"] == reverse) & (table["pi.delta"] == 0.1)]
        (line,) = strip.get_lines()
        assert line.get_xdata().tolist() == curve["pi.Q"].tolist()
        assert line.get_ydata().tolist() == curve["amplification"].tolist()
        assert line.get_color() in [other.get_color() for other in panel.get_lines()]
        assert strip.get_xlim() == panel.get_xlim()
        assert (panel.get_xlabel(), strip.get_ylabel()) == ("", "gain")
        tints = [[(p.get_x(), p.get_width()) for p in axes.patches] for axes in (panel, strip)]
        # The first of a strip is what counts as no change.
        assert tints[1][1:] == tints[0]


def test_a_gain_needs_a_curve(make_study):
    with pytest.raises(InputError, match=r"gain: found True; accepted: a figure's regions"):
        make_study(ELASTOPLASTIC + FIGURE.replace("regions = 0.1", "gain = true"))


def test_the_largest_of_each_curve_is_marked(drawn):
    extra = 'largest = 0.4\nlevels = [1.0]\ncolumn_titles = ["towards", "away"]\n'
    figures, table = drawn(ELASTOPLASTIC + FIGURE + extra)
    for panel, reverse in zip(figures["gaps.png"].axes, ("False", "True"), strict=True):
        part = table[(table["excitation.reverse"] == reverse) & (table["pi.Q"] >= 0.4)]
        expected = {part["free.pi_um"].max()}
        expected |= {curve["pi_um"].max() for _, curve in part.groupby("pi.delta")}
        marks = [line for line in panel.get_lines() if line.get_marker() == "o"]
        assert {float(mark.get_ydata()[0]) for mark in marks} == expected
        below = [line for line in panel.get_lines() if line.get_marker() == "^"]
        assert [m.get_xdata()[0] for m in marks] == [m.get_xdata()[0] for m in below]
    assert [a.get_title() for a in figures["gaps.png"].axes] == [
        "towards (normal)", "away (reverse)",
    ]  # fmt: skip


def test_axes_that_go_along_stand_in_the_legend(drawn):
    text = (
        ELASTOPLASTIC.replace("[study]", "[study]", 1)
        + """
[[study.axis]]
key = "excitation.amplitude"
values = [1.0, 2.0]
zip = "pulse"
[[study.axis]]
key = "excitation.period"
values = [0.5, 0.8]
zip = "pulse"
[figure]
x = "pi.Q"
y = "pi_um"
curves = "excitation.amplitude"
"""
    )
    figures, _ = drawn(text)
    (legend,) = figures["study.png"].legends
    labels = [entry.get_text() for entry in legend.get_texts()]
    assert labels == ["$a_g$ = 0.102 g, $T_g$ = 0.5 s", "$a_g$ = 0.2039 g, $T_g$ = 0.8 s"]


def test_what_all_runs_have_in_common_is_stated(drawn):
    figures, _ = drawn(ELASTOPLASTIC + FIGURE)
    texts = " ".join(text.get_text() for text in figures["gaps.png"].texts)
    for part in (r"$\Pi_{u_y}$ = 0.2", r"$\Pi_{\epsilon}$ = 0.6", r"$t = 6\,T_g$", "fast"):
        assert part in texts


def test_parts_have_their_last_axis(drawn):
    text = """
[excitation]
kind = "sine"
[pi]
delta = 0.5
epsilon = 0.6
periods = 3
[study]
quantities = ["pi_um"]
[[study.axis]]
key = "excitation.kind"
values = ["sine"]
[[study.part]]
name = "elastic"
pi = { structure = "elastic" }
[[study.part.axis]]
key = "pi.omega_s"
values = [1, 2, 3]
[[study.part]]
name = "plastic"
pi = { structure = "elastoplastic", uy = 0.2 }
[[study.part.axis]]
key = "pi.Q"
values = [0.5, 1.0]
[figure]
y = "pi_um"
columns = "part"
pages = "excitation.kind"
"""
    figures, _ = drawn(text)
    axes = figures["study-sine.png"].axes
    assert [len(a.get_lines()[0].get_xdata()) for a in axes] == [3, 2]
    assert [a.get_xlabel() for a in axes] == [axis_label("pi.omega_s"), axis_label("pi.Q")]


@pytest.mark.parametrize(
    ("key", "value", "label"),
    [
        ("excitation.reverse", False, "normal"),
        ("excitation.reverse", "True", "reverse"),
        ("excitation.kind", "type-c", "type-c pulse"),
        ("pi.delta", 0.1, r"$\Pi_{\delta}$ = 0.1"),
        ("pi.omega_s.i", 2.0, r"$\Pi_{\omega_s,\,i}$ = 2"),
        ("excitation.amplitude", 3.92266, "$a_g$ = 0.4 g"),
        ("part", "elastic", "elastic"),
        ("part", "yield displacement", "yield displacement"),
    ],
)
def test_labels(key, value, label):
    assert value_label(key, value) == label


def test_page_of_all_figures(make_study, tmp_path, capsys):
    figure = FIGURE + 'claim = "Gaps < 0.1 do not matter."\nmodel = true\n'
    make_study("# Shows a thing.\n# Our choice: all.\n" + ELASTOPLASTIC + figure, "gaps")
    make_study(ELASTOPLASTIC, "without-figure")
    assert about_case(tmp_path / "gaps") == "Shows a thing. Our choice: all."
    out = tmp_path / "figures"
    assert main(["plot", str(tmp_path), "--out", str(out)]) == 0
    page = (out / "index.html").read_text()
    assert "Shows a thing." in page
    assert 'src="gaps/gaps.png"' in page
    assert 'src="gaps/gaps-model.png"' in page
    assert '<a href="#gaps">' in page
    assert 'href="gaps/study.csv"' in page
    assert "Gaps &lt; 0.1 do not matter." in page
    assert "without-figure" not in page
    assert (out / "gaps" / "gaps.png").is_file()
    (tmp_path / "others").mkdir()
    make_study(ELASTOPLASTIC, "others/without-figure")
    assert main(["plot", str(tmp_path / "others")]) == 2
    assert "no case with a [figure]" in capsys.readouterr().err


def test_a_case_that_cannot_be_read_leaves_the_others_their_page(make_study, tmp_path, capsys):
    for name, text in {
        "a-record": '[excitation]\nkind = "record"\nfile = "package:none_such/a.AT2"\n[figure]\n',
        "b-slip": FIGURE + "count = \n",
    }.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "case.toml").write_text(text)
    make_study(ELASTOPLASTIC + FIGURE, "gaps")
    out = tmp_path / "figures"
    assert main(["plot", str(tmp_path), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    page = (out / "index.html").read_text()
    for name in ("a-record", "b-slip"):
        assert f"left out {name}: " in said
        assert f"<li>{name}: " in page
    assert 'src="gaps/gaps.png"' in page
