"""Events of springs beside closed forms and a program in SciPy, in files and in messages."""

import json
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eventpound import Response, load_case, prepare, simulate, simulate_suite, verify, write
from eventpound.basics.told import OptionWarning
from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.motion import Harmonic, NoMotion
from eventpound.scene import Backfill, Body, Linear, Scene, Slider, Spring
from eventpound.scene.spring import GROUND, LawName
from tests.models import ROOT
from tests.solvers.test_backfill import BETWEEN_TWO, POUNDING, THROWN_BACK, by_scipy
from tests.solvers.test_backfill import SOLVERS as OF_SOIL
from tests.solvers.test_sliders import (
    CLOSE,
    RTOL,
    SOLVERS,
    block_on_shaken_plane,
    broken_stick,
    g,
    on_ground,
    run,
)

SLIDING = "deck-on-sliders"


def swing() -> Scene:
    deck, bearing = on_ground(
        Slider.pendulum(0.1, 1000.0 * g, 1000.0 * g / 4.0e5), displacement=0.05
    )
    return Scene((deck,), (bearing,), motion=NoMotion())


@pytest.mark.parametrize(("solver", "events"), SOLVERS)
@pytest.mark.parametrize("strong", [1.3, 3.0], ids=["sticks", "slips on"])
def test_block_on_a_shaken_plane_sticks_and_slips_when_the_closed_form_says(solver, events, strong):
    friction, w, end = 0.1 * g, 5.0, 9.0
    deck, bearing = on_ground(Slider(0.1, 1000.0 * g))
    motion = Harmonic(strong * friction, 2.0 * math.pi / w)
    found = run(Scene((deck,), (bearing,), motion=motion), end, solver, events).spring_events
    times, _ = block_on_shaken_plane(strong * friction, w, friction, end)
    # Where it slips back at once, one slip ends when the next begins.
    np.testing.assert_allclose(found["time_s"], np.unique(times), rtol=0.0, atol=CLOSE)
    slips = found[found["kind"] == "slip"]
    assert len(slips) == len(times[::2])
    assert (found["kind"] == "stick").sum() == len(np.unique(times)) - len(slips)
    # The ground moves off to the right at first.
    assert slips["direction"].tolist() == [-1, 1] * (len(slips) // 2) + [-1] * (len(slips) % 2)
    np.testing.assert_allclose(slips["force_N"], 1000.0 * friction * slips["direction"])
    pull = 1000.0 * strong * friction * np.sin(w * found["time_s"])
    sticks = found["kind"] == "stick"
    np.testing.assert_allclose(found["force_N"][sticks], -pull[sticks], atol=1e-6)
    assert not found["direction"][sticks].any()
    assert set(found["spring"]) == {"bearing"}


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_swing_slips_back_each_half_period_until_it_sticks(solver):
    found = run(swing(), 3.0, solver).spring_events
    half, dead = math.pi * math.sqrt(1000.0 / 4.0e5), 0.1 * g / 400.0
    np.testing.assert_allclose(found["time_s"], half * np.arange(11), rtol=0.0, atol=CLOSE)
    assert found["kind"].tolist() == ["slip"] * 10 + ["stick"]
    assert found["direction"].tolist() == [-1, 1] * 5 + [0]
    ends = (0.05 - 2.0 * dead * np.arange(11)) * (-1.0) ** np.arange(11)
    np.testing.assert_allclose(found["elongation_m"], ends, rtol=0.0, atol=CLOSE * 0.05)


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast"])
def test_an_impact_that_breaks_a_stick_is_an_impact_and_a_slip(solver):
    response = run(broken_stick(), 6.0, solver)
    found = response.spring_events
    assert found["kind"].tolist() == ["slip", "stick"]
    assert found["spring"].tolist() == ["between"] * 2
    assert found["direction"].tolist() == [-1, 0]
    # 1 m/s from t = 1 s on, which friction of 0.3 N stops.
    np.testing.assert_allclose(found["time_s"], [1.0, 1.0 + 1.0 / 0.3], atol=CLOSE)
    assert response.events["contact"].tolist() == ["face"]
    assert response.events["kind"].tolist() == ["impact"]


@pytest.mark.parametrize(("solver", "settings"), OF_SOIL)
@pytest.mark.parametrize(
    ("scene", "end"),
    [(BETWEEN_TWO, 8.0), (POUNDING, 6.0), (THROWN_BACK, 2.0)],
    ids=["two abutments", "pounding", "thrown back"],
)
def test_soil_is_touched_and_left_as_in_another_program(scene, end, solver, settings):
    # No row but those of events.
    response = simulate(
        scene, solver, RTOL, duration=end, output_step=end, settings=settings, error_estimate=False
    )
    found, answer = response.spring_events, by_scipy(scene, end)
    names = [spring.name for spring in scene.springs if isinstance(spring.law, Backfill)]
    # What is touched at the start is not touched later.
    touched = [each for each in answer.touched if each[0] > 1e-9]
    times, which, ways = zip(*touched, strict=True)
    np.testing.assert_allclose(found["time_s"], times, rtol=0.0, atol=CLOSE)
    assert found["spring"].tolist() == [names[i] for i in which]
    assert found["direction"].tolist() == list(ways)
    kinds = {-1: "gap-closed", 1: "gap-opened"}
    assert found["kind"].tolist() == [kinds[way] for way in ways]
    assert set(response.events["contact"]) <= {"joint"}


def shaken() -> Scene:
    deck, bearing = on_ground(Slider(0.1, 1000.0 * g, 2.0e4))
    return Scene((deck,), (bearing,), motion=Harmonic(3.0, 1.1))


@pytest.mark.parametrize("scene", [shaken(), BETWEEN_TWO], ids=["slider", "soil"])
def test_the_table_is_the_same_however_the_run_is_made(scene):
    whole = simulate(scene, duration=5.0, error_estimate=False)
    table = whole.spring_events
    assert len(table) > 8
    few = simulate(scene, duration=5.0, output_step=5.0, error_estimate=False)
    again = prepare(scene, duration=5.0).run()
    for other in (few, again):
        pd.testing.assert_frame_equal(other.spring_events, table, check_exact=True)
    rows = whole.at(table["time_s"].to_numpy())
    spring = table["spring"].iloc[0]
    own = (table["spring"] == spring).to_numpy()
    np.testing.assert_array_equal(rows[f"force.{spring}"][own], table["force_N"][own])


@pytest.mark.parametrize("cut", [0.4, 1.8], ids=["while it slips", "while it sticks"])
def test_events_of_a_run_that_goes_on_are_those_that_are_left(cut):
    scene = swing()
    whole, first = run(scene, 2.0), run(scene, cut)
    later = simulate(scene, duration=2.0 - cut, start=first.final, rtol=RTOL, error_estimate=False)
    rest = later.spring_events.assign(time_s=lambda table: table["time_s"] + cut)
    joined = pd.concat([first.spring_events, rest], ignore_index=True)
    pd.testing.assert_frame_equal(joined, whole.spring_events, rtol=1e-6)


def case_with(folder: Path, options: str, name: str = SLIDING) -> Path:
    text = (ROOT / "cases" / name / "case.toml").read_text()
    assert "[run]" not in text
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(f"{text}\n[run]\n{options}\n")
    return folder


def written(folder: Path) -> pd.DataFrame:
    return pd.read_csv(folder / "results" / "spring_events.csv")


def test_a_run_writes_what_is_asked_for_and_nothing_else(tmp_path):
    folder = case_with(tmp_path, 'events = ["slip"]')
    assert main(["run", str(folder), "--no-figures"]) == 0
    response = simulate(load_case(folder), error_estimate=False)
    own = response.spring_events
    slips = own[own["spring"] == "bearings"].reset_index(drop=True)
    pd.testing.assert_frame_equal(written(folder), slips, check_exact=True)
    assert len(slips) < len(own)
    contacts = pd.read_csv(folder / "results" / "events.csv")
    assert set(contacts["contact"]) == {"right"}
    case_with(tmp_path, 'events = ["soil", "slip"]')
    assert main(["run", str(folder), "--no-figures"]) == 0
    pd.testing.assert_frame_equal(written(folder), own, check_exact=True)
    files = json.loads((folder / "results" / "manifest.json").read_text())["files"]
    assert "spring_events.csv" in files


def test_a_run_that_is_not_asked_leaves_none_of_an_earlier_one(tmp_path):
    folder = case_with(tmp_path, 'events = ["slip"]')
    assert main(["run", str(folder), "--no-figures"]) == 0
    before = (folder / "results" / "history.csv").read_bytes()
    case_with(tmp_path, "")
    assert main(["run", str(folder), "--no-figures"]) == 0
    assert not (folder / "results" / "spring_events.csv").exists()
    assert (folder / "results" / "history.csv").read_bytes() == before


def test_a_run_that_ends_early_keeps_the_events_up_to_there(tmp_path):
    folder = case_with(tmp_path, 'events = ["slip"]')
    assert main(["run", str(folder), "--no-figures"]) == 0
    whole = written(folder)
    assert main(["run", str(folder), "--no-figures", "--max-steps", "200"]) == 1
    part = written(folder)
    assert 0 < len(part) < len(whole)
    pd.testing.assert_frame_equal(part, whole.iloc[: len(part)], check_exact=True)


def test_every_record_of_a_suite_has_its_own(tmp_path):
    folder = case_with(tmp_path, 'events = ["slip"]')
    (folder / "a.txt").write_text("\n".join(f"{0.3 * math.sin(0.1 * i)!r}" for i in range(200)))
    text = (folder / "case.toml").read_text()
    record = 'kind = "record"\nsuite = "a.txt"\nunits = "g"\ntime_step = "0.02 s"\n'
    head, _, rest = text.partition('kind = "ricker"')
    (folder / "case.toml").write_text(head + record + rest[rest.index("[[body]]") :])
    kept: list[Response] = []
    simulate_suite(load_case(folder), keep=lambda _n, _c, response: kept.append(response))
    write(kept[0], folder / "results")
    assert (written(folder)["spring"] == "bearings").all()
    assert len(written(folder)) > 2


def test_verify_says_that_it_lists_none(tmp_path):
    """Here a warning is an error, so that nothing is computed."""
    case = load_case(case_with(tmp_path, 'events = ["slip"]'))
    with pytest.raises(OptionWarning, match=r"\[run\]: events: no part of verify"):
        verify(case)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ('"slip"', "found 'slip'; accepted: a list of 'slip' and 'soil', each at most once"),
        ("[]", "found []; accepted: a list of 'slip' and 'soil', each at most once"),
        ("[1]", "found [1]; accepted: a list of 'slip' and 'soil', each at most once"),
        ('["reversal"]', "found ['reversal']; accepted: a list of 'slip' and 'soil', each at"),
        ('["soil", "soil"]', "found ['soil', 'soil']; accepted: a list of 'slip' and 'soil', each"),
        ('["slip"]', "found 'slip', which needs a spring of the law 'slider'; there is none"),
    ],
)
def test_wrong_words_in_a_case_are_refused_in_one_message(tmp_path, value, said, capsys):
    name = "deck-on-backfill" if "needs" in said else SLIDING
    folder = case_with(tmp_path, f"events = {value}", name)
    assert main(["run", str(folder)]) == 2
    errors = capsys.readouterr().err.strip().splitlines()
    assert len(errors) == 1
    assert f"case.toml: [run]: events: {said}" in errors[0]
    assert not (folder / "results").exists()


@pytest.mark.parametrize(
    ("events", "said"),
    [
        ("slip", "events: found 'slip'; accepted: a sequence"),
        ([1], r"events: found \[1\]; accepted: a sequence"),
        (["reversal"], r"events: found \['reversal'\]; accepted: a list of 'slip' and 'soil', eac"),
        (["slip", "slip"], r"events: found \['slip', 'slip'\]; accepted: a list of 'slip' and 's"),
        (["soil"], "events: found 'soil', which needs a spring of the law 'backfill'; there is"),
    ],
)
def test_wrong_words_from_python_are_refused_in_one_message(events, said):
    with pytest.raises(InputError, match=said) as caught:
        simulate(shaken(), duration=1.0, events=events)
    assert len(caught.value.problems) == 1


def test_what_is_asked_for_from_python_is_written(tmp_path):
    response = simulate(shaken(), duration=2.0, events=("slip",), error_estimate=False)
    write(response, tmp_path / "results")
    pd.testing.assert_frame_equal(written(tmp_path), response.spring_events, check_exact=True)
    case = load_case(case_with(tmp_path, 'events = ["slip"]'))
    write(simulate(case, events=(), error_estimate=False), tmp_path / "results")
    assert not (tmp_path / "results" / "spring_events.csv").exists()


class Silent:
    """Knows every law and tells no event of a spring."""

    name = "silent"
    summary = "for a test"
    settings: Mapping[str, str] = {}
    memories = frozenset(LawName)

    def solve(self, task: object) -> object:
        raise AssertionError


def test_a_solver_that_does_not_list_them_says_so_in_one_message():
    with pytest.raises(InputError) as caught:
        simulate(shaken(), solver=Silent(), duration=1.0, events=("slip",))
    said = "[solver]: silent does not list events of springs; accepted: cvode, ida"
    assert str(caught.value).startswith(said)


def test_a_scene_without_such_springs_has_an_empty_table():
    scene = Scene(
        (Body("deck", 1.0),), (Spring("k", (GROUND, "deck"), Linear(1.0)),), motion=Harmonic(1.0, 1)
    )
    found = simulate(scene, solver="moreau", duration=1.0, settings={"time_step": 0.01})
    assert found.spring_events.empty
