r"""Judge an answer or a program by problems with certified answers.

Judge an answer to a problem with a certified answer, or run a program on a problem or on a
whole set and judge what it says: digits of every number, impacts missed and extra, penetration,
energy, time, and the hardest level passed.

PROBLEM is a directory of a set as it lies in cases/problems or comes out of its archive, or the
set. In --run, {problem} becomes a directory with problem.json, problem.txt and motion.csv, {out}
the file to write, {size} a step in parts of the run. What an answer is and how it is judged:
the page "problems" of the documentation; without eventpound the file score.py of the archive
does it.

Examples
--------
  eventpound problems score cases/problems/01-elastic-cosine my-answer.csv --html card.html
  eventpound problems score cases/problems --solver fast
  eventpound problems score cases/problems --solver moreau:theta=1 --html table.html
  eventpound problems score cases/problems/07-bilinear-ricker \
      --run "octave my_stepper.m {problem} {out} {size}"
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, Options, add_command, comma_list, seconds, tolerance
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.problems.collection import Collection, ProblemFolder
    from eventpound.problems.entrants import Entrant
    from eventpound.score.card import Card


def add_score(commands: Commands) -> None:
    """Add the command to the parser."""
    score = add_command(commands, "problems score", _score, __doc__)
    score.add_argument("problem", metavar="PROBLEM", type=Path, help="a problem, or a set")
    score.add_argument("answer", metavar="ANSWER.csv", type=Path, nargs="?", help="what to judge")
    solver = "run a solver, or several; its settings follow its name"
    score.option("--solver NAME[:KEY=VALUE]", solver, action="append", default=[])
    program = "run a program, or several, under a name or that of its file"
    score.option("--run [NAME=]COMMAND", program, action="append", default=[])
    sizes = "tolerances (1e-4,1e-7,1e-10,1e-12) or steps in parts of the run (1e-3,1e-4,1e-5)"
    score.option("--sizes X,Y,...", sizes, comma_list(tolerance), default=[])
    score.option("--limit SECONDS", "processor time a run may take (10)", seconds, default=10.0)
    score.option("--json FILE", "write the cards as JSON", Path)
    score.option("--html FILE", "write them as a page", Path)


def _score(options: Options) -> int:
    if bool(options.answer) == bool(options.solver or options.run):
        raise InputError("score: give either ANSWER.csv or programs (--solver, --run)")
    if options.answer:
        options.refuse(["--sizes", "--limit"], "is for programs, not for an answer")
    from eventpound.problems.collection import INDEX, read_collection

    if (options.problem / INDEX).is_file():
        collection = read_collection(options.problem)
        chosen = collection.problems
    else:
        folder = options.problem.resolve()
        collection = read_collection(folder.parent)
        chosen = collection.some([folder.name])
    if options.answer:
        if len(chosen) > 1:
            raise InputError(f"{options.problem}: is a set; an answer is to one problem of it")
        return _judge(collection, chosen[0], options)
    return _run(collection, chosen, options)


def _judge(collection: Collection, problem: ProblemFolder, options: Options) -> int:
    from tempfile import TemporaryDirectory

    from eventpound import score
    from eventpound.problems.entrants import materialized

    with TemporaryDirectory(prefix="problem-") as scratch:
        folder = materialized(collection, problem, Path(scratch))
        try:
            known = score.read_problem(folder)
            history = score.read_history(known, options.answer)
        except score.ScoreError as error:
            raise InputError(str(error)) from error
    card = score.judge(known, history)
    page = score.card_page(known, history, card) if options.html else ""
    _write(options, card.as_dict(), page)
    print(score.card_text(card), end="")
    return 0


def _run(collection: Collection, chosen: tuple[ProblemFolder, ...], options: Options) -> int:
    from eventpound import score
    from eventpound.problems.entrants import cards_of

    entrants = _entrants(options)
    found: dict[str, dict[str, list[Card]]] = {entrant.label: {} for entrant in entrants}
    for problem in chosen:
        for label, cards in cards_of(collection, problem, entrants, options.limit).items():
            found[label][problem.name] = cards
            best = score.best_of(cards)
            said = best.passed or f"none: {best.levels['engineering']}"
            print(f"{problem.name:<28} {label:<20} {said}", flush=True)
            if len(chosen) == 1:
                print(score.ladder_text(cards))
    for label, cards_by_problem in found.items():
        print(f"{label}: {score.count_text(list(cards_by_problem.values()))}")
    as_json = {
        label: {name: [card.as_dict() for card in cards] for name, cards in by_problem.items()}
        for label, by_problem in found.items()
    }
    title = f"{collection.name} {collection.version}"
    _write(options, as_json, score.set_page(title, found, options.limit))
    return 0


def _entrants(options: Options) -> list[Entrant]:
    """Programs asked for, called by their words."""
    from eventpound.case.solver_options import solver_word
    from eventpound.problems.entrants import Entrant

    solvers = []
    for word in options.solver:
        name, settings = solver_word(word, "--solver", {"time_step": "--sizes"})
        solvers.append(Entrant(word, solver=name, settings=settings, sizes=options.sizes))
    runs = []
    for word in options.run:
        named = re.fullmatch(r"([\w.+-]+)=(.*)", word)
        label, command = named.groups() if named else (word.split()[0] if word else "", word)
        if "{problem}" not in command or "{out}" not in command:
            raise InputError(f"--run: {command!r}: {{problem}} and {{out}} must stand in it")
        runs.append(Entrant(label, command=command, sizes=options.sizes))
    return solvers + runs


def _write(options: Options, content: object, page: str) -> None:
    """Write what was asked for."""
    from eventpound.results import write_together

    for path, text in ((options.json, json.dumps(content, indent=1) + "\n"), (options.html, page)):
        if path is not None:
            write_together(path.parent, {path.name: text.encode()})
            print(f"wrote {path}", file=sys.stderr)
