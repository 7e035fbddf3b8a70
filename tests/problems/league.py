"""``python -m tests.problems.league [--out DIRECTORY]``: every program on every problem.

Runs our solvers, SciPy, a C program, and Octave and Siconos where they are found, with at most
`LIMIT` s a run and `JOBS` problems at a time, and prints the tables of docs/league.md. With
``--out`` it writes league.csv (a row a program and problem, with what keeps it back), league.html
and league.json as well; with ``--speed`` it prints error and time of every run. Programs that are
not there are named and left out.
"""

import argparse
import csv
import json
import re
import resource
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from eventpound import score
from eventpound.problems.collection import Collection, ProblemFolder, read_collection
from eventpound.problems.entrants import Entrant, cards_of
from eventpound.score.page import solved
from eventpound.solvers import available
from tests.models import CASES

SET = CASES / "problems"
LIMIT, JOBS = 5.0, 2
CONTACT_STEPS = 20
"""Steps that a contact element lasts, where that is stiffer than its default."""
WORDS = {None: "–", "engineering": "2", "research": "4", "reference": "8"}
CAUSES = {
    "impacts missed or extra": r"of \d+ impacts",
    "overlap": r"penetrates",
    "error of a number": r"off by",
    "time of an impact": r"an impact comes",
    "energy": r"of the energy",
    "time limit": r"takes more than",
    "no answer": r"",
}
"""Why a level is not passed, by the words of the card; the first that fits."""
Found = dict[str, dict[str, list[score.Card]]]


def entrants(scratch: Path) -> tuple[list[Entrant], list[str]]:
    """Programs that can be run here, and those that cannot with the reason."""
    ours = [
        Entrant("fast", solver="fast"),
        Entrant("cvode", solver="cvode"),
        Entrant("ida", solver="ida", sizes=(1e-4, 1e-7, 1e-10)),
        Entrant("moreau", solver="moreau"),
    ]
    ours += [
        Entrant("kelvin-voigt", solver="penalty", settings={"contact_steps": CONTACT_STEPS}),
        Entrant("kv-default", solver="penalty"),
    ]
    missing = []
    if "opensees" in available():
        ours.append(Entrant("opensees", solver="opensees", sizes=(1e-3, 1e-4)))
    else:
        missing.append("OpenSeesPy: not installed, or it cannot be imported")
    folder = SET / "entrants"
    tolerances = (1e-4, 1e-7, 1e-10)
    python, siconos = sys.executable, _siconos()
    ours.append(_run("scipy", f"{python} {folder / 'scipy_events.py'}", tolerances))
    program = compiled(scratch)
    if program is None:
        missing.append("central_difference.c: there is no C compiler")
    else:
        ours.append(Entrant("c", command=f"sh -c '{piped(program)}'"))
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        missing.append("rk4_events.m: there is no Octave")
    else:
        ours.append(_run("octave", f"{octave} {folder / 'rk4_events.m'}", (1e-3, 1e-4)))
    if siconos is None:
        missing.append("siconos_moreau.py: no Python that has siconos")
    else:
        ours.append(_run("siconos", f"{siconos} {folder / 'siconos_moreau.py'}", (1e-3, 1e-4)))
    return ours, missing


def _run(label: str, program: str, sizes: tuple[float, ...]) -> Entrant:
    return Entrant(label, command=f"{program} {{problem}} {{out}} {{size}}", sizes=sizes)


def compiled(scratch: Path) -> Path | None:
    """The C program; None without a compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        return None
    made = scratch / "central_difference"
    source = SET / "entrants" / "central_difference.c"
    subprocess.run([compiler, "-O2", "-o", made, source, "-lm"], check=True)
    return made


def piped(program: Path) -> str:
    """The line of a shell that runs the C program, with the places of an entrant's command."""
    return f"cat {{problem}}/problem.txt {{problem}}/motion.csv | {program} {{size}} > {{out}}"


def _siconos() -> str | None:
    """A Python with siconos."""
    for python in (sys.executable, "/usr/bin/python3"):
        words = [python, "-c", "import siconos.kernel"]
        if Path(python).exists() and not subprocess.run(words, capture_output=True).returncode:
            return python
    return None


def best_sentence(cards: list[score.Card]) -> str:
    """What keeps a program from the next level, at its best size; empty where nothing does."""
    return next((why for why in score.best_of(cards).levels.values() if why), "")


def tables(found: Found, problems: tuple[ProblemFolder, ...]) -> Iterator[str]:
    """The tables of docs/league.md."""
    yield "| program | " + " | ".join([*score.LEVELS, *CAUSES]) + " |"
    yield "| --- " * (1 + len(score.LEVELS) + len(CAUSES)) + "|"
    for label, by_problem in found.items():
        best = [score.best_of(cards) for cards in by_problem.values()]
        counts = [str(count) for count in solved(by_problem.values()).values()]
        causes = Counter(_cause(b.levels["engineering"]) for b in best if not b.passed)
        cells = [str(causes[cause] or "") for cause in CAUSES]
        yield f"| {label} | " + " | ".join(counts + cells) + " |"
    yield ""
    yield "| problem | " + " | ".join(found) + " |"
    yield "| --- " * (1 + len(found)) + "|"
    for problem in problems:
        cells = [WORDS[score.best_of(by[problem.name]).passed] for by in found.values()]
        yield f"| {problem.name} | " + " | ".join(cells) + " |"


def event_table(found: Found) -> Iterator[str]:
    """Events beside impacts over all problems, at the best sizes: matched, missed, extra."""
    yield "| program | " + " | ".join(f"{kind}s" for kind in score.EVENTS) + " |"
    yield "| --- " * (1 + len(score.EVENTS)) + "|"
    for label, by_problem in found.items():
        best = [score.best_of(cards) for cards in by_problem.values()]
        cells = []
        for kind in score.EVENTS:
            said = [
                c.events[kind] for c in best if c.events.get(kind, {}).get("matched") is not None
            ]
            counts = [sum(s[key] for s in said) for key in ("matched", "missed", "extra")]
            cells.append(" / ".join(map(str, counts)) if said else "not reported")
        yield f"| {label} | " + " | ".join(cells) + " |"


def speeds(found: Found) -> Iterator[str]:
    """Of each problem and program the largest error and the time (ms) of every size."""
    yield "| problem | program | error (processor time, ms), from coarse to fine |"
    yield "| --- | --- | --- |"
    for name in next(iter(found.values())):
        for label, by_problem in found.items():
            cells = [
                f"{max(errors):.1e} ({1e3 * card.seconds:.3g})"
                for card in by_problem[name]
                if (errors := [q.error for q in card.deviations if ".t_" not in q.quantity.name])
                and card.seconds
            ]
            if cells:
                yield f"| {name} | {label} | {', '.join(cells)} |"


def _cause(why: str) -> str:
    return next(cause for cause, words in CAUSES.items() if re.search(words, why))


def _solve(
    problem: ProblemFolder, collection: Collection, programs: list[Entrant]
) -> dict[str, list[score.Card]]:
    return cards_of(collection, problem, programs, LIMIT)


def write(out: Path, found: Found, title: str) -> None:
    """The table in full, as CSV, as JSON and as a page."""
    out.mkdir(parents=True, exist_ok=True)
    with (out / "league.csv").open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["problem", "program", "passed", "size", "fewest_digits", "keeps_it_back"])
        for name in next(iter(found.values())):
            for label, by_problem in found.items():
                best = score.best_of(by_problem[name])
                why = best_sentence(by_problem[name])
                rows.writerow([name, label, best.passed or "", best.size, best.fewest, why])
    cards = {
        label: {name: [card.as_dict() for card in cards] for name, cards in by_problem.items()}
        for label, by_problem in found.items()
    }
    (out / "league.json").write_text(json.dumps(cards), encoding="utf-8")
    (out / "league.html").write_text(score.set_page(title, found, LIMIT), encoding="utf-8")


def main() -> None:
    """Run everything and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.problems.league", description=__doc__)
    parser.add_argument("--out", metavar="DIRECTORY", type=Path, help="write all of it, too")
    parser.add_argument("--speed", action="store_true", help="print errors and times, too")
    parser.add_argument("names", metavar="NAME", nargs="*", help="problems (all)")
    options = parser.parse_args()
    collection = read_collection(SET)
    problems = collection.some(options.names)
    began = time.monotonic()
    with TemporaryDirectory(prefix="league-") as scratch:
        programs, missing = entrants(Path(scratch))
        found: Found = {program.label: {} for program in programs}
        with ProcessPoolExecutor(JOBS) as pool:
            solve = partial(_solve, collection=collection, programs=programs)
            for problem, cards in zip(problems, pool.map(solve, problems), strict=True):
                print(f"{time.monotonic() - began:6.0f} s  {problem.name}", file=sys.stderr)
                for label, ladder in cards.items():
                    found[label][problem.name] = ladder
    print("\n".join(tables(found, problems)))
    print()
    print("\n".join(event_table(found)))
    if options.speed:
        print("\n".join(("", *speeds(found))))
    print("\n".join(f"Left out: {what}." for what in missing))
    used = sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    print(
        f"{time.monotonic() - began:.0f} s, {used:.0f} s of processor time in {JOBS} processes; "
        f"a run may take {LIMIT:g} s."
    )
    if options.out:
        write(options.out, found, f"{collection.name} {collection.version}")


if __name__ == "__main__":
    main()
