"""The league says of cards what they say, and its page what its file says."""

import csv

from eventpound import score
from tests.models import DOCS
from tests.problems.test_collection import SET


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
