import json
import math
import re
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest

import eventpound
from eventpound.accuracy import routes
from eventpound.accuracy.bound import Limit
from eventpound.accuracy.certificate import Certificate, CertifiedQuantity, certificate_text
from eventpound.accuracy.certified_quantities import is_as_good
from eventpound.accuracy.verify import verify
from eventpound.cli import main
from eventpound.errors import ComputationError
from eventpound.motion.record import Record
from eventpound.scene import BARRIER, GROUND, Body, Contact, Dashpot, Linear, Point, Scene, Spring
from tests.accuracy.storeys import DURATION, SCENE, TRUE
from tests.solvers.random_scenes import random_scene


def _wall(gap: float, ratio: float = 0.0) -> Scene:
    """A body released from u = -1, ω = 1, with a wall on its right."""
    return Scene(
        (Body("b", 1.0, -1.0),),
        (Spring("s", (GROUND, "b"), Linear(1.0)),),
        (Dashpot((GROUND, "b"), 2.0 * ratio),) if ratio else (),
        (Contact("wall", "b", BARRIER, gap, 0.5),),
    )


def test_an_impact_in_closed_form():
    """u = -cos t up to u = 0.5, then half the speed back."""
    certificate = eventpound.verify(_wall(0.5), duration=4.0)
    assert certificate.certified
    quantities = {q.quantity: q for q in certificate.quantities}
    t, speed = 2.0 * math.pi / 3.0, math.sqrt(0.75)
    left = 4.0 - t
    for name, true in {
        "peaks.b.max": 0.5,
        "peaks.b.t_max": t,
        "events.0.t": t,
        "events.0.gap_velocity_before": -speed,
        "events.0.gap_velocity_after": speed / 2.0,
        "events.0.impulse": 1.5 * speed,
        "final.b.u": 0.5 * math.cos(left) - speed / 2.0 * math.sin(left),
        "final.b.v": -0.5 * math.sin(left) - speed / 2.0 * math.cos(left),
    }.items():
        # The closed form is evaluated to a few roundings itself.
        assert abs(quantities[name].value - true) <= quantities[name].bound + 1e-15
        assert quantities[name].bound < 1e-10


def test_displacements_at_moments_are_certified():
    """Before the impact, in its very instant, and after it."""
    t, speed = 2.0 * math.pi / 3.0, math.sqrt(0.75)
    moments = [1.0, t, 3.0]
    certificate = verify(_wall(0.5), duration=4.0, moments=moments)
    quantities = {q.quantity: q for q in certificate.quantities}
    after = 3.0 - t
    true = [-math.cos(1.0), 0.5, 0.5 * math.cos(after) - speed / 2.0 * math.sin(after)]
    for k, value in enumerate(true):
        stated = quantities[f"history.{k}.b"]
        assert abs(stated.value - value) <= stated.bound + 1e-15
        assert stated.bound < 1e-10
    assert certificate.certified


def test_a_graze_is_recognised():
    """A wall that a motion overshoots by 1e-12 of its amplitude."""
    certificate = verify(_wall(1.0 - 1e-12), duration=6.0)
    worst = {q.quantity: q for q in certificate.quantities}["final.b.v"]
    # dv/dδ ~ 1/sqrt(2·1e-12).
    assert worst.amplification is not None
    assert worst.amplification > 1e5
    assert any("ill-conditioned" in warning for warning in certificate.warnings)
    assert certificate.grazes[0].contact == "wall"
    assert certificate.grazes[0].closing_speed == pytest.approx(math.sqrt(2e-12), rel=1e-3)


def test_a_near_miss_is_listed():
    certificate = verify(_wall(1.0 + 1e-6), duration=6.0)
    (miss,) = certificate.near_misses
    assert (miss.contact, miss.t) == ("wall", pytest.approx(math.pi, abs=1e-9))
    assert miss.gap == pytest.approx(1e-6, rel=1e-6)


def test_equal_peaks_cost_the_time_and_not_the_value():
    """With ε = 1 at a wall never reached, u = -cos t has its maxima at π and 3π."""
    certificate = verify(_wall(2.0), duration=12.0)
    quantities = {q.quantity: q for q in certificate.quantities}
    assert certificate.certified
    assert quantities["peaks.b.max"].certified
    time = quantities["peaks.b.t_max"]
    assert not time.certified
    assert time.limited_by is Limit.RIVALS


def _by(label: str, certificate: Certificate) -> list[CertifiedQuantity]:
    return [q for q in certificate.quantities if q.route == label]


def test_values_are_those_of_the_reference_where_they_are_as_good(monkeypatch):
    """And of the route with the smallest bound where CVODE is made a thousand times coarser."""
    fine = verify(_wall(0.5), duration=4.0)
    assert fine.reference.startswith("fast")
    assert len(_by(routes.REFERENCE, fine)) > len(_by("fast", fine))
    assert all(q.by_reference is None for q in _by(routes.REFERENCE, fine))
    assert f"{len(_by(routes.REFERENCE, fine))} of cvode Adams" in certificate_text(fine)

    ways = [(*w[:3], 3, w[4]) if w[0] == routes.REFERENCE else w for w in routes._WAYS]
    monkeypatch.setattr(routes, "_WAYS", tuple(ways))
    coarse = verify(_wall(0.5), duration=4.0)
    errors = {"final.b.u", "final.b.v", "events.0.t"} & {q.quantity for q in _by("fast", coarse)}
    assert len(errors) == 3
    stated = {q.quantity: q for q in coarse.quantities}
    for q in fine.quantities:
        # Two values of one number, each within its bound.
        other = stated[q.quantity]
        assert abs(q.value - other.value) <= q.bound + other.bound
        # What is printed of the reference costs no decimal, and at most doubles the bound.
        if q.route == routes.REFERENCE and other.route == "fast":
            assert q.bound <= 2.0 * other.bound


@pytest.mark.parametrize(
    ("apart", "bound", "good"),
    [
        (0.0, math.nan, True),
        (math.nan, 2e-13, False),
        (2e-13, 2e-13, True),
        (2.1e-13, 2e-13, False),
        (4e-13, 7e-13, False),
        (4e-5, 8e-5, False),
        (1e-5, 8e-5, True),
    ],
    ids=["the same", "has none", "within", "beyond", "a decimal less", "refused", "just held"],
)
def test_as_good_is_within_the_bound_and_as_many_decimals(apart, bound, good):
    assert is_as_good(apart, bound, 1e-4) is good


def test_one_formulation_is_not_enough(monkeypatch):
    known = routes.available()
    monkeypatch.setattr(routes, "available", lambda: {"fast": known["fast"]})
    certificate = verify(_wall(0.5), duration=4.0)
    assert not certificate.certified
    assert {q.limited_by for q in certificate.quantities} == {Limit.ALONE}
    assert all(q.bound is None for q in certificate.quantities)


def test_a_contact_at_a_point_in_closed_form():
    """Half of u = -cos t closes 0.25 m where u = 0.5: the wall of the body itself."""
    contact = Contact("wall", Point({GROUND: 0.5, "b": 0.5}), BARRIER, 0.25, 0.5)
    certificate = verify(replace(_wall(0.5), contacts=(contact,)), duration=4.0)
    assert {r.solver for r in certificate.solver_routes} == {"cvode", "fast", "ida"}
    quantities = {q.quantity: q for q in certificate.quantities}
    for name, true in (("events.0.t", 2.0 * math.pi / 3.0), ("peaks.b.max", 0.5)):
        assert abs(quantities[name].value - true) <= quantities[name].bound + 1e-15
        assert quantities[name].bound < 1e-10


def test_a_route_that_fails_is_listed_and_the_others_go_on(monkeypatch):
    class Failing:
        def solve(self, task):
            raise ComputationError("no progress", 1.25)

    known = routes.available()
    monkeypatch.setattr(routes, "available", lambda: known | {"ida": Failing()})
    certificate = verify(_wall(0.5), duration=4.0)
    assert certificate.certified
    (failed,) = [r for r in certificate.solver_routes if r.message]
    assert failed.label == "ida"
    assert "no progress" in failed.message
    assert any("ida failed" in warning for warning in certificate.warnings)


def test_a_record_is_certified_in_both_coordinates():
    t = 0.02 * np.arange(200)
    scene = Scene(
        (Body("b", 1.0),),
        (Spring("s", (GROUND, "b"), Linear(40.0)),),
        (Dashpot((GROUND, "b"), 0.6),),
        (Contact("wall", BARRIER, "b", 0.02, 0.5),),
        Record(np.sin(7.0 * t) * np.sin(0.8 * t), 0.02),
    )
    certificate = verify(scene, 1e-11, duration=5.0)
    labels = [r.label for r in certificate.solver_routes]
    assert "cvode Adams, relative" in labels
    assert certificate.certified
    assert min(q.digits for q in certificate.quantities) >= 7.0


def test_bounds_hold_on_a_random_scene_at_a_loose_tolerance():
    """Certified at 1e-8, compared with a certificate at 1e-13."""
    scene, end = random_scene(3)
    loose, tight = (verify(scene, rtol, duration=end) for rtol in (1e-8, 1e-13))
    finer = {q.quantity: q for q in tight.quantities}
    checked = [q for q in loose.quantities if q.certified and not q.quantity.startswith("ev")]
    assert len(checked) >= 6
    for q in checked:
        assert q.bound is not None
        assert abs(q.value - finer[q.quantity].value) <= q.bound + (finer[q.quantity].bound or 0.0)


def test_a_run_that_takes_too_long_is_a_failed_route():
    certificate = verify(_wall(0.5), duration=4.0, patience=1e-9)
    assert not certificate.certified
    assert any("takes longer than 1e-09 s" in r.message for r in certificate.solver_routes)


def test_command_writes_both_files(tmp_path, capsys):
    main(["new", str(tmp_path / "case")])
    assert main(["verify", str(tmp_path / "case"), "--rtol", "1e-11"]) == 0
    out, err = capsys.readouterr()
    assert "certificate given" in out
    assert "fast at rtol 1e-11" in err
    folder = tmp_path / "case" / "results"
    stored = json.loads((folder / "certificate.json").read_text())
    assert stored["certified"] is True
    assert stored["parting"] is None
    first = stored["quantities"][0]
    assert set(first) >= {
        "quantity", "value", "bound", "unit", "digits", "certified", "limited_by", "amplification",
    }  # fmt: skip
    assert (folder / "certificate.txt").read_text() in out
    digits = [quantity["digits"] for quantity in stored["quantities"]]
    last = re.search(r"^all (\d+) numbers hold to ([\d.]+) digits or more$", out, re.MULTILINE)
    assert int(last[1]) == len(digits)
    # Rounded down, to a tenth.
    assert 0.0 <= min(digits) - float(last[2]) <= 0.1


def test_command_refuses_with_exit_code_1(tmp_path, capsys, monkeypatch):
    main(["new", str(tmp_path / "case")])
    known = routes.available()
    monkeypatch.setattr(routes, "available", lambda: {"fast": known["fast"]})
    assert main(["verify", str(tmp_path / "case"), "--out", str(tmp_path / "out")]) == 1
    out, err = capsys.readouterr()
    assert "refused" in err
    assert "no number is certified" in out
    assert json.loads((tmp_path / "out" / "certificate.json").read_text())["certified"] is False


@pytest.mark.parametrize("words", ["nan", "-1", "0", "inf", "soon"])
def test_patience_is_a_stretch_of_time(words, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["verify", "case", "--patience", words])
    assert f"found {words!r}; accepted: a number of seconds" in capsys.readouterr().err


def _interrupted_at(monkeypatch, label: str) -> None:
    """Ctrl-C in the route of this label."""
    whole = routes.run_route

    def run_route(route, task, patience):
        if route.label == label:
            raise KeyboardInterrupt
        return whole(route, task, patience)

    monkeypatch.setattr("eventpound.accuracy.verify.run_route", run_route)


def test_an_interrupt_keeps_the_routes_that_are_done(monkeypatch):
    _interrupted_at(monkeypatch, "cvode BDF, SUNDIALS' roots")
    with pytest.raises(KeyboardInterrupt) as caught:
        verify(_wall(0.5), duration=4.0)
    kept = caught.value.certificate
    assert [route.message for route in kept.solver_routes] == ["", "", *["interrupted"] * 2]
    assert not kept.certified
    assert kept.refused == kept.quantities
    assert kept.quantities
    assert "interrupted" in kept.warnings[0]


def test_an_interrupt_before_any_route_is_done(monkeypatch):
    _interrupted_at(monkeypatch, "fast")
    with pytest.raises(KeyboardInterrupt) as caught:
        verify(_wall(0.5), duration=4.0)
    assert caught.type is KeyboardInterrupt


def test_an_interrupted_command_writes_what_is_done(monkeypatch, tmp_path, capsys):
    case = tmp_path / "pulse"
    assert main(["new", str(case)]) == 0
    _interrupted_at(monkeypatch, "ida")
    assert main(["verify", str(case)]) == 130
    text = (case / "results" / "certificate.txt").read_text()
    assert "REFUSED" in text
    assert "ida, rtol" in text
    assert "certificate.txt; nothing is certified" in capsys.readouterr().err
    # A certificate that is there is worth more than half of another.
    (case / "results" / "certificate.json").write_text("{}")
    assert main(["verify", str(case)]) == 130
    assert (case / "results" / "certificate.json").read_text() == "{}"
    assert "stays" in capsys.readouterr().err


def test_a_certificate_at_the_tightest_tolerance_holds_against_113_bits():
    """The fast solver is off by the same 1.4e-13 of scale at rtol 1e-11 to 1e-14."""
    certificate = verify(SCENE, duration=DURATION)
    found = {quantity.quantity: quantity for quantity in certificate.quantities}
    assert certificate.certified
    for name, true in TRUE.items():
        bound = found[name].bound
        assert bound is not None
        assert abs(Decimal(found[name].value) - true) <= bound
        assert found[name].digits >= 11.0
