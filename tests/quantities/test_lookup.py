"""The list of quantities: each against another way to the same number, every table from it."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from eventpound import load_case, simulate, simulate_many
from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.motion import Cosine
from eventpound.quantities.base import TakenFrom, pi_unit
from eventpound.quantities.listed import LISTED
from eventpound.quantities.lookup import find, listing, names_of
from eventpound.response import Response
from eventpound.results.run_files import summarise
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.units import Dimension
from tests.models import ROOT
from tests.solvers.scenes import pounding_pair

END = 6.0


@pytest.fixture(scope="module")
def response():
    return simulate(pounding_pair(), duration=END, energy=True)


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


def test_terms_and_scales_stand_in_the_summary(response):
    scales = response.scene.motion.scales()
    assert scales is not None
    first, *_ = response.scene.bodies
    largest = response.summary[f"peaks.{first.name}.abs_max"]
    assert response.summary["pi_um"] == pytest.approx(largest / scales.length, rel=1e-14)
    assert response.summary["scales.L_e"] == scales.length


def test_energy_lost_in_contacts_adds_up_to_the_ledger(response):
    lost = sum(response.summary[f"contacts.{c}.energy_lost"] for c in ("left", "joint", "right"))
    assert response.energy is not None
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


def test_summary_json_holds_every_number_of_the_list(response):
    stored = summarise(response)
    first = f"pi_um.{response.scene.bodies[0].name}"
    for name, value in response.summary.items():
        if str(name).startswith("pi_um"):
            # Π-terms have a table of their own there.
            key = "um" if name in ("pi_um", first) else str(name).removeprefix("pi_")
            assert stored["pi"][key] == value
            continue
        found = find(response.scene, str(name))
        assert found is not None
        before, _, after = found.quantity.path.partition(f"<{found.quantity.owner}>")
        owner = str(name)[len(before) : len(str(name)) - len(after)]
        keys = [*before.split("."), owner, *after.split(".")]
        table: object = stored
        for key in filter(None, keys):
            assert isinstance(table, dict)
            table = table[key]
        assert table == value


def test_named_quantities_of_many_are_those_of_each():
    gaps = {"contact.joint.gap": np.array([0.03, 0.045])}
    named = ["contacts.joint.sum_impulse", "peaks.a.max", "energy.viscous"]
    many = simulate_many(pounding_pair(), gaps, duration=END, quantities=named, rtol=1e-8)
    for i, gap in enumerate(gaps["contact.joint.gap"]):
        scene = pounding_pair()
        contacts = tuple(replace(c, gap=gap) if c.name == "joint" else c for c in scene.contacts)
        one = simulate(
            replace(scene, contacts=contacts), "fast", 1e-8, duration=END, energy=True
        ).summary
        assert [many.table[name][i] for name in named] == [one[name] for name in named]


def test_a_name_that_there_is_not():
    with pytest.raises(InputError, match=r"sum_impulses.*did you mean 'contacts.joint.sum_imp"):
        simulate_many(
            pounding_pair(),
            {"contact.joint.gap": [0.03]},
            quantities=["contacts.joint.sum_impulses"],
        )


def test_names_lead_back_to_their_quantity():
    scene = pounding_pair()
    for name in names_of(scene):
        found = find(scene, name.removeprefix("free."))
        assert found is not None, name
        assert found.name == name.removeprefix("free.")
    assert find(scene, "peaks.nobody.max") is None
    assert find(scene, "springs.cable.ductility") is None


def test_units_of_pi_terms_are_products_of_mass_length_and_time():
    scales = Cosine(3.0, 2.0).scales()
    assert scales is not None
    mass, length, time = 5.0, scales.length, 1.0 / scales.omega_g
    expected = {
        Dimension.LENGTH: length,
        Dimension.VELOCITY: length / time,
        Dimension.ACCELERATION: length / time**2,
        Dimension.TIME: time,
        Dimension.FORCE: mass * length / time**2,
        Dimension.IMPULSE: mass * length / time,
        Dimension.ENERGY: mass * length**2 / time**2,
        Dimension.NUMBER: 1.0,
    }
    for dimension, unit in expected.items():
        assert pi_unit(dimension, scales, mass) == pytest.approx(unit, rel=1e-14)
    assert {q.dimension for q in LISTED} <= {*expected, Dimension.ANGULAR_FREQUENCY}


def test_the_command_lists_them_without_a_case(capsys):
    assert main(["check", "--quantities"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed[1:-1]] == [path for path, *_ in listing()]


def test_names_of_a_case(capsys):
    case = ROOT / "cases" / "pair"
    assert main(["check", "--quantities", str(case)]) == 0
    assert capsys.readouterr().out.split() == names_of(load_case(case).scene)


def test_names_of_a_study_are_those_of_all_its_scenes(tmp_path, capsys):
    part = '[[study.part]]\nname = "{0}"\npi = {{ structure = "{0}"{1} }}\n'
    text = '[excitation]\nkind = "sine"\n[pi]\n[study]\n'
    axis = '[[study.axis]]\nkey = "excitation.reverse"\nvalues = [false, true]\n'
    both = part.format("elastic", ", omega_s = 1.0")
    both += part.format("elastoplastic", ", uy = 0.2, Q = 0.3")
    (tmp_path / "case.toml").write_text(text + axis + both)
    assert main(["check", "--quantities", str(tmp_path)]) == 0
    names = capsys.readouterr().out.split()
    assert "peaks.0.abs_max" in names
    assert any(name.endswith(".ductility") for name in names)
    # Numbers of its scenes are columns of a study, too.
    assert "spring.0.strength" in names
    assert len(names) == len(set(names))


def test_a_study_tabulates_what_needs_all_of_a_run(tmp_path):
    text = (ROOT / "cases" / "pair" / "case.toml").read_text().split("[run]")[0]
    names = ["contacts.joint.sum_impulse", "free.final.stiff.u", "contacts.joint.impacts_faster"]
    study = (
        f'[study]\nquantities = {json.dumps(names)}\n[[study.axis]]\nkey = "contact.joint.gap"\n'
    )
    (tmp_path / "case.toml").write_text(
        text + study + 'values = ["1 cm", "2 cm"]\n[run]\nthreshold_speed = "5 cm/s"\n'
    )
    assert main(["study", str(tmp_path)]) == 0
    table = pd.read_csv(tmp_path / "results" / "study.csv")
    case = load_case(ROOT / "cases" / "pair")
    run = replace(case.run, stated=replace(case.run.stated, threshold_speed=0.05))
    one = simulate(replace(case, run=run), "fast").summary
    assert table[names[0]][0] == one[names[0]]
    assert table[names[2]].tolist()[0] == one[names[2]] > 0
    assert math.isclose(table[names[1]][0], table[names[1]][1])


def test_a_case_names_what_it_wants(tmp_path):
    text = (ROOT / "cases" / "pair" / "case.toml").read_text().split("[run]")[0]
    wanted = 'quantities = ["springs.<spring>.*_force", "velocity.stiff.abs_max"]'
    run = f'[run]\nwithout_contact = true\ncontact_stiffness = "50 MN/m"\n{wanted}\n'
    (tmp_path / "case.toml").write_text(text + run)
    assert main(["run", str(tmp_path), "--no-figures"]) == 0
    stored = json.loads((tmp_path / "results" / "summary.json").read_text())
    one = simulate(load_case(tmp_path))
    free = replace(one.scene, contacts=())
    apart = simulate(free, duration=one.task.end).peaks
    assert stored["free"]["peaks"]["stiff"]["abs_max"] == apart.loc["stiff", "abs_max"]
    gain = one.peaks.loc["stiff", "abs_max"] / apart.loc["stiff", "abs_max"]
    assert stored["amplification"]["stiff"] == pytest.approx(gain, rel=1e-15)
    assert stored["velocity"]["stiff"]["abs_max"] == one.quantity("velocity.stiff.abs_max")
    assert stored["springs"]["flexible-piers"]["t_max_force"] > 0.0
    assert stored["contacts"]["joint"]["estimated_force"] > 0.0
    # The case as understood says it again.
    manifest = json.loads((tmp_path / "results" / "manifest.json").read_text())
    assert manifest["case"]["run"]["contact_stiffness"] == 5e7


def test_a_named_quantity_that_there_is_not(tmp_path, capsys):
    text = (ROOT / "cases" / "pair" / "case.toml").read_text().split("[run]")[0]
    (tmp_path / "case.toml").write_text(text + '[run]\nquantities = ["velocity.stif.max"]\n')
    for command in ("check", "run"):
        assert main([command, str(tmp_path)]) == 2
        said = capsys.readouterr().err
        assert "case.toml: [run]: quantities: found 'velocity.stif.max', did you mean 'vel" in said
    assert not (tmp_path / "results").exists()
    with pytest.raises(InputError, match=r"did you mean 'velocity\.stiff\.max'"):
        simulate(load_case(tmp_path))


def test_every_source_is_used():
    assert {q.source for q in LISTED} == set(TakenFrom)


def test_a_named_energy_brings_the_ledger(tmp_path):
    text = (ROOT / "cases" / "pair" / "case.toml").read_text()
    (tmp_path / "case.toml").write_text(text + '\n[run]\nquantities = ["energy.impact"]\n')
    case = load_case(tmp_path)
    found = simulate(case).energy
    assert found is not None
    assert found.impact == simulate(case, energy=True).energy.impact
