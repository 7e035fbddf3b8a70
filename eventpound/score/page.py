"""The page of a card, and what the package says of many cards."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from eventpound.score.answer import Motion
from eventpound.score.card import Card, digits_of, event_words
from eventpound.score.drawing import (
    COLOURS,
    LINES,
    Axes,
    badge,
    length_unit_of,
    page,
    table,
    ticks_of,
)
from eventpound.score.levels import EVENTS, LEVELS, UNIT_OF_TIME
from eventpound.score.pairing import rests_of
from eventpound.score.problem import Problem


def card_page(problem: Problem, history: Motion, card: Card) -> str:
    """A card as a page."""
    worst = sorted(card.deviations, key=lambda q: -q.error)[:20]
    rows = [
        [
            html.escape(q.quantity.name), f"{q.quantity.value:.6g}", f"{q.value:.6g}",
            f"{q.value - q.quantity.value:+.1e}", q.quantity.unit, f"{q.error:.1e}",
            f"{q.floor:.1e}", f"{digits_of(max(q.error, q.floor)):.1f}",
        ]
        for q in worst
    ]  # fmt: skip
    head = ["quantity", "certified", "found", "error", "unit", "part of its scale", "floor",
            "digits"]  # fmt: skip
    parts = [
        f"<p>{html.escape(problem.given['tests'])}</p>",
        f"<p>Hardest level passed: {badge(card.passed)}</p>",
        _verdicts(card),
        digits_picture(card),
        _facts(card),
        "<h2>Motion</h2>",
        motion_picture(problem, history),
        '<p class="small">Lines: the answer judged. Circles: certified displacements. '
        "Red: certified impacts. Green: certified rests.</p>",
        *_impacts_part(problem, card),
        "<h2>Events</h2>",
        _events_table(problem, card),
        "<h2>Largest errors</h2>",
        table(head, rows, 1),
    ]
    return page(f"{card.problem}: score card", parts)


def _verdicts(card: Card) -> str:
    """Levels with everything that keeps an answer from them."""
    rows = []
    for level, reasons in card.reasons.items():
        said = "".join(f"<li>{html.escape(why)}</li>" for why in reasons)
        verdict = f"<ul>{said}</ul>" if reasons else "passed"
        rows.append([level if reasons else badge(level), f"{LEVELS[level]:g}", verdict])
    return table(["level", "error allowed", ""], rows)


def _facts(card: Card) -> str:
    """What is judged beside the numbers, and what is not judged."""
    rows = [["deepest overlap", f"{card.penetration:.1e} of the largest displacement"]]
    if card.energy is not None:
        rows.append(["energy from nowhere", f"{card.energy:.1e} of the largest"])
    if card.seconds is not None:
        rows.append(["processor time", f"{card.seconds:.3g} s"])
    rows += [["not judged", html.escape(what)] for what in card.not_judged]
    return table(["beside the numbers", ""], rows)


def _impacts_part(problem: Problem, card: Card, most: int = 40) -> list[str]:
    """Every impact: when, how fast, and with which effective restitution."""
    if not card.impact_rows:
        return []

    def cell(value: float | None, form: str, missing: str = "") -> str:
        return missing if value is None else f"{value:{form}}"

    rows = []
    for r in card.impact_rows[:most]:
        shift = None if None in (r["t"], r["t_found"]) else r["t_found"] - r["t"]
        rows.append([
            html.escape(r["contact"]),
            cell(r["t"], ".5f", "extra"), cell(r["t_found"], ".5f", "missed"), cell(shift, "+.1e"),
            cell(r["speed"], ".4g"), cell(r["speed_found"], ".4g"),
            cell(r["restitution"], ".3f"), cell(r["restitution_found"], ".3f"),
        ])  # fmt: skip
    head = ["contact", "t (s)", "found (s)", "shift (s)", "closes with (m/s)", "found (m/s)",
            "restitution", "found"]  # fmt: skip
    more = len(card.impact_rows) - most
    return [
        "<h2>Impacts</h2>",
        restitution_picture(problem, card),
        '<p class="small">Effective restitution: how many times faster the gap opens than it '
        "closed. Circles: certified; dots: in the rows of the answer judged, whatever else it "
        "lists.</p>",
        table(head, rows, 1),
        f'<p class="small">and {more} more in the JSON file.</p>' if more > 0 else "",
    ]


def _events_table(problem: Problem, card: Card) -> str:
    """Events by their kinds; those that are neither expected nor found are left out."""
    rows = []
    for kind, found in {"impact": card.impacts, **card.events}.items():
        if not (found["expected"] or found["extra"]):
            continue
        unknown = found["matched"] is None
        shift = found["largest_shift"]
        late = "" if shift is None else f"{shift * UNIT_OF_TIME * problem.duration:.1e}"
        counts = ["not reported"] if unknown else [f"{found['matched']}"]
        counts += ["" if unknown else f"{found[key]}" for key in ("missed", "extra")]
        rows.append([f"{kind}s", f"{found['expected']}", *counts, late])
    head = ["events", "expected", "matched", "missed", "extra", "largest shift (s)"]
    return table(head, rows, 1) if rows else "<p>None.</p>"


def motion_picture(problem: Problem, history: Motion, most: int = 4) -> str:
    """Displacements of an answer, the certified ones as circles, impacts as ticks."""
    shown = problem.bodies[:most]
    values = {row[0]: row[1] for row in problem.answer["quantities"]}
    t = history.t
    rows = np.unique(np.linspace(0, t.size - 1, min(t.size, 3000)).astype(int))
    factor, unit = length_unit_of(problem.length)
    u = factor * history.u[:, : len(shown)]
    margin = 0.08 * float(np.ptp(u)) or 1.0
    axes = Axes((float(t[0]), float(t[-1])), (float(u.min()) - margin, float(u.max()) + margin))
    for i, body in enumerate(shown):
        axes.line(t[rows], u[rows, i], LINES[i])
        for k, moment in enumerate(problem.given["moments"]):
            if f"history.{k}.{body}" in values:
                value = factor * values[f"history.{k}.{body}"]
                axes.dot(moment, value, LINES[i], 2.6, filled=False)
    axes.legend(shown)
    bottom = axes.y[0]
    for event in problem.truth.events:
        if event.kind == "impact":
            axes.bar(event.t, event.t, bottom, 7.0, "#c0392b")
    for rest, last in rests_of(problem.truth.events):
        if rest is not None:
            until = problem.given["end"] if last is None else last.t
            axes.bar(rest.t, until, bottom, 4.0, "#1e8449")
    return axes.svg(ticks_of(*axes.x), ticks_of(*axes.y), "t (s)", f"u ({unit})")


def restitution_picture(problem: Problem, card: Card) -> str:
    """Effective restitution of every impact, certified (circles) and found (dots)."""
    struck = {row["contact"] for row in card.impact_rows}
    contacts = [contact for contact in problem.given["contacts"] if contact in struck]
    known = [r[k] for r in card.impact_rows for k in ("restitution", "restitution_found") if r[k]]
    times = [r[k] for r in card.impact_rows for k in ("t", "t_found") if r[k] is not None]
    margin = 0.03 * (max(times) - min(times) or problem.duration)
    axes = Axes(
        (min(times) - margin, max(times) + margin), (0.0, min(max([1.0, *known]), 2.0)), height=190
    )
    for row in card.impact_rows:
        colour = LINES[contacts.index(row["contact"]) % len(LINES)]
        for end in ("", "_found"):
            if row[f"restitution{end}"] is not None:
                height = min(row[f"restitution{end}"], axes.y[1])
                axes.dot(row[f"t{end}"], height, colour, 4.0 if not end else 2.4, filled=bool(end))
    axes.legend(contacts[:6])
    return axes.svg(ticks_of(*axes.x), ticks_of(*axes.y, 4), "t (s)", "restitution")


def digits_picture(card: Card) -> str:
    """Digits of what is judged as bars, the levels as lines."""
    groups = [(g, d) for g, d in card.digits.items() if d is not None]
    axes = Axes((0.0, 16.0), (0.0, float(len(groups))), height=60.0 + 26.0 * len(groups), left=90.0)
    for level, size in LEVELS.items():
        x = -math.log10(size)
        axes.line([x, x], [0.0, axes.y[1]], COLOURS[level], 'stroke-dasharray="5 4"')
        axes.word(x, axes.y[1], level, "middle")
    for i, (group, digits) in enumerate(groups):
        y = len(groups) - i
        axes.bar(0.0, digits, y - 0.72, 12.0, LINES[0])
        worst = card.worst.get(group)
        axes.word(digits + 0.1, y - 0.66, f"{digits:.1f}{f'  {worst}' if worst else ''}")
    names = {len(groups) - i - 0.5: group for i, (group, _) in enumerate(groups)}
    return axes.svg(
        {float(k): f"{k}" for k in range(0, 17, 2)},
        names,
        "digits, and the quantity with the fewest",
    )


def best_of(cards: list[Card]) -> Card:
    """The first card of the hardest level; the last one where none is passed."""
    order: list[str | None] = [None, *LEVELS]
    hardest = max(cards, key=lambda card: order.index(card.passed))
    return hardest if hardest.passed else cards[-1]


def solved(ladders: Iterable[list[Card]]) -> dict[str, int]:
    """How many problems a program solves to each level or a harder one."""
    passed = [best_of(cards).passed for cards in ladders]
    levels = list(LEVELS)
    return {level: sum(p in levels[i:] for p in passed) for i, level in enumerate(levels)}


def ladder_text(cards: list[Card]) -> str:
    """Cards of one program from coarse to fine, a line a size: error against work in numbers."""
    groups = ("peaks", "final", "history", "impacts")
    rows = [["size", "passed", *groups, "missed", "extra", "overlap", "energy", "time (s)"]]
    for card in cards:
        digits = (card.digits.get(group) for group in groups)
        counts = (card.impacts[key] for key in ("missed", "extra"))
        numbers = (card.penetration if card.digits else None, card.energy)
        rows.append([
            card.size or "-", card.passed or "-",
            *("-" if d is None else f"{d:.1f}" for d in digits),
            *("-" if n is None else str(n) for n in counts),
            *("-" if x is None else f"{x:.0e}" for x in numbers),
            "-" if card.seconds is None else f"{card.seconds:.3g}",
        ])  # fmt: skip
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(c.ljust(w) for c, w in zip(r, widths, strict=True)).rstrip() for r in rows]
    for card in cards:
        why = "; ".join(card.next_why)
        said = "; ".join(f"{kind}s: {words}" for kind, words in event_words(card).items())
        lines.append(f"{card.size or '-'}: {'; '.join(x for x in (why, said) if x) or 'passed'}")
    return "\n".join(lines) + "\n"


def count_text(ladders: list[list[Card]]) -> str:
    """How many problems a program solves to each level."""
    parts = [f"{count} {level}" for level, count in solved(ladders).items()]
    return f"of {len(ladders)} problems {', '.join(parts)}"


def set_page(title: str, found: dict[str, dict[str, list[Card]]], limit: float) -> str:
    """Programs (by name) on problems (by name), cards from coarse to fine, as a page."""
    problems = list(next(iter(found.values()), {}))
    summary = [
        [html.escape(label), *map(str, solved(by_problem.values()).values())]
        for label, by_problem in found.items()
    ]
    rows = []
    for name in problems:
        cells = [f'<a href="#{name}">{name}</a>']
        for label in found:
            card = best_of(found[label][name])
            why = card.levels["reference"] if card.passed != "reference" else ""
            digits = f"{-math.log10(LEVELS[card.passed]):.0f}" if card.passed else "–"
            cells.append(f'<span title="{html.escape(why)}">{badge(card.passed, digits)}</span>')
        rows.append(cells)
    parts = [
        f"<p>Solved to each level, of {len(problems)} problems:</p>",
        table(["program", *LEVELS], summary),
        "<p>Hardest level passed at any step or tolerance, by its digits; what keeps it from the "
        f"next is shown by the pointer. A run may take {limit:g} s.</p>",
        table(["problem", *(html.escape(label) for label in found)], rows),
        '<h2>Digits against time</h2><p class="small">The fewest digits of any peak, final '
        "value or stated displacement, over processor time, a point a step or tolerance. Open: "
        "impacts missed or extra. In the tables: rests, their ends and accumulations, matched of "
        "expected.</p>",
    ]
    for name in problems:
        parts.append(f'<h3 id="{name}">{name}</h3>')
        parts.append(work_picture({label: found[label][name] for label in found}))
        head = ["program", "size", "passed", "what keeps it back", *(f"{k}s" for k in EVENTS)]
        parts.append(table(head, [
            [html.escape(label), card.size, badge(card.passed),
             html.escape("; ".join(card.next_why)),
             *(_found(card.events.get(kind)) for kind in EVENTS)]
            for label in found for card in found[label][name]
        ]))  # fmt: skip
    return page(title, parts)


def _found(event: dict[str, Any] | None) -> str:
    """Matched of expected events in few characters; empty where there are none."""
    if event is None or not (event["expected"] or event["extra"]):
        return ""
    if event["matched"] is None:
        return "not reported"
    extra = f", {event['extra']} extra" if event["extra"] else ""
    return f"{event['matched']}/{event['expected']}{extra}"


def work_picture(lines: dict[str, list[Card]], width: float = 900.0, height: float = 380.0) -> str:
    """Digits against time, a line a program, a point a step size or tolerance."""
    timed = {name: [c for c in cards if c.seconds] for name, cards in lines.items()}
    seconds = [c.seconds for cards in timed.values() for c in cards if c.seconds]
    if not seconds:
        return '<p class="small">Nothing was timed.</p>'
    low, high = math.floor(math.log10(min(seconds))), math.ceil(math.log10(max(seconds)) + 1e-9)
    axes = Axes((low, max(high, low + 1)), (0.0, 16.0), width, height)
    ends: list[tuple[float, float, str]] = []
    for i, (name, cards) in enumerate(timed.items()):
        if not cards:
            continue
        colour = LINES[i % len(LINES)]
        dash = "" if i < len(LINES) else 'stroke-dasharray="4 3"'
        points = [(math.log10(c.seconds), c.fewest) for c in cards if c.seconds]
        axes.line([p[0] for p in points], [p[1] for p in points], colour, dash)
        for (x, y), card in zip(points, cards, strict=True):
            axes.dot(x, y, colour, filled=not (card.impacts["missed"] or card.impacts["extra"]))
        ends.append((*points[-1], name))
    if len(lines) > 1:
        _name_ends(axes, ends)
    decades = {float(k): f"1e{k}" for k in range(low, max(high, low + 1) + 1)}
    return axes.svg(
        decades, {float(k): f"{k}" for k in range(0, 17, 4)}, "processor time (s)", "fewest digits"
    )


def _name_ends(axes: Axes, ends: list[tuple[float, float, str]]) -> None:
    """Names at points, moved up where they would lie on each other."""
    taken: list[tuple[float, float]] = []
    for x, y, name in sorted(ends, key=lambda end: end[1]):
        across, down = axes.place(x, y + 0.4)
        for a, b in taken:
            if abs(a - across) < 95.0 and down > b - 12.0:
                down = b - 12.0
        taken.append((across, down))
        axes.marks.append(f'<text x="{across:.1f}" y="{down:.1f}">{html.escape(name)}</text>')
