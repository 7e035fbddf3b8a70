"""A problem as a page of equations with all its numbers, and the index of a set (Markdown)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from eventpound.problems.collection import Collection, ProblemFolder
from eventpound.problems.plan import OF_DECKS
from eventpound.results.tables import markdown_of

_FEW = 12
"""Bodies up to which matrices are written out."""

_LAWS = """\
    M u'' + C u' + B F - W lambda = -M 1 a_g(t)       u relative to the ground, right is positive
    x = B^T u,  F_s = k_s (x_s - o_s) + Q_s z_s       k_s = k_minus for x_s < o_s, else k_plus
    z' = (x' - gamma |x'| z |z|^(n-1) - beta x' |z|^n) / u_y
    0 <= g = delta + W^T u,  lambda >= 0,  g . lambda = 0
    impact: M (v+ - v-) = W L,  0 <= W^T v+ + eps W^T v-,  L >= 0, complementary

An impact is one problem over all closed contacts that do not separate, resting ones included;
if a closed contact then approaches, it is solved again in the same instant. Infinitely many
impacts in a finite time end in a contact at rest, which opens where its force would pull.
"""


def problem_page(
    problem: ProblemFolder, content: Mapping[str, Any], answer: Mapping[str, Any]
) -> str:
    """A problem.

    Parameters
    ----------
    problem : ProblemFolder
        Its name and what it tests.
    content : mapping
        Its ``problem.json``.
    answer : mapping
        Its ``answer.json``.
    """
    parts = [
        f"# {problem.name}: {content['title']}",
        problem.tests,
        f"Tags: {', '.join(problem.tags)}. {_properties(answer)}{_frequencies(content)}",
        "## Equations (SI)",
        _LAWS,
        *_plan_laws(content),
        "## Numbers",
        _bodies(content),
        *_tables(content),
        *_plan_tables(content),
        f"Damping: {_damping(content)}",
        f"Time: from {content['start']!r} to {content['end']!r} s.",
        "## Ground motion",
        *_motions(content),
        "## Answer",
        "\n".join(_answer(answer)),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts if part) + "\n"


def _properties(answer: Mapping[str, Any]) -> str:
    found = answer["properties"]
    events = ", ".join(f"{count} {kind}" for kind, count in found["events"].items())
    return (
        f"Events: {events or 'none'}. Largest amplification of a relative change of the inputs: "
        f"{found['amplification']:g}."
    )


def _frequencies(content: Mapping[str, Any]) -> str:
    found = content["frequencies"]
    if not found:
        return ""
    low, high = found
    return (
        f" Frequencies: {low:g} to {high:g} rad/s." if high > low else f" Frequency: {low:g} rad/s."
    )


def _bodies(content: Mapping[str, Any]) -> str:
    initial = content["initial"]
    numbers = zip(content["M"], initial["u"], initial["v"], strict=True)
    rows = [
        (name, *map(float, three)) for name, three in zip(content["bodies"], numbers, strict=True)
    ]
    return markdown_of(("body", "mass", "u(0)", "v(0)"), rows)


def _tables(content: Mapping[str, Any]) -> Iterator[str]:
    springs = dict(content["springs"])
    names = springs.pop("names")
    if names:
        keys = ("k_minus", "k_plus", "o", "Q", "u_y", "n", "beta", "gamma", "z(0)")
        yield markdown_of(
            ("spring", "joins", *keys),
            [
                (name, _ends(content, "B", s), *(float(column[s]) for column in springs.values()))
                for s, name in enumerate(names)
            ],
        )
    if content["contacts"]:
        numbers = zip(content["gaps"], content["restitutions"], strict=True)
        pairs = zip(content["contacts"], numbers, strict=True)
        rows = [
            (name, _ends(content, "W", j), *map(float, two)) for j, (name, two) in enumerate(pairs)
        ]
        yield markdown_of(("contact", "gap between", "delta", "eps"), rows)


def _ends(content: Mapping[str, Any], matrix: str, column: int) -> str:
    """Both ends of a spring or contact, the one with -1 first; in plan their places."""
    kind, outside = {"B": ("springs", "ground"), "W": ("contacts", "barrier")}[matrix]
    if "places" in content:
        return ", ".join(content["places"][kind][column])
    ends = {
        sign: body
        for body, row in zip(content["bodies"], content[matrix], strict=True)
        for sign in (-1.0, 1.0)
        if float(row[column]) == sign
    }
    return f"{ends.get(-1.0, outside)}, {ends.get(1.0, outside)}"


def _plan_laws(content: Mapping[str, Any]) -> Iterator[str]:
    """What stands in the place of the equations on a line, or is added to them."""
    said = content["conventions"]
    yield from (f"{key.capitalize()}: {said[key]}." for key in ("plan", "friction") if key in said)


def _plan_tables(content: Mapping[str, Any]) -> Iterator[str]:
    """Decks, what pushes their coordinates, and the weights of springs and contacts."""
    if "iota" not in content:
        return
    decks = [
        (deck["name"], *(float(deck[key]) for key in OF_DECKS[1:5]),
         ", ".join(repr(float(x)) for x in deck["centre"]), float(deck["radius"]))
        for deck in content["decks"]
    ]  # fmt: skip
    yield markdown_of(("deck", *OF_DECKS[1:]), decks)
    if "W_T" in content:
        frictions = zip(content["contacts"], map(float, content["frictions"]), strict=True)
        yield markdown_of(("contact", "friction"), [*frictions])
    rows = {key: content[key] for key in ("iota", "B", "W", "W_T") if key in content}
    few = len(content["bodies"]) <= _FEW
    yield "\n".join(
        f"{key}, a row a body: {'; '.join(str([*map(float, row)]) for row in matrix)}\n"
        if few
        else f"{key} in problem.json.\n"
        for key, matrix in rows.items()
    )


def _damping(content: Mapping[str, Any]) -> str:
    rows = [[float(x) for x in row] for row in content["C"]]
    if not any(x for row in rows for x in row):
        return "none."
    if len(rows) <= _FEW:
        return "C = " + "; ".join(str(row) for row in rows)
    return "C in problem.json."


def _motions(content: Mapping[str, Any]) -> Iterator[str]:
    """The ground acceleration, each of its components in plan."""
    for key, name in (("motion", "a_g"), ("motion_across", "a_across")):
        if key in content:
            yield "\n".join(_motion(content[key], name))


def _motion(pieces: Sequence[Mapping[str, Any]], name: str) -> Iterator[str]:
    if not pieces:
        yield "None."
    for piece in pieces:
        span = f"{float(piece['start'])!r} <= t < {float(piece['end'])!r}"
        origin = float(piece["origin"])
        if "sinusoids" in piece:
            terms = " + ".join(
                f"{float(a)!r} cos({float(w)!r} (t - {origin!r}) + {float(p)!r})"
                for a, w, p in piece["sinusoids"]
            )
            yield f"    {span}:  {name} = {terms}"
        elif "gaussian" in piece:
            q, *c = (float(number) for number in piece["gaussian"])
            powers = " + ".join(f"({x!r}) s^{k}" if k else f"({x!r})" for k, x in enumerate(c) if x)
            yield f"    {span}:  {name} = ({powers}) exp(-{q!r} s^2),  s = t - {origin!r}"
        else:
            yield (
                f"    {span}:  linear between the {len(piece['samples'])} samples of motion.csv, "
                f"{float(piece['dt'])!r} s apart"
            )
    yield "\nZero otherwise."


def _answer(answer: Mapping[str, Any]) -> Iterator[str]:
    yield "Each number is within its bound of the truth; all digits and the history: answer.json.\n"
    listed = [row[:4] for row in answer["quantities"] if not row[0].startswith("history.")]
    yield markdown_of(("quantity", "value", "bound", "amplification"), listed[: 6 * _FEW])
    if len(listed) > 6 * _FEW:
        yield f"\nand {len(listed) - 6 * _FEW} more."
    yield f"\n{len(answer['events'])} events; independent program: {verdict(answer)}."


def verdict(answer: Mapping[str, Any]) -> str:
    """What the independent program says of an answer."""
    said = answer["independent"]
    if said is None:
        return "not asked"
    if said["silent"]:
        return f"no answer ({said['silent']})"
    return f"agrees on {said['agree']} of {said['checked']} numbers"


def set_page(collection: Collection) -> str:
    """The page at the head of a set."""
    lines = [
        f"# {collection.name} {collection.version}",
        "",
        "Structures that collide, with certified answers. Each directory is a problem:",
        "`problem.md` (equations and numbers), `problem.json` (the same for programs),",
        "`problem.txt` (as bare numbers: counts and run, bodies, springs, contacts, a line each),",
        "`motion.csv` (ground acceleration), `answer.json`, and `case.toml` for eventpound. Those",
        "tagged `plan` are decks that turn, with more in these files; the others are on a line.",
        "",
        "    python score.py 01-elastic-cosine my-answer.csv --html card.html",
        "",
        "judges a history; it needs Python 3.10 and NumPy. `python score.py --help` says more.",
        "`entrants/` has programs to begin with.",
        "",
        markdown_of(
            ("problem", "what it tests", "tags", "certified", "independent program"),
            [_row(problem) for problem in collection.problems],
        ),
    ]
    return "\n".join(lines) + "\n"


def _row(problem: ProblemFolder) -> tuple[str, ...]:
    answer = problem.answer()
    certified = "yes" if answer["certified"] else "in part"
    return (problem.name, problem.tests, ", ".join(problem.tags), certified, verdict(answer))
