"""``python -m tests.oracle.problems [NAME ...]``: the problem set held against the oracle.

Compares every number of every ``answer.json`` of ``cases/problems`` with the oracle's, within
both bounds, that of decks in plan by the program of `tests.oracle.plan`, and writes into it what
came of that: how many were compared (`checked`), how many
of them agree, of how many the oracle itself is not sure to a tenth of the bound (`unsure`), or
why it gives no answer (`silent`). Exit code 1 where a number does not agree.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from typing import Any

from eventpound.problems.collection import ANSWER, ProblemFolder, read_collection
from eventpound.problems.files import to_json_lines
from eventpound.results.jsontext import read_json
from eventpound.scene import Scene
from tests.models import CASES
from tests.oracle.certificates import NEAR, SAME, SURE
from tests.oracle.plan_answer import ask_plan, joints_of
from tests.oracle.program import Answer, NoAnswerError, Number, ask

SET = CASES / "problems"


def compare(problem: ProblemFolder, answer: dict[str, Any]) -> dict[str, object]:
    """What the oracle says of an answer."""
    case = problem.case()
    start, end = case.run.start_time, case.run.start_time + case.run.duration
    try:
        if case.scene.decks:
            told = ask_plan(case.scene, joints_of(problem.folder), (start, end), answer["moments"])
        else:
            told = ask(case.scene, start, end, moments=answer["moments"])
    except NoAnswerError as reason:
        return {"checked": 0, "agree": 0, "unsure": 0, "silent": str(reason), "differ": []}
    counts: Counter[str] = Counter()
    differ = []
    for name, value, bound, true in _pairs(case.scene, answer, told, end - start):
        if true.uncertainty > SURE * bound:
            counts["unsure"] += 1
            continue
        agrees = true.distance(value) <= bound + true.uncertainty
        counts.update(checked=1, agree=int(agrees))
        if not agrees:
            differ.append(name)
    found = {key: counts[key] for key in ("checked", "agree", "unsure")}
    program = {"program": "tests/oracle/plan.py"} if case.scene.decks else {}
    return found | {"silent": "", "differ": differ} | program


def _pairs(
    scene: Scene, answer: dict[str, Any], told: Answer, duration: float
) -> Iterator[tuple[str, float, float, Number]]:
    for name, value, bound, *_ in answer["quantities"]:
        if name in told.values:
            yield name, value, bound, told.values[name]
    names = [contact.name for contact in scene.contacts]
    for kind, contact, t, bound, before, _ in answer["events"]:
        near = [
            event
            for event in told.events
            if (event.kind, names[event.contact]) == (kind, contact)
            and abs(event.t - t) <= NEAR * duration
            and (kind != "impact"
                 or abs(float(event.numbers["before"].value) - before) <= SAME * abs(before))
        ]  # fmt: skip
        # Several at the end of a cascade: nobody knows which one it is.
        if bound is not None and len(near) == 1:
            yield f"{kind} {contact} {t}", t, bound, near[0].numbers["t"]


def main(names: list[str]) -> int:
    """Compare problems and write what came of it; 1 where numbers differ."""
    wrong = 0
    for problem in read_collection(SET).some(names):
        answer = read_json(problem.folder / ANSWER)
        answer["independent"] = found = compare(problem, answer)
        (problem.folder / ANSWER).write_bytes(to_json_lines(answer))
        print(f"{problem.name:<28} {found}", flush=True)
        wrong += len(found["differ"])
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
