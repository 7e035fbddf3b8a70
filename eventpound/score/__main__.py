"""Judge a program's history by the certified answer of a problem: NumPy and nothing else.

    python score.py PROBLEM ANSWER.csv [--json FILE] [--html FILE]

PROBLEM is a directory with ``problem.json`` and ``answer.json``. ANSWER begins with the line
``# problem NAME``; then a line of column names, ``t`` and ``u.<body>``, if known ``v.<body>``
and ``z.<spring>``; then rows from the start to the end of the run, one of them at each of the
stated moments. Two rows of one time are the state before and after a jump. Impacts are read off
the velocities, unless ``ANSWER.events.csv`` lists them (``t``, ``contact``; perhaps ``kind``,
``gap_velocity_before``). Kinds are impact, rest, detachment, separation and accumulation; who
knows kinds that may not occur says so in a first line ``# kinds impact, rest, detachment``.
Extremes are those of the cubics through u and v of the rows.

Judged are, each in parts of its scale,

    peaks       largest and smallest displacement of every body
    final       u, v and z at the end
    history     u at the stated moments
    impacts     their times; missed and extra ones
    events      the same of rests, of their ends and of accumulations, for programs that list them
    penetration the deepest overlap of a contact
    energy      whether any appears from nowhere, seen from the rows

A level is passed where every error is within level * scale + floor, the floor being the bound of
the answer and what rounding does to a well-made program in double precision, and where no
impact is missed or extra; what is found of other events decides no level. Exit code 0 where the
answer was judged, 2 where it cannot be.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from eventpound.score.answer import read_history
from eventpound.score.card import card_text, judge
from eventpound.score.levels import ScoreError
from eventpound.score.page import card_page
from eventpound.score.problem import read_problem


def main(arguments: list[str] | None = None) -> int:
    """Judge the answer that the command line names."""
    head, _, rest = str(__doc__).partition("\n\n")
    parser = argparse.ArgumentParser(
        description=head, epilog=rest, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", metavar="PROBLEM", type=Path)
    parser.add_argument("answer", metavar="ANSWER.csv", type=Path)
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the card as JSON")
    parser.add_argument("--html", metavar="FILE", type=Path, help="write the card as a page")
    options = parser.parse_args(arguments)
    try:
        problem = read_problem(options.problem)
        history = read_history(problem, options.answer)
    except ScoreError as error:
        print(f"score: {error}", file=sys.stderr)
        return 2
    card = judge(problem, history)
    if options.json:
        options.json.write_text(json.dumps(card.as_dict(), indent=1) + "\n", encoding="utf-8")
    if options.html:
        options.html.write_text(card_page(problem, history, card), encoding="utf-8")
    print(card_text(card), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
