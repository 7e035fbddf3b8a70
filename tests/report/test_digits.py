from dataclasses import replace

from eventpound.accuracy.certificate import PartedRoute
from eventpound.accuracy.verify import verify
from eventpound.report.digits import digits_figure
from eventpound.report.style import png
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring


def test_digits_and_amplification_share_an_axis_of_time():
    scene = Scene(
        (Body("b", 1.0, -1.0),),
        (Spring("s", (GROUND, "b"), Linear(1.0)),),
        (),
        (Contact("wall", "b", BARRIER, 0.5, 0.5),),
    )
    certificate = verify(scene, duration=4.0)
    parted = replace(certificate, parting=PartedRoute("a", 2.0, "wall", "impact", "nothing"))
    figure = digits_figure(parted)
    upper, lower = figure.axes
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("digits agreed (-)", "amplification (-)")
    assert lower.get_xlabel() == "time (s)"
    assert upper.get_legend_handles_labels()[1] == ["routes part"]
    assert png(figure).startswith(b"\x89PNG")


def test_without_routes_there_is_no_figure():
    certificate = verify(Scene((Body("b", 1.0, 0.0, 1.0),)), duration=1.0)
    assert digits_figure(replace(certificate, digits_over_time=None)) is None
