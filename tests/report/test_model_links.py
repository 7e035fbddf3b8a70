"""How springs and dashpots are led between the bodies of a drawing."""

from eventpound import modal_damping
from eventpound.report.model_layout import layout_of
from eventpound.report.model_links import links_drawn
from eventpound.scene import GROUND, Body, Contact, Dashpot, Linear, Scene, Spring
from tests.report.test_model_figure import assert_nothing_is_in_the_way, everything, storeys


def test_a_spring_goes_round_what_is_between_its_ends():
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


def test_soil_stands_beside_its_body_at_a_wall():
    scene = everything()
    layout = layout_of(scene)
    (route,) = (r for r in links_drawn(scene, layout) if r.label == "soil")
    assert not route.upright
    assert [x < layout.boxes["deck $1"].left for x, _ in route.corners] == [True, False]


def test_dashpots_of_modal_damping_are_drawn_beside_springs_alone():
    springs = storeys("A", 4)
    bodies = tuple(Body(spring.between[1], 1.0) for spring in springs)
    scene = Scene(bodies, tuple(springs), modal_damping(bodies, springs, 0.05))
    drawn = [r.link.between for r in links_drawn(scene, layout_of(scene)) if r.link not in springs]
    assert sorted(drawn) == sorted(spring.between for spring in springs)
    # A damper across two storeys is no modal damping.
    damper = Dashpot(("A1", "A3"), 1.0)
    routes = links_drawn(Scene(bodies, tuple(springs), (damper,)), layout_of(scene))
    assert damper in [route.link for route in routes]
