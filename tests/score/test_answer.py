"""What is wrong with an answer is found, and an answer that cannot be judged is refused."""

import ast
import json
import subprocess
import sys

import numpy as np
import pytest

from eventpound import score
from eventpound.cli import main
from eventpound.contact.event import EventKind
from eventpound.problems.collection import read_collection
from eventpound.problems.files import problem_json, score_file
from eventpound.results.jsontext import canonical
from eventpound.score.levels import EVENTS, UNIT_OF_TIME, UNJUDGED
from tests.models import CASES

SET = read_collection(CASES / "problems")
HIT = "19-graze-hit-1e-03"


def test_every_kind_that_a_history_lists_is_known():
    """The yardstick stands alone, so it tells them again."""
    kinds = ["impact", *(kind for words in EVENTS.values() for kind in words), *UNJUDGED]
    assert sorted(kinds) == sorted(kind.value for kind in EventKind)


def exact(problem, late=0.0, restitution=0.5, rows=81):
    """u = -cos t until the wall at 0.999 (or later), u = A cos(t - t_0 + p) after it."""
    struck = np.pi - np.arccos(0.999) + late
    t = np.sort(
        np.concatenate((np.linspace(0.0, 4.0, rows), problem.given["moments"], [struck] * 2))
    )
    t[np.abs(t - struck) < 1e-12] = struck
    after = np.zeros(t.size, dtype=bool)
    after[np.flatnonzero(t == struck)[-1] :] = True
    u, v = -np.cos(t), np.sin(t)
    u_0, v_0 = -np.cos(struck), -restitution * np.sin(struck)
    s = t - struck
    u[after] = (u_0 * np.cos(s) + v_0 * np.sin(s))[after]
    v[after] = (v_0 * np.cos(s) - u_0 * np.sin(s))[after]
    return t, u, v


def judged(problem, t, u, v, **more):
    history = score.Motion(t, u[:, None], v[:, None], **more)
    score.check(problem, history)
    return score.judge(problem, history)


def test_the_exact_answer_passes_everything(problem):
    card = judged(problem, *exact(problem))
    assert card.passed == "reference"
    assert card.impacts["matched"] == 1
    assert card.penetration < 1e-15
    assert card.energy < 1e-14
    assert min(card.digits.values()) > 12
    assert card.not_judged == []


@pytest.mark.parametrize(("by", "level"), [(1e-3, "engineering"), (1e-5, "research"), (3e-2, None)])
def test_an_error_costs_its_levels(problem, by, level):
    t, u, v = exact(problem)
    since = np.maximum(t - 3.096867566421062, 0.0) / (4.0 - 3.096867566421062)
    card = judged(problem, t, u + by * since**2, v)
    assert card.passed == level
    assert card.fewest == pytest.approx(-np.log10(by), abs=0.1)
    assert "off by" in card.levels["reference"]


def test_an_impact_too_late_penetrates(problem):
    card = judged(problem, *exact(problem, late=1e-3))
    assert card.passed == "engineering"
    assert "penetrates" in card.levels["reference"]
    deepest = -np.cos(np.pi - np.arccos(0.999) + 1e-3) - 0.999
    assert card.penetration == pytest.approx(deepest, rel=1e-9)
    assert card.impacts["largest_shift"] * UNIT_OF_TIME * 4.0 == pytest.approx(1e-3, rel=1e-6)


def test_a_missed_impact_and_one_too_many_are_counted(problem):
    card = judged(problem, *exact(problem), reported={"impact"})
    assert card.impacts == {
        "expected": 1, "matched": 0, "missed": 1, "extra": 0, "largest_shift": None,
    }  # fmt: skip
    assert card.reasons["engineering"] == ["of 1 impacts 1 missed, 0 extra"]
    twice = [score.Event("impact", t, 0, -0.0447) for t in (3.09686, 3.5)]
    t, u, v = exact(problem)
    card = judged(problem, t, u, v, events=twice, reported={"impact"})
    assert (card.impacts["missed"], card.impacts["extra"]) == (0, 1)


def test_energy_from_nowhere_is_seen(problem):
    card = judged(problem, *exact(problem, restitution=4.0))
    created = 15.0 * (1.0 - 0.999**2)
    assert card.energy == pytest.approx(created / (1.0 + created), rel=1e-9)


def test_a_history_too_coarse_for_peaks_says_what_is_judged():
    problem = SET.some(["26"])[0]
    known = score.Problem(json.loads(canonical(problem_json(SET, problem))), problem.answer())
    rows = {row[0]: row[1] for row in known.answer["quantities"]}
    t = np.array([0.0, *known.given["moments"], 1.0])
    u = np.array([0.0, *(rows[f"history.{k}.b"] for k in range(39)), rows["final.b.u"]])
    fine = score.judge(known, score.Motion(t, u[:, None]))
    assert not any(what.startswith("peaks") for what in fine.not_judged)
    # At every second moment there is nothing: as if the program had hardly any rows.
    stated = {**known.given, "moments": known.given["moments"][9::10]}
    few = np.isin(t, [0.0, *stated["moments"], 1.0])
    answer = {**known.answer, "quantities": [
        row for row in known.answer["quantities"] if not row[0].startswith("history")
    ]}  # fmt: skip
    coarse = score.judge(score.Problem(stated, answer), score.Motion(t[few], u[few, None]))
    assert coarse.digits["peaks"] is None
    assert coarse.digits["final"] > 8
    assert "too far apart to tell them; judged are the final values" in coarse.not_judged[0]
    assert coarse.passed is None


def write(path, name, rows, columns="t,u.b,v.b"):
    lines = [f"# problem {name}", columns]
    lines += [",".join(repr(float(x)) for x in row) for row in rows]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_the_command_judges_a_file(problem, tmp_path, capsys):
    answer = write(tmp_path / "mine.csv", HIT, zip(*exact(problem), strict=True))
    page, card = tmp_path / "card.html", tmp_path / "card.json"
    words = [str(SET.folder / HIT), str(answer), "--html", str(page), "--json", str(card)]
    assert main(["problems", "score", *words]) == 0
    assert "passed         reference" in capsys.readouterr().out
    assert json.loads(card.read_text())["passed"] == "reference"
    text = page.read_text()
    assert text.count("<svg") == 3
    assert "http" not in text.replace('xmlns="http://www.w3.org/2000/svg"', "")
    assert "<script" not in text


def test_events_beside_an_answer_are_believed(problem, folder, tmp_path):
    answer = write(tmp_path / "mine.csv", HIT, zip(*exact(problem), strict=True))
    (tmp_path / "mine.events.csv").write_text("t,contact\n3.0968608,wall\n3.3,wall\n")
    card = score.judge(problem, score.read_history(problem, answer))
    assert card.impacts["extra"] == 1
    (tmp_path / "mine.events.csv").write_text("t,contact\n1.0,door\n")
    with pytest.raises(score.ScoreError, match="'door' is not known; accepted: wall"):
        score.read_history(problem, answer)


def listed(problem, *left_out, shift=0.0):
    """The certified events as a program would list them, later by a shift (s)."""
    return [
        score.Event(kind, t + shift, problem.given["contacts"].index(contact), before)
        for kind, contact, t, _, before, _ in problem.answer["events"]
        if kind != "impact" and kind not in left_out
    ]


def events_found(problem, events, reported=frozenset(score.EVENTS)):
    t = np.array([problem.given["start"], *problem.given["moments"], problem.given["end"]])
    u = np.zeros((t.size, 1))
    return score.judge(problem, score.Motion(t, u, events=events, reported=reported))


def test_rests_their_ends_and_accumulations_are_judged(resting):
    card = events_found(resting, listed(resting, shift=6e-3))
    for kind in score.EVENTS:
        found = card.events[kind]
        assert [found[key] for key in ("expected", "matched", "missed", "extra")] == [1, 1, 0, 0]
        # 6 ms of 60 s, in twentieths of the run.
        assert found["largest_shift"] == pytest.approx(6e-3 / 3.0, rel=1e-6)
    assert "rests          1 expected, 1 matched, 0 missed, 0 extra, 2.7 digits" in (
        score.card_text(card)
    )


@pytest.mark.parametrize("kind", score.EVENTS)
def test_an_event_that_is_not_found_is_missed_and_one_too_many_extra(resting, kind):
    card = events_found(resting, listed(resting, kind))
    assert (card.events[kind]["missed"], card.events[kind]["extra"]) == (1, 0)
    more = [score.Event("rest", 1.0, 0), score.Event("separation", 1.0015, 0)]
    late = [score.Event("accumulation", 50.0, 0, -1e-3), score.Event("rest", 50.0, 0)]
    late.append(score.Event("separation", 51.0, 0))
    card = events_found(resting, [*more, *listed(resting), *late])
    # Half a thousandth of a twentieth of the run is too short to count; a second is not.
    assert (card.events[kind]["matched"], card.events[kind]["extra"]) == (1, 1)


def test_soft_impacts_gathered_at_a_resting_contact_are_no_accumulation(resting):
    soft = score.Event("accumulation", 50.0, 0, 0.0)
    card = events_found(resting, [*listed(resting), soft])
    assert card.events["accumulation"]["extra"] == 0


@pytest.mark.parametrize(
    ("text", "reported", "kinds"),
    [
        ("t,contact\n", [], []),
        ("t,contact,kind\n1.0,c0,rest\n2.0,c0,separation\n", ["rest", "detachment"],
         ["rest", "separation"]),
        ("# kinds rest, accumulation\nt,contact,kind\n", ["rest", "accumulation"], []),
    ],
)  # fmt: skip
def test_a_list_says_which_kinds_it_would_hold(resting, tmp_path, text, reported, kinds):
    t = [resting.given["start"], *resting.given["moments"], resting.given["end"]]
    start = resting.given["initial"]["u"][0]
    rows = ((time, start, 0.0) for time in t)
    answer = write(tmp_path / "mine.csv", resting.name, rows, "t,u.b0,v.b0")
    (tmp_path / "mine.events.csv").write_text(text)
    history = score.read_history(resting, answer)
    assert history.reported == {"impact", *reported}
    assert [event.kind for event in history.events] == kinds
    for wrong in ("# kinds bump\nt,contact\n", "t,contact,kind\n1.0,c0,bump\n"):
        (tmp_path / "mine.events.csv").write_text(wrong)
        with pytest.raises(score.ScoreError, match="'bump' is not known; accepted: impact, rest"):
            score.read_history(resting, answer)


def test_a_rest_ends_by_a_separation_too(tmp_path):
    """Where an impulse elsewhere opens the contact; moreau calls every end a detachment."""
    out = tmp_path / "cards.json"
    words = ["problems", "score", str(SET.folder / "55-struck-away"), "--json", str(out)]
    assert main([*words, "--solver", "cvode", "--solver", "moreau"]) == 0
    for by in json.loads(out.read_text()).values():
        ends = by["55-struck-away"][-1]["events"]["detachment"]
        assert [ends[key] for key in ("expected", "matched", "missed", "extra")] == [2, 2, 0, 0]
        assert ends["largest_shift"] < 1e-3


def wrong_answers(problem):
    t, u, v = exact(problem)
    rows = list(zip(t, u, v, strict=True))
    with_nan = [*rows[:5], (rows[5][0], np.nan, 0.0), *rows[6:]]
    few = [row for i, row in enumerate(rows) if i % 7 == 0 or i == len(rows) - 1]
    return {
        "other problem": ("20-graze-hit-1e-06", rows, {}, "is the answer to problem 20-"),
        "wrong column": (HIT, rows, {"columns": "t,x,v.b"}, "no column u.b; found t, x"),
        "unknown column": (HIT, rows, {"columns": "t,u.b,w.b"}, "unknown column w.b"),
        "column twice": (HIT, rows, {"columns": "t,u.b,u.b"}, "column u.b is there more than once"),
        "nan": (HIT, with_nan, {}, "row 6, column u.b: found 'nan'"),
        "missing times": (HIT, few, {}, "no row at t = 0.1 s and"),
        "too short": (HIT, rows[:-1], {}, "asked for: 0 to 4 s"),
        "backwards": (HIT, [*rows[:3], rows[1], *rows[3:]], {}, "t goes back"),
        "starts elsewhere": (HIT, [(a, b + 0.5, c) for a, b, c in rows], {}, "begins at -0.5"),
        "no rows": (HIT, [], {}, "has no rows"),
    }


WRONG = (
    "other problem", "wrong column", "unknown column", "nan", "missing times", "too short",
    "backwards", "starts elsewhere", "no rows", "column twice",
)  # fmt: skip


@pytest.mark.parametrize("what", WRONG)
def test_an_answer_that_cannot_be_judged_is_one_message(problem, folder, tmp_path, capsys, what):
    name, rows, more, says = wrong_answers(problem)[what]
    answer = write(tmp_path / "mine.csv", name, rows, **more)
    assert main(["problems", "score", str(SET.folder / HIT), str(answer)]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    alone = subprocess.run(
        [sys.executable, "-m", "eventpound.score", folder, answer],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (alone.returncode, alone.stdout) == (2, "")
    assert says in alone.stderr


def test_the_file_needs_numpy_only():
    tree = ast.parse(score_file())
    defined = [node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    assert len(defined) == len(set(defined))
    assert "judge" in defined
    imported = {
        name.split(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in (
            [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in node.names]
        )
    }
    assert imported - set(sys.stdlib_module_names) == {"numpy"}
