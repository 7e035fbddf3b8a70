"""Numbers of contacts and storeys, each against another way to the same."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from eventpound import Cosine, InputError, Response, simulate, simulate_many
from eventpound.quantities.lookup import names_of
from eventpound.results.run_files import summarise
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from tests.solvers.scenes import pounding_pair


def struck(response: Response, contact: str) -> pd.DataFrame:
    events = response.events
    return events[(events["contact"] == contact) & events["kind"].isin(["impact", "accumulation"])]


@pytest.mark.parametrize("contact", ["left", "joint", "right"])
def test_numbers_of_a_contact_are_those_of_its_events(response, contact):
    rows, of = struck(response, contact), response.summary
    assert len(rows) > 0
    strongest = rows.loc[rows["impulse"].idxmax()]
    fastest = rows.loc[rows["gap_velocity_before"].idxmin()]
    key = f"contacts.{contact}."
    assert of[key + "impacts"] == rows["count"].sum()
    assert of[key + "max_impulse"] == strongest["impulse"]
    assert of[key + "t_max_impulse"] == strongest["t"]
    assert of[key + "t_first_impact"] == rows["t"].iloc[0]
    assert of[key + "sum_impulse"] == pytest.approx(rows["impulse"].sum(), rel=1e-14)
    assert of[key + "fastest_closing"] == -fastest["gap_velocity_before"]
    assert of[key + "t_fastest_closing"] == fastest["t"]
    faster = rows[rows["gap_velocity_before"] < -0.01]
    assert of[key + "impacts_faster"] == faster["count"].sum()


def test_the_threshold_is_the_stated_one(response):
    speeds = -struck(response, "joint")["gap_velocity_before"].to_numpy()
    threshold = float(np.median(speeds))
    other = replace(response, stated=replace(response.stated, threshold_speed=threshold))
    assert other.summary["contacts.joint.impacts_faster"] == np.count_nonzero(speeds > threshold)


def test_energy_lost_in_contacts_adds_up_to_the_ledger(response):
    lost = sum(response.summary[f"contacts.{c}.energy_lost"] for c in ("left", "joint", "right"))
    # The ledger is a sum of the same terms, and each is a difference of velocities.
    assert lost == pytest.approx(response.energy.impact, rel=1e-10)
    assert response.summary["energy.impact"] == response.energy.impact


def test_contacts_of_one_problem_share_what_it_loses():
    # A body strikes two that touch: what the three lose is kinetic energy, from the velocities.
    bodies = (Body("a", 2.0, 0.0, 1.0), Body("b", 1.0), Body("c", 3.0))
    contacts = (Contact("ab", "a", "b", 0.0, 0.5), Contact("bc", "b", "c", 0.0, 0.25))
    response = simulate(Scene(bodies, (), (), contacts), duration=0.1)
    first = [e for e in response.recording.events if e.t == 0.0]
    kinetic = 0.5 * 2.0 - 0.5 * np.array([2.0, 1.0, 3.0]) @ response.recording.v**2
    shares = response.contacts["energy_lost"].to_numpy(float)
    assert len({e.contact for e in first}) == 2
    assert shares.sum() == pytest.approx(kinetic, rel=1e-12)
    # Where γ⁻ = 0 the law gives γ⁺ = 0, and the contact loses nothing.
    assert shares[0] > 0.0 == shares[1]


def test_drift_ratio_is_drift_over_height():
    springs = (
        Spring("storey", (GROUND, "floor"), Linear("40 kN/m"), height="3.2 m"),
        Spring("other", (GROUND, "floor"), Linear(1.0)),
    )
    response = simulate(Scene((Body("floor", 1e3),), springs, motion=Cosine(1.0, 1.0)))
    assert response.summary["springs.storey.drift_ratio"] == (
        response.summary["springs.storey.abs_max_elongation"] / 3.2
    )
    assert "springs.other.drift_ratio" not in response.summary


def frame(masses: Sequence[float], speeds: Sequence[float], gap: float = math.inf) -> Scene:
    """Two storeys of heights that differ, on an isolator without one; a barrier beside the top."""
    bodies = tuple(
        Body(name, mass, 0.0, speed)
        for name, mass, speed in zip(("low", "top"), masses, speeds, strict=True)
    )
    springs = (
        Spring("first", (GROUND, "low"), Linear(4e3), height=5.0),
        Spring("second", ("low", "top"), Linear(3e3), height=2.0),
        Spring("tie", (GROUND, "top"), Linear(0.0)),
    )
    contacts = (Contact("wall", "top", BARRIER, gap, 0.5),) if math.isfinite(gap) else ()
    return Scene(bodies, springs, (), contacts)


def test_largest_drifts_are_those_of_a_mode():
    # Pushed in the shape of a mode, u = shape sin(w t) / w: both storeys are widest at once.
    masses = np.array([20.0, 10.0])
    stiffness = np.array([[7e3, -3e3], [-3e3, 3e3]])
    squares, shapes = np.linalg.eigh(stiffness / np.sqrt(np.outer(masses, masses)))
    frequency, shape = math.sqrt(squares[0]), shapes[:, 0] / np.sqrt(masses)
    drifts = np.abs([shape[0], shape[1] - shape[0]]) / frequency
    ratios = drifts / [5.0, 2.0]
    assert (drifts.argmax(), ratios.argmax()) == (0, 1)
    response = simulate(frame(masses, shape), rtol=1e-10, duration=2.0 * math.pi / frequency)
    found = response.summary
    assert found["max_drift"] == pytest.approx(drifts.max(), rel=1e-8)
    assert found["max_drift_ratio"] == pytest.approx(ratios.max(), rel=1e-8)
    assert found["springs.tie.abs_max_elongation"] > found["max_drift"]
    assert summarise(response)["max_drift"] == found["max_drift"]


def test_largest_drifts_of_many_are_of_each():
    gaps, named = [1e-3, 0.5], ["max_drift", "max_drift_ratio"]
    scene = frame([20.0, 10.0], [0.3, -0.6], gap=0.01)
    table = simulate_many(scene, {"contact.wall.gap": gaps}, duration=4.0, quantities=named).table
    for i, gap in enumerate(gaps):
        one = simulate(
            replace(scene, contacts=(replace(scene.contacts[0], gap=gap),)),
            "fast",
            1e-6,
            duration=4.0,
            output_step=1e-3,
        )
        rows = one.history
        second = (rows["u.top"] - rows["u.low"]).abs().max()
        drifts = np.array([rows["u.low"].abs().max(), second])
        # Between rows a drift of accelerations below 400 m/s^2 grows by less than 5e-5 m.
        assert table["max_drift"][i] == one.summary["max_drift"]
        assert drifts.max() <= table["max_drift"][i] <= drifts.max() + 5e-5
        ratio = (drifts / [5.0, 2.0]).max()
        assert ratio <= table["max_drift_ratio"][i] <= ratio + 2.5e-5


def test_without_heights_there_is_no_largest_drift():
    assert "max_drift" not in names_of(pounding_pair())
    with pytest.raises(InputError, match="max_drift"):
        simulate(pounding_pair(), duration=0.1).quantity("max_drift")


def test_no_number_of_an_impact_without_one():
    scene = Scene(
        (Body("a", 1.0, 0.0, 0.1),),
        (Spring("s", (GROUND, "a"), Linear(1.0)),),
        contacts=(Contact("far", "a", BARRIER, 5.0, 0.5),),
    )
    found = simulate(scene, duration=1.0).summary
    assert found["contacts.far.t_first_impact"] is None
    assert found["contacts.far.fastest_closing"] == 0.0
    assert found["contacts.far.energy_lost"] == 0.0
