"""A run cut in two is the run in one: contacts that rest, memory, residuals."""

import json
import shutil
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from eventpound import (
    Body,
    BoucWen,
    Contact,
    ContactLaw,
    InputError,
    Linear,
    Response,
    Scene,
    Spring,
    load_case,
    simulate,
    write,
)
from eventpound.case import Case
from eventpound.solvers.base import ENDS_OF_REST, EventKind
from tests.models import CASES

STEP = 2.0**-11
"""Whole steps of this length are exact numbers, as are sums of them (s)."""


def resting(response: Response, until: float) -> set[int]:
    """Contacts that rest after all events up to a time (s)."""
    found: set[int] = set()
    for event in response.recording.events:
        if event.t <= until and event.kind is EventKind.REST:
            found.add(event.contact)
        elif event.t <= until and event.kind in ENDS_OF_REST:
            found.discard(event.contact)
    return found


def cut(case: Case, solver: str, part: float) -> tuple[Response, Response, Response]:
    """The run in one, and its two parts."""
    run, fixed = case.run, solver in ("moreau", "penalty")
    settings = {"time_step": STEP} if fixed else None
    length = round(part * run.duration / STEP) * STEP
    rest = replace(run, start_time=run.start_time + length, duration=run.duration - length)

    def made(of: Case, first: Response | None = None) -> Response:
        final = None if first is None else first.final
        return simulate(of, solver, settings=settings, error_estimate=False, start=final)

    first = made(replace(case, run=replace(run, duration=length)))
    return made(case), first, made(replace(case, run=rest), first)


@pytest.mark.parametrize("part", [0.25, 0.77])
@pytest.mark.parametrize(
    "name",
    ["bridge-el-centro", "isolated-building", "hard/chain-of-10-pressed", "hard/plastic-chain"],
)
@pytest.mark.parametrize(("solver", "off"), [("fast", 1e-10), ("cvode", 1e-6), ("ida", 1e-7)])
def test_a_run_cut_in_two_is_the_run_in_one(name, solver, off, part):
    one, first, second = cut(load_case(CASES / name), solver, part)
    at = second.task.start
    assert resting(one, at) == resting(first, at) == resting(second, at)
    kept, found = one.recording, second.recording
    assert kept.t == found.t
    for word in ("u", "v"):
        size = np.abs(getattr(kept.history, word)).max()
        # The tolerance, 1e-9, and what impacts make of it; rounding alone of steps that are whole.
        assert np.abs(getattr(kept, word) - getattr(found, word)).max() <= off * size
    assert np.abs(kept.z - found.z).max(initial=0.0) <= 1e-6


# While it yields, is unloaded, is let go before and behind its first gap.
@pytest.mark.parametrize("part", [0.1, 0.16, 0.25, 0.29, 0.323, 0.6])
@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_soil_remembers_across_the_cut_how_far_it_was_pushed_in(solver, part):
    one, first, second = cut(load_case(CASES / "deck-on-backfill"), solver, part)
    kept, found = one.recording, second.recording
    assert np.abs(kept.u - found.u).max() <= 1e-6 * np.abs(kept.history.u).max()
    assert np.abs(kept.z - found.z).max() <= 1e-6 * np.abs(kept.history.z).max()
    name = "springs.right.residual_gap"
    assert second.quantity(name) == pytest.approx(one.quantity(name), rel=1e-6)
    lost = [run.quantity("springs.right.dissipated_energy") for run in (first, second, one)]
    assert lost[0] + lost[1] == pytest.approx(lost[2], rel=1e-6)


@pytest.mark.parametrize("name", ["bridge-el-centro", "isolated-building"])
@pytest.mark.parametrize("solver", ["moreau", "penalty"])
def test_cut_after_a_whole_step_a_method_with_fixed_ones_differs_by_rounding(name, solver):
    one, _, second = cut(load_case(CASES / name), solver, 0.5)
    # Some thousand units of the last place of what is iterated, which each impact may make larger.
    assert np.abs(one.recording.u - second.recording.u).max() <= 1e-10
    assert np.abs(one.recording.z - second.recording.z).max() <= 1e-9


def test_a_state_in_which_a_method_with_fixed_steps_left_an_overlap_is_refused():
    with pytest.raises(InputError, match="accepted: a gap that is not penetrated at the start"):
        cut(load_case(CASES / "hard/plastic-chain"), "moreau", 0.25)


def test_contacts_that_rest_at_the_cut_of_a_run_rest_on():
    one, first, second = cut(load_case(CASES / "hard/chain-of-10-pressed"), "cvode", 0.25)
    at = second.task.start
    assert len(resting(first, at)) == 6
    assert {e.contact for e in second.recording.events if e.t == at} == resting(first, at)
    assert one.recording.history.t[-1] == second.recording.history.t[-1]


def scene(z: float = 0.0, law: ContactLaw | None = None, gap: float = 0.1) -> Scene:
    """A body on a yielding spring before a barrier."""
    frame = BoucWen(stiffness=50.0, strength=2.0, yield_displacement=0.01, initial_z=z)
    restitution = 0.5 if law is None else None
    return Scene(
        (Body("a", 1.0, velocity=1.0),),
        (Spring("s", ("ground", "a"), frame),),
        contacts=(Contact("c", "a", "barrier", gap=gap, restitution=restitution, law=law),),
    )


def test_a_z_beyond_its_bound_by_the_tolerance_is_at_its_bound():
    final = {"a": {"u": 0.02, "v": 0.0}, "s": {"z": 1.0 + 1e-9}}
    response = simulate(scene(), duration=0.1, start=final)
    assert response.scene.springs[0].law == replace(scene(1.0).springs[0].law)
    with pytest.raises(InputError, match=r"initial_z: found 1\.5"):
        simulate(scene(), duration=0.1, start=final | {"s": {"z": 1.5}})


STATE = {"a": {"u": 0.0, "v": 0.0}, "s": {"z": 0.0}}
CLOSED = {"a": {"u": 0.2, "v": 0.0}, "s": {"z": 0.0}}


@pytest.mark.parametrize(
    ("made", "final", "said"),
    [
        (scene(), {"a": STATE["a"]}, "start: s: found None; accepted: numbers z"),
        (scene(), STATE | {"a": {"u": 1.0}}, "start: a: found .* numbers u, v"),
        (scene(), STATE | {"s": {"z": 0.1, "u": 1.0}}, "start: s: found .* numbers z"),
        (scene(), STATE | {"a": {"u": 1.0, "v": True}}, "start: a: v: found True"),
        (scene(), STATE | {"b": {}}, "start: found a state of 'b'; accepted: states of a, s"),
        (scene(), STATE | {"a": {"u": 1.0, "v": np.nan}}, "start: a: v: found nan, not finite"),
        (scene(), CLOSED, "c.: gap: found 0.1; accepted: a gap that is not penetrated"),
        (scene(law=ContactLaw("linear", 1e4)), CLOSED, "start: found c closed, whose law"),
    ],
)
def test_states_that_nothing_can_go_on_from_are_refused(made, final, said):
    with pytest.raises(InputError, match=said):
        simulate(made, duration=1.0, start=final)


CASE = """
body = [{ name = "a", mass = 1.0, initial = { velocity = 1.0 } }]
contact = [{ name = "c", between = ["a", "barrier"], gap = 0.1, restitution = 0.5 }]
[excitation]
kind = "none"
[[spring]]
name = "s"
between = ["ground", "a"]
law = "bouc-wen"
stiffness = 50.0
strength = 2.0
yield_displacement = 0.01
[run]
duration = 1.0
"""


def test_a_case_goes_on_from_the_results_of_another(tmp_path):
    for name in ("mainshock", "aftershock"):
        (tmp_path / name).mkdir()
        more = 'start = { results = "../mainshock" }\n' if name == "aftershock" else ""
        (tmp_path / name / "case.toml").write_text(CASE + more)
    with pytest.raises(InputError, match=r"\[run\]: start.results: found .*a summary.json"):
        load_case(tmp_path / "aftershock")
    mainshock = simulate(load_case(tmp_path / "mainshock"))
    results = tmp_path / "mainshock" / "results"
    write(mainshock, results)
    aftershock = load_case(tmp_path / "aftershock")
    body, law = aftershock.scene.bodies[0], aftershock.scene.springs[0].law
    assert {"u": body.displacement, "v": body.velocity} == mainshock.final["a"]
    assert law.initial_z == mainshock.final["s"]["z"]
    in_python = simulate(load_case(tmp_path / "mainshock"), start=mainshock.final)
    assert simulate(aftershock).final == in_python.final
    summary = json.loads((results / "summary.json").read_text())
    (results / "summary.json").write_text(json.dumps(summary | {"success": False}))
    with pytest.raises(InputError, match="a run that did not reach its end"):
        load_case(tmp_path / "aftershock")
    (results / "summary.json").write_text(json.dumps(summary | {"final": 3}))
    with pytest.raises(InputError, match=r"found .*a summary.json"):
        load_case(tmp_path / "aftershock")
    shutil.rmtree(results)


def test_a_case_goes_on_where_a_wall_stands_that_has_passed_the_place_of_the_body(tmp_path):
    case = """excitation = {{ kind = "none" }}
[[body]]
name = "a"
mass = 1.0
[[support]]
name = "wall"
excitation = {{ kind = "sine", amplitude = 1.0, period = 1.0, reverse = true }}
[[contact]]
between = ["a", "wall"]
gap = 0.05
restitution = 0.5
[run]
duration = {0}
{1}
"""
    for name, length, more in (
        ("one", 1.5, ""),
        ("first", 0.9, ""),
        ("second", 0.6, 'start_time = 0.9\nstart = { results = "../first" }'),
    ):
        (tmp_path / name).mkdir()
        (tmp_path / name / "case.toml").write_text(case.format(length, more))
        write(simulate(load_case(tmp_path / name)), tmp_path / name / "results")
    ends = [
        json.loads((tmp_path / name / "results" / "summary.json").read_text())["final"]["a"]
        for name in ("one", "second")
    ]
    # At 0.9 s the wall has gone through the gap, and through the place of a body that stood still.
    assert ends[0]["u"] < -0.1
    assert ends[1] == pytest.approx(ends[0], rel=1e-8)


def test_a_state_may_have_numbers_of_numpy_and_units():
    final: Any = {"a": {"u": np.float32(0.5), "v": "10 cm/s"}, "s": {"z": np.int64(0)}}
    first = simulate(scene(gap=1.0), duration=0.1, start=final).history.iloc[0]
    assert [first["u.a"], first["v.a"], first["z.s"]] == [0.5, 0.1, 0.0]


def test_without_a_memory_there_is_nothing_but_the_motion():
    linear = replace(scene(), springs=(Spring("s", ("ground", "a"), Linear(50.0)),))
    first = simulate(linear, duration=0.05)
    assert set(first.final) == {"a"}
    assert simulate(linear, duration=0.05, start=first.final).task.scene.bodies[0].velocity < 1.0
