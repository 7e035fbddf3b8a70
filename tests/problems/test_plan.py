"""Decks in plan in the files of a problem, judged by what an independent program makes of them."""

import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from eventpound import score
from eventpound.problems.entrants import materialized
from eventpound.problems.files import bare_numbers, problem_json, to_json_lines
from eventpound.results.jsontext import canonical
from tests.oracle.plan_answer import joints_of, recorded
from tests.problems.league import compiled, piped
from tests.problems.test_collection import SET

DECKS = ("57", "58", "59")


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    scratch = tmp_path_factory.mktemp("decks")
    return {name: materialized(SET, SET.some([name])[0], scratch) for name in DECKS}


def test_bare_numbers_have_sections_of_plan_and_friction():
    given = json.loads(canonical(problem_json(SET, SET.some(["59"])[0])))
    lines = bare_numbers(given).decode().splitlines()
    at, last = lines.index("plan"), lines.index("friction")
    numbers = [
        [[float(word) for word in line.split()] for line in part]
        for part in (lines[at + 1 : last], lines[last + 1 :])
    ]
    assert numbers[0] == given["iota"] == [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]
    assert [row[0] for row in numbers[1]] == given["frictions"] == [0.6] * 4
    assert [list(row) for row in zip(*(r[1:] for r in numbers[1]), strict=True)] == given["W_T"]
    without = bare_numbers(json.loads(canonical(problem_json(SET, SET.some(["57"])[0]))))
    assert b"plan" in without
    assert b"friction" not in without


def test_places_are_told_in_words():
    given = problem_json(SET, SET.some(["58"])[0])
    west, east = given["places"]["contacts"][2]
    assert west.startswith("right-lower corner of west at (")
    assert east.startswith("left-lower corner of east at (")
    cosine, sine = (f"{f(math.radians(40.0)):.6g}" for f in (math.cos, math.sin))
    assert east.endswith(f"toward ({cosine}, {sine})")
    # The motion comes 20 degrees from the left of x.
    c, s = math.cos(math.radians(20.0)), math.sin(math.radians(20.0))
    assert given["iota"][:2] == [pytest.approx([c, -s]), pytest.approx([s, c])]


@pytest.fixture(scope="module")
def rows_by_scipy(folders):
    """Histories of a program that shares no code with the solvers, rows on both sides of events."""
    made = {}
    for name, folder in folders.items():
        problem, case = score.read_problem(folder), SET.some([name])[0].case()
        span = problem.given["start"], problem.given["end"]
        found = recorded(case.scene, joints_of(folder), span, problem.given["moments"], 800)
        rows = [row for t, y, _, t_1, y_1, _ in found.stretches for row in ((t, y), (t_1, y_1))]
        states = np.array([y for _, y in rows]) * np.tile(found.unit, 2)
        u, v = np.split(states, 2, axis=1)
        made[name] = problem, score.Motion(np.array([t for t, _ in rows]), u, v)
    return made


@pytest.mark.parametrize("name", DECKS)
def test_rows_of_an_independent_program_pass_the_hardest_level(rows_by_scipy, name):
    problem, history = rows_by_scipy[name]
    score.check(problem, history)
    card = score.judge(problem, history)
    assert card.levels["reference"] == ""
    assert card.impacts["matched"] == card.impacts["expected"] > 2
    assert card.energy < 1e-9
    assert {row["restitution_found"] for row in card.impact_rows} != {None}


@pytest.mark.parametrize("name", DECKS)
def test_the_energy_is_that_of_both_components(rows_by_scipy, name):
    """By one component alone, or with every coordinate pushed, energy comes from nowhere."""
    problem, history = rows_by_scipy[name]
    on_a_line = {k: v for k, v in problem.given.items() if k != "iota"}
    for given in (on_a_line, problem.given | {"motion_across": []}):
        card = score.judge(replace(problem, given=given), history)
        assert card.energy > 1e-2


def test_energy_is_looked_at_anew_where_rows_do_not_show_the_second_component(rows_by_scipy):
    """As with one of the first: a period in each step says nothing of what a program did."""
    problem, history = rows_by_scipy["57"]
    wave = [[-30.0, 2.0 * math.pi * 800.0 / problem.duration, 0.0]]
    piece = {"origin": 0.0, "sinusoids": wave, "start": 1.05, "end": 1.15}
    given = problem.given | {"motion_across": [*problem.given["motion_across"], piece]}
    assert score.judge(replace(problem, given=given), history).energy < 1e-2


def test_slips_and_sticks_may_be_listed(folders, rows_by_scipy, tmp_path):
    problem, history = rows_by_scipy["59"]
    answer = tmp_path / "mine.csv"
    names = ["t", *(f"{key}.{body}" for key in "uv" for body in problem.bodies)]
    rows = np.column_stack((history.t, history.u, history.v)).tolist()
    text = "\n".join(",".join(map(repr, row)) for row in rows)
    answer.write_text(f"# problem {problem.name}\n{','.join(names)}\n{text}\n")
    lines = [f"{e[2]!r},{e[0]},{e[1]},{e[4]!r}" for e in problem.answer["events"]]
    lines += ["0.4526,stick,east.upper,", "0.4923,slip-forward,east.upper,"]
    header = "t,kind,contact,gap_velocity_before\n"
    (tmp_path / "mine.events.csv").write_text(header + "\n".join(lines) + "\n")
    card = score.judge(problem, score.read_history(problem, answer))
    assert card.passed == "reference"
    assert card.events["rest"]["matched"] == card.events["rest"]["expected"] > 1


def test_programs_for_bodies_on_a_line_refuse_decks(folders, tmp_path):
    entrant = SET.folder / "entrants" / "scipy_events.py"
    lines = [f"{sys.executable} {entrant} {{problem}} {{out}} {{size}}"]
    if (program := compiled(tmp_path)) is not None:
        lines.append(piped(program))
    for line in lines:
        words = line.format(problem=folders["57"], out=tmp_path / "out.csv", size="1e-3")
        run = subprocess.run(["sh", "-c", words], capture_output=True, text=True, check=False)
        assert run.returncode != 0
        assert run.stderr == "error: knows bodies on a line, no decks in plan\n"


def test_the_json_is_whole():
    content = to_json_lines(problem_json(SET, SET.some(["59"])[0]))
    given = json.loads(content, parse_constant=pytest.fail)
    assert {"iota", "motion_across", "decks", "places", "W_T", "frictions"} <= set(given)
