"""A page of one run that zooms: histories, gaps, loops, and events to click.

One file in itself: data and a script of plain JavaScript, which loads nothing.
Of decks in plan it shows the bridge from above as it moves.
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from eventpound.contact.event import STRIKES
from eventpound.numerics.arrays import Floats, Ints
from eventpound.report.html import document
from eventpound.report.loops import nonlinear_springs
from eventpound.report.plan_view import moving_plan
from eventpound.report.style import PALETTE
from eventpound.report.view import View, traces_of
from eventpound.results.jsontext import canonical
from eventpound.results.shown_units import Units
from eventpound.units import Dimension

ZOOM_PAGE = "motion.html"
"""Name of the file."""
_MOST_ROWS, _MOST_EVENTS, _MOST_LOOPS = 40_000, 5_000, 24
"""Of a page: 40 000 rows of ten columns are some 4 MB."""
_DIGITS = 7
_HERE = files("eventpound.report")
_BODY = """\
<h1>{title}</h1>
<p>Wheel: zoom. Drag: move. Double click: all. A click on a mark or on a row: that event.
<button id="all">all</button> <span id="range"></span></p>
<p id="said"></p>
{plan}<div id="panels"></div>
<div id="loops"></div>
<h2>Events</h2>
<div id="events"><table>
<tr><th>t (s)</th><th class="word">kind</th><th class="word">contact</th><th>closing (m/s)</th>\
<th>impulse ({impulse})</th></tr>
{rows}</table></div>
{more}<script type="application/json" id="run">{data}</script>
<script>
{script}</script>
"""


_PLAN = """\
<p><button id="play">play</button> <select id="speed"><option value="0.2">a fifth of real speed\
<option value="1" selected>real speed<option value="5">five times</select> \
<span id="now"></span></p>
<canvas id="plan"></canvas>
"""


def zoom_page(view: View, title: str, units: Units) -> bytes:
    """The page, HTML.

    Parameters
    ----------
    view : View
        Results of a run.
    title : str
        Of the page.
    units : Units
        Units.
    """
    kept, events = _rows_kept(view), list(_events(view, units))
    shown = events[:_MOST_EVENTS]
    data = {
        "t": _short(view.column("t")[kept]),
        "panels": list(_panels(view, kept, units)),
        "loops": list(_loops(view, kept, units)),
        "events": shown,
        "shocks": view.shocks,
        "colors": PALETTE,
        "force": units.unit(Dimension.FORCE.unit)[0],
        "length": units.unit(Dimension.LENGTH.unit)[0],
    }
    scripts = ["zoom.js"]
    if (plan := moving_plan(view)) is not None:
        data["plan"] = plan | {"size": units.unit(Dimension.LENGTH.unit)[1]}
        scripts.append("zoom_plan.js")
    left_out = len(view.column("t")) - kept.size
    more = [f"{left_out} rows of the history are left out, none at an event."] * bool(left_out)
    more += [f"and {len(events) - len(shown)} more events"] * (len(events) > len(shown))
    body = _BODY.format(
        title=escape(title),
        impulse=escape(units.unit(Dimension.IMPULSE.unit)[0]),
        rows="".join(map(_row, range(len(shown)), shown)),
        more="".join(f"<p>{text}</p>\n" for text in more),
        # What ends a script in a text would end it here.
        data=canonical(data).decode().replace("<", "\\u003c"),
        plan=_PLAN if plan else "",
        script="".join((_HERE / name).read_text(encoding="utf-8") for name in scripts),
    )
    return document(title, ["page.css", "zoom.css"], [body])


def _rows_kept(view: View) -> Ints:
    """Numbers of the rows: all, or as many as there is room for, and those at events."""
    t = view.column("t")
    if t.size <= _MOST_ROWS:
        return np.arange(t.size)
    even = np.linspace(0, t.size - 1, _MOST_ROWS).astype(np.int64)
    at_events = np.flatnonzero(np.isin(t, np.asarray(view.results.event_columns["t"], float)))
    return np.unique(np.concatenate([even, at_events]))


def _short(values: Floats) -> list[float | None]:
    """Values with as many digits as a picture needs; none of what is not known."""
    return [float(f"{v:.{_DIGITS}g}") if np.isfinite(v) else None for v in values.tolist()]


def _panels(view: View, kept: Ints, units: Units) -> Iterator[dict[str, Any]]:
    """The ground, the bodies and the gaps over time."""
    contacts = [contact.name for contact in view.contacts]
    # What moves along, across and turns has one colour.
    of_owner: dict[str, int] = {}
    traces = (
        (t.name, Dimension.ANGLE if t.turned else Dimension.LENGTH, t.curves.values(), of_owner)
        for t in traces_of(view)
    )
    for name, dimension, curves, hues in (
        ("ground", Dimension.ACCELERATION, [*view.ground.items()], dict[str, int]()),
        *traces,
        ("gap", Dimension.LENGTH, [(name, view.column(f"gap.{name}")) for name in contacts], {}),
    ):
        unit, size = units.unit(dimension.unit)
        lines = [
            {"name": own, "y": _short(values[kept] / size), "hue": hues.setdefault(own, len(hues))}
            for own, values in curves
        ]
        if lines:
            yield {"name": name, "unit": unit, "lines": lines, "marks": name == "gap"}


def _loops(view: View, kept: Ints, units: Units) -> Iterator[dict[str, Any]]:
    """Force over deformation of every spring that is not linear."""
    (_, force), (_, length) = (units.unit(d.unit) for d in (Dimension.FORCE, Dimension.LENGTH))
    for spring in nonlinear_springs(view)[:_MOST_LOOPS]:
        x = view.elongation(spring)[kept] / length
        y = view.column(f"force.{spring.name}")[kept] / force
        yield {"name": spring.name, "x": _short(x), "y": _short(y)}


def _events(view: View, units: Units) -> Iterator[dict[str, Any]]:
    """What a click tells of each event."""
    columns = view.results.event_columns
    names = ("t", "kind", "contact", "gap_velocity_before", "impulse")
    for t, kind, contact, before, impulse in zip(*(columns[n] for n in names), strict=True):
        closing, size = -float(before), units.number(float(impulse), Dimension.IMPULSE.unit)
        unit = units.unit(Dimension.IMPULSE.unit)[0]
        said = f"{kind} of {contact} at {float(t):.6f} s"
        if struck := kind in STRIKES:
            said += f", closing at {closing:.3g} m/s, impulse {size} {unit}"
        yield {
            **{"t": float(t), "kind": str(kind), "contact": str(contact), "struck": struck},
            **{"closing": f"{closing:.3g}" if struck else "", "impulse": size if struck else ""},
            "said": said,
        }


def _row(number: int, event: dict[str, Any]) -> str:
    words = "".join(f'<td class="word">{escape(event[key])}</td>' for key in ("kind", "contact"))
    numbers = f"<td>{event['closing']}</td><td>{event['impulse']}</td>"
    return f'<tr data-event="{number}"><td>{event["t"]:.6f}</td>{words}{numbers}</tr>\n'
