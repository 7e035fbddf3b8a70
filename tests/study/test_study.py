"""Studies from Python: their rows are those of single runs, of a file and of `simulate_many`."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from eventpound import Cosine, InputError, Record, Study, load_case, prepare, simulate
from eventpound.cli import main
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring, Support
from eventpound.scene.parameters import number_places, with_values
from eventpound.study.table import read_table
from tests.motion.readers.writers import at2, motion
from tests.study.conftest import ELASTOPLASTIC
from tests.study.test_suite import CASE, time_series

GAPS, STRENGTHS = [0.005, 0.02], ["50 N", 100.0, 200.0]
AXES = {"contact.joint.gap": GAPS, "spring.frame.strength": STRENGTHS}
QUANTITIES = ["peaks.deck.abs_max", "contacts.joint.impacts", "body.deck.mass"]


@pytest.fixture
def scene():
    return Scene(
        (Body("deck", 100.0),),
        (Spring("frame", (GROUND, "deck"), BoucWen(1000.0, 100.0, 0.005)),),
        contacts=(Contact("joint", "deck", BARRIER, 0.01, 0.7),),
        motion=Cosine(2.0, 0.8),
    )


def test_rows_are_the_runs_that_simulate_makes(scene):
    found = Study(scene, AXES, quantities=QUANTITIES).run()
    assert list(found.table.columns) == [*AXES, *QUANTITIES, "success", "message"]
    assert len(found) == 6
    places = number_places(scene)
    for i, (gap, strength) in enumerate(product(GAPS, (50.0, 100.0, 200.0))):
        row = found.table.iloc[i]
        assert row["contact.joint.gap"] == gap
        assert row["spring.frame.strength"] == strength
        values = {places["contact.joint.gap"]: gap, places["spring.frame.strength"]: strength}
        alone = simulate(with_values(scene, values), "fast", 1e-6)
        assert row["peaks.deck.abs_max"] == alone.summary["peaks.deck.abs_max"]
        assert row["contacts.joint.impacts"] == alone.impacts
    assert found["contacts.joint.impacts"].sum() == 6


def test_rows_are_those_of_a_file(tmp_path, capsys):
    text = ELASTOPLASTIC.replace('key = "excitation.reverse"', 'key = "pi.uy"').replace(
        "values = [false, true]", "values = [0.2, 0.3]"
    )
    text = text.replace("[study]", "[solver]\nrtol = 1e-5\n[study]")
    first = text.partition("[study]")[0].replace("uy = 0.2", "uy = 0.2\ndelta = 0.1\nQ = 0.1")
    (tmp_path / "case.toml").write_text(first)
    study = Study(
        load_case(tmp_path),
        {"pi.uy": [0.2, 0.3], "pi.delta": [0.1, 0.5], "pi.Q": np.linspace(0.1, 1.6, 40)},
        quantities=["pi_um", "free.pi_um", "amplification", "impacts", "resting_time"],
    )
    found = study.run().table
    (tmp_path / "case.toml").write_text(text)
    assert main(["study", str(tmp_path), "--no-figures"]) == 0
    capsys.readouterr()
    table = read_table(tmp_path / "results")
    assert found.equals(table)


def test_a_folder_keeps_what_is_done(scene, tmp_path):
    class StopError(Exception):
        pass

    def stop(done: int, size: int) -> None:
        told.append((done, size))
        if done:
            raise StopError

    told: list[tuple[int, int]] = []
    axes = {"contact.joint.gap": np.linspace(0.001, 0.03, 200)}
    study = Study(scene, axes, quantities=QUANTITIES)
    with pytest.raises(StopError):
        study.run(tmp_path, progress=stop, workers=1)
    kept = told[-1][0]
    assert 0 < kept < 200
    told.clear()
    found = study.run(tmp_path, progress=lambda *words: told.append(words))
    assert told[0] == (kept, 200)
    assert told[-1] == (200, 200)
    assert found.table.equals(study.run().table)
    # Done: it is read. Another scene is another study.
    told.clear()
    assert study.run(tmp_path, progress=lambda *words: told.append(words)).table.equals(found.table)
    assert told == []
    heavier = replace(scene, bodies=(replace(scene.bodies[0], mass=101.0),))
    other = Study(heavier, axes, quantities=QUANTITIES).run(tmp_path)
    assert not other["peaks.deck.abs_max"].equals(found["peaks.deck.abs_max"])


def test_motions_that_differ_are_studies_that_differ(scene):
    samples = np.sin(np.arange(100.0))
    motions = (Cosine(2.0, 0.8), Cosine(2.0, 0.9), Record(samples, 0.02), Record(-samples, 0.02))
    axes = {"contact.joint.gap": [0.01]}
    digests = {Study(replace(scene, motion=motion), axes).plan.digest for motion in motions}
    assert len(digests) == 4


def test_axes_together_and_numbers_with_units(scene):
    axes = {"contact.joint.gap": ["1 cm", "2 cm"], "contact.joint.restitution": [0.5, "70 %"]}
    found = Study(scene, axes, together=[list(axes)], duration="5 s", quantities=["t_final"]).run()
    assert found["contact.joint.gap"].tolist() == [0.01, 0.02]
    assert found["contact.joint.restitution"].tolist() == [0.5, 0.7]
    assert found["t_final"].tolist() == [5.0, 5.0]


def test_records(scene, tmp_path):
    for i, amplitude in enumerate((0.2, 0.5)):
        lines = time_series(amplitude).splitlines()
        (tmp_path / f"{i}.txt").write_text(
            "\n".join(f"{0.02 * k} {a}" for k, a in enumerate(lines))
        )
    (tmp_path / "case.toml").write_text(CASE.format('suite = "?.txt"\nunits = "g"'))
    case = load_case(tmp_path)
    axes = {"contact.joint.gap": [0.01, 0.02]}
    found = Study(case, axes, quantities=["peaks.<body>.abs_max"]).run()
    assert found["record"].tolist() == ["0.txt", "0.txt", "1.txt", "1.txt"]
    same = Study(case, axes, quantities=["peaks.<body>.abs_max"], records=str(tmp_path / "?.txt"))
    assert same.run().table.equals(found.table)


def test_words_are_short(scene, capsys):
    study = Study(scene, AXES, quantities=QUANTITIES)
    assert repr(study) == (
        "<Study: 6 runs over contact.joint.gap, spring.frame.strength; fast, rtol 1e-06>"
    )
    found = study.run(progress=True)
    assert repr(found) == (
        "<StudyTable: 6 runs over contact.joint.gap, spring.frame.strength, 0 failed; "
        "peaks.deck.abs_max, contacts.joint.impacts, body.deck.mass>"
    )
    assert "<table" in found._repr_html_()
    assert capsys.readouterr().err.endswith("100%  6 of 6 runs\n")


def test_a_failed_run_is_a_row(scene):
    # Each value by itself is sound.
    axes = {"contact.joint.gap": [0.05, 0.01], "body.deck.displacement": [0.0, 0.03]}
    found = Study(scene, axes, quantities=QUANTITIES).run()
    assert found["success"].tolist() == [True, True, True, False]
    assert found.failed.index.tolist() == [3]
    assert "not penetrated" in found.failed["message"].iloc[0]


@pytest.mark.parametrize(
    ("axes", "options", "words"),
    [
        ({"contact.joint.gab": [1.0]}, {}, ["contact.joint.gab", "'contact.joint.gap'"]),
        ({"contact.joint.gap": ["1 s"]}, {}, ["axes: contact.joint.gap", "1 s", "length"]),
        ({"contact.joint.gap": []}, {}, ["no values"]),
        ({"contact.joint.gap": 0.1}, {}, ["0.1", "a list of values"]),
        ({"contact.joint.gap": [-1.0]}, {}, ["-1.0", "not penetrated"]),
        ({"contact.joint.gap": [0.1]}, {"quantities": ["peakz"]}, ["peakz"]),
        ({"contact.joint.gap": [0.1]}, {"solver": "slow"}, ["slow", "cvode"]),
        ({"contact.joint.gap": [0.1]}, {"rtol": 1.0}, ["rtol: found 1.0; accepted: a number"]),
        ({"contact.joint.gap": [0.1]}, {"duration": "-1 s"}, ["duration", "-1 s"]),
        ({"contact.joint.gap": [0.1]}, {"records": "nowhere/*"}, ["nowhere", "no file"]),
        ({"contact.joint.gap": [0.1]}, {"together": [["x"]]}, ["'x' is no axis"]),
    ],
)
def test_what_is_wrong_is_said_before_anything_runs(axes, options, words, scene):
    with pytest.raises(InputError) as error:
        Study(scene, axes, **options)
    for word in words:
        assert word in str(error.value)


def test_records_set_the_lengths_of_a_scene(scene, tmp_path):
    for i in range(2):
        (tmp_path / f"{i}.AT2").write_text(at2(motion(100 + 50 * i, 0.02), 0.02).text)
    found = Study(
        scene,
        {"contact.joint.gap": [0.01]},
        records=str(tmp_path / "?.AT2"),
        quantities=["t_final"],
    ).run()
    assert np.diff(found["t_final"]) == pytest.approx(50 * 0.02)


def test_a_record_at_a_support_sets_the_lengths_of_the_runs(scene):
    """Five periods follow it, which are longer of a heavier body."""
    recorded = Support("pier", motion=Record(np.sin(np.arange(50.0)), 0.02))
    frame = Spring("frame", ("pier", "deck"), Linear(1000.0))
    scene = replace(scene, springs=(frame,), supports=(recorded,))
    masses = [100.0, 400.0]
    found = Study(scene, {"body.deck.mass": masses}, quantities=["t_final"]).run()
    periods = 2.0 * np.pi * np.sqrt(np.array(masses) / 1000.0)
    assert found["t_final"].to_numpy() == pytest.approx(49 * 0.02 + 5.0 * periods)
    heavy = prepare(scene).run({"body.deck.mass": masses[1]})
    assert heavy.recording.t == found["t_final"][1]
