"""The list of quantities: each against another way to the same number, every table from it."""

import json
import math
from dataclasses import replace

import pandas as pd
import pytest

from eventpound import InputError, load_case, simulate, simulate_many
from eventpound.cli import main
from eventpound.quantities.lookup import find, listing, names_of
from eventpound.results.run_files import summarise
from tests.models import ROOT
from tests.solvers.scenes import pounding_pair


def test_terms_and_scales_stand_in_the_summary(response):
    scales = response.scene.motion.scales()
    first, *_ = response.scene.bodies
    largest = response.summary[f"peaks.{first.name}.abs_max"]
    assert response.summary["pi_um"] == pytest.approx(largest / scales.length, rel=1e-14)
    assert response.summary["scales.L_e"] == scales.length


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
        before, _, after = found.quantity.path.partition(f"<{found.quantity.owner}>")
        owner = str(name)[len(before) : len(str(name)) - len(after)]
        keys = [*before.split("."), owner, *after.split(".")]
        table: object = stored
        for key in filter(None, keys):
            table = table[key]
        assert table == value


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


def test_a_named_energy_brings_the_ledger(tmp_path):
    text = (ROOT / "cases" / "pair" / "case.toml").read_text()
    (tmp_path / "case.toml").write_text(text + '\n[run]\nquantities = ["energy.impact"]\n')
    case = load_case(tmp_path)
    found = simulate(case).energy
    assert found.impact == simulate(case, energy=True).energy.impact
