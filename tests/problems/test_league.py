"""The league says of cards what they say, and its page what its file says."""

from __future__ import annotations

import csv

import pytest

from eventpound import score
from tests.models import DOCS
from tests.problems.league import CAUSES, best_sentence, tables
from tests.problems.test_collection import SET


def card(name, *why, seconds=1.0):
    made = score.Card.of_failure(name, "")
    made.reasons = {level: [w] if w else [] for level, w in zip(score.LEVELS, why, strict=True)}
    made.seconds = seconds
    return made


@pytest.mark.parametrize(
    ("why", "cause"),
    [
        ("of 5 impacts 2 missed, 0 extra", "impacts missed or extra"),
        ("penetrates by 1.0e-01 of the largest displacement", "overlap"),
        ("final.b.u off by 2.0e-02 of its scale", "error of a number"),
        ("an impact comes 1.0e-03 of the run off", "time of an impact"),
        ("3.0e-01 of the energy comes from nowhere", "energy"),
        ("takes more than 5 s", "time limit"),
        ("ended with 1 and said: no", "no answer"),
    ],
)
def test_every_reason_is_counted_where_it_belongs(why, cause):
    found = {"a": {p.name: [card(p.name, why, why, why)] for p in SET.some(["01", "02"])}}
    head, _, row, *_ = tables(found, SET.some(["01", "02"]))
    titles, cells = ([cell.strip() for cell in line.strip("|").split("|")] for line in (head, row))
    said = dict(zip(titles, cells, strict=True))
    assert said == {
        "program": "a", **dict.fromkeys(score.LEVELS, "0"), **dict.fromkeys(CAUSES, ""), cause: "2",
    }  # fmt: skip


def test_the_best_size_counts():
    ladder = [
        card("p", "", "off", "off"),
        card("p", "", "", "off by 1"),
        card("p", "", "", "worse"),
    ]
    assert score.best_of(ladder) is ladder[1]
    assert best_sentence(ladder) == "off by 1"
    lost = [card("p", "a", "a", "a"), card("p", "b", "b", "b")]
    assert score.best_of(lost) is lost[1]


def test_the_page_counts_what_the_file_holds():
    rows = list(csv.DictReader((DOCS / "league.csv").read_text(encoding="utf-8").splitlines()))
    page = (DOCS / "league.md").read_text(encoding="utf-8").splitlines()
    programs = list(dict.fromkeys(row["program"] for row in rows))
    problems = [problem.name for problem in SET.problems]
    assert [row["problem"] for row in rows] == [p for p in problems for _ in programs]
    levels = list(score.LEVELS)
    for program in programs:
        passed = [row["passed"] for row in rows if row["program"] == program]
        counts = [sum(p in levels[i:] for p in passed) for i in range(len(levels))]
        row = f"| {program} | {' | '.join(map(str, counts))} |"
        assert any(line.startswith(row) for line in page)
    # Each failure has its sentence.
    assert all(row["keeps_it_back"] for row in rows if row["passed"] != "reference")
