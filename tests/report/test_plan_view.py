"""The plan of a bridge: what is drawn where."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound import simulate
from eventpound.report.model_figure import model_figure
from eventpound.report.plan_view import moving_plan, plan_figure
from eventpound.report.run_appendix import _CAPTIONS
from eventpound.report.run_figures import figures, view_of_run
from eventpound.report.zoom import zoom_page
from eventpound.results.shown_units import Units
from eventpound.scene import BARRIER, Deck, Joint, Scene
from eventpound.scene.deck import place_in_a_row


def bridge():
    bare = [Deck("A", "900 t", "36 m", "11 m", 0.5), Deck("B", "700 t", "28 m", "11 m", 0.5)]
    places = place_in_a_row(bare, [0.04])
    decks = [
        Deck(d.name, d.mass, d.length, d.width, d.skew, at)
        for d, at in zip(bare, places, strict=True)
    ]
    known = {deck.name: deck for deck in decks}
    joints = (Joint("west", (BARRIER, "A"), "6 cm", 0.5), Joint("middle", ("A", "B"), "4 cm", 0.5))
    contacts = [contact for joint in joints for contact in joint.contacts(known)]
    return Scene([b for d in decks for b in d.bodies()], contacts=contacts, decks=decks)


def texts(figure):
    return [text.get_text() for text in figure.axes[0].texts]


def test_decks_and_gaps_at_rest():
    shown = texts(model_figure(bridge(), "two spans"))
    assert {"A", "B", "west.lower\n60 mm", "middle.upper\n40 mm"} <= set(shown)


def test_decks_at_an_instant():
    scene = bridge()
    state = dict.fromkeys((b.name for b in scene.bodies), 0.0)
    state |= {"A.x": -0.03, "B.turn": 1e-3 * scene.decks[1].radius}
    figure = plan_figure(scene, state=state)
    shown = texts(figure)
    assert "A\n0 mrad" in shown
    assert "B\n1 mrad" in shown
    opened = 0.06 - 0.03 * np.cos(0.5)
    assert f"west.lower\n{1e3 * opened:.3g} mm" in shown
    assert "times larger" in figure.axes[0].get_title()


@pytest.mark.parametrize("factor", [1.0, 1e-3])
def test_a_state_is_drawn_as_large_whatever_its_size(factor):
    scene = bridge()
    state = dict.fromkeys((b.name for b in scene.bodies), 0.0) | {"A.x": 0.5 * factor}
    times = float(plan_figure(scene, state=state).axes[0].get_title().split()[-3])
    assert times == pytest.approx(min(100.0, 5.0 / factor), rel=0.6)


def moved():
    """Decks that nothing holds, half a second of them."""
    scene = bridge()
    bodies = [replace(body, velocity=0.3) for body in scene.bodies]
    return simulate(replace(scene, bodies=bodies), duration=0.5, output_step=0.01)


def test_displacements_by_directions_and_rotations():
    response = moved()
    scene, drawn = response.scene, figures(response)
    panels = {axes.get_ylabel().split(" (")[0]: axes for axes in drawn["displacements.png"].axes}
    assert {"along", "across", "rotation", "gap"} <= set(panels)
    line = next(each for each in panels["rotation"].get_lines() if each.get_label() == "B")
    # Nothing turns it but an impact: 0.3 m/s of r theta, in mrad.
    turned = 300.0 / scene.decks[1].radius * line.get_xdata()[1]
    assert line.get_ydata()[1] == pytest.approx(turned)
    assert "west.lower: barrier | A" in [each.get_label() for each in panels["gap"].get_lines()]
    # The report has something to say of each.
    assert set(drawn) <= set(_CAPTIONS)


def test_the_page_that_zooms_shows_the_bridge_move():
    response = moved()
    view = view_of_run(response)
    plan = moving_plan(view)
    (west, _, middle, _), u = plan["contacts"], response.history
    assert middle["wall"] is None
    assert [k for k, *_ in middle["at"]] == [0, 1]
    # The wall is as far from the corner, at right angles, as the gap that is drawn.
    (k, x, y), deck = west["at"][0], plan["decks"][0]
    corner, normal = np.add(deck["centre"], (x, y)), np.array([np.cos(0.5), np.sin(0.5)])
    assert k == 0
    assert (corner - west["wall"]) @ normal == pytest.approx([0.06 * plan["times"]] * 2)
    # The largest displacement of a corner is drawn as no more than a part of the bridge.
    first = response.scene.decks[0]
    far = max(
        np.hypot(u["u.A.x"] - b * turn, u["u.A.y"] + a * turn).max()
        for turn in (u["u.A.turn"] / first.radius,)
        for a, b in first.corners
    )
    assert 1.0 <= plan["times"] <= 0.06 * 80.0 / far
    page = zoom_page(view, "two spans", Units()).decode()
    assert '<canvas id="plan">' in page
    assert '"rotation"' in page
    assert "drawPlan" in page
