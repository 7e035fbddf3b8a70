"""Pages, tables and drawings: HTML and SVG."""

from __future__ import annotations

import html
import math
from dataclasses import dataclass, field

from eventpound.score.levels import Floats

COLOURS = {None: "#c0392b", "engineering": "#e08e0b", "research": "#2e86c1", "reference": "#1e8449"}
LINES = ("#1f4e79", "#b9770e", "#7d3c98", "#117a65", "#922b21", "#5d6d7e", "#2e4053", "#af601a")
_STYLE = """\
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 64em; padding: 0 1.5em;
  color: #222; } h2 { margin-top: 1.6em; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; margin: 1em 0; }
td, th { padding: .25em .6em; text-align: left; vertical-align: top; }
a { white-space: nowrap; } ul { margin: 0; padding-left: 1.1em; }
td { border-top: 1px solid #ddd; } .n { text-align: right; font-variant-numeric: tabular-nums; }
.badge { color: #fff; border-radius: .3em; padding: .1em .5em; white-space: nowrap; }
svg { max-width: 100%; height: auto; } svg text { font: 12px system-ui, sans-serif; fill: #333; }
.small { color: #666; font-size: 13px; }
"""


def page(title: str, parts: list[str]) -> str:
    """A page that needs nothing from elsewhere."""
    body = "\n".join(parts)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{html.escape(title)}</title><style>\n{_STYLE}</style></head>\n"
        f"<body><h1>{html.escape(title)}</h1>\n{body}\n</body></html>\n"
    )


def badge(level: str | None, word: str = "") -> str:
    """A level as a coloured word, its own where no other is given."""
    word = word or level or "none"
    return f'<span class="badge" style="background:{COLOURS[level]}">{word}</span>'


def table(head: list[str], rows: list[list[str]], words: int = 99) -> str:
    """A table; cells are HTML, those after the first so many numbers, which stand to the right."""

    def line(cells: list[str], tag: str) -> str:
        kinds = ["" if i < words else ' class="n"' for i in range(len(cells))]
        row = (f"<{tag}{kind}>{cell}</{tag}>" for kind, cell in zip(kinds, cells, strict=True))
        return f"<tr>{''.join(row)}</tr>"

    return "\n".join(["<table>" + line(head, "th"), *(line(r, "td") for r in rows)]) + "</table>"


@dataclass
class Axes:
    """A drawing of some width and height whose points are given in its own numbers."""

    x: tuple[float, float]
    y: tuple[float, float]
    width: float = 900.0
    height: float = 260.0
    left: float = 66.0
    below: float = 34.0
    marks: list[str] = field(default_factory=list)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Where a point lies in the picture."""
        across = (x - self.x[0]) / ((self.x[1] - self.x[0]) or 1.0)
        up = (y - self.y[0]) / ((self.y[1] - self.y[0]) or 1.0)
        return (
            self.left + across * (self.width - self.left - 12.0),
            self.height - self.below - up * (self.height - self.below - 16.0),
        )

    def line(self, x: Floats, y: Floats, colour: str, style: str = "") -> None:
        """A polyline."""
        points = " ".join(
            "{:.1f},{:.1f}".format(*self.place(a, b)) for a, b in zip(x, y, strict=True)
        )
        self.marks.append(f'<polyline points="{points}" fill="none" stroke="{colour}" {style}/>')

    def dot(self, x: float, y: float, colour: str, size: float = 3.0, filled: bool = True) -> None:
        """A circle."""
        a, b = self.place(x, y)
        fill = colour if filled else "#fff"
        self.marks.append(
            f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{size}" fill="{fill}" stroke="{colour}"/>'
        )

    def bar(self, x: float, end: float, y: float, height: float, colour: str) -> None:
        """A bar of some pixels' height from x to another, a pixel wide at least."""
        (a, b), (c, _) = self.place(x, y), self.place(end, y)
        self.marks.append(
            f'<rect x="{a:.1f}" y="{b - height:.1f}" width="{max(c - a, 1.0):.1f}" '
            f'height="{height}" fill="{colour}" opacity="0.7"/>'
        )

    def legend(self, names: list[str]) -> None:
        """Names of the first colours, above the picture."""
        across = self.left
        for name, colour in zip(names, LINES, strict=False):
            self.marks.append(
                f'<rect x="{across:.0f}" y="3" width="9" height="9" fill="{colour}"/>'
                f'<text x="{across + 13:.0f}" y="12">{html.escape(name)}</text>'
            )
            across += 34.0 + 7.0 * len(name)

    def word(self, x: float, y: float, text: str, anchor: str = "start") -> None:
        """A word at a point."""
        a, b = self.place(x, y)
        self.marks.append(_text(a, b, html.escape(text), anchor))

    def svg(
        self, x_ticks: dict[float, str], y_ticks: dict[float, str], label: str, upwards: str = ""
    ) -> str:
        """The picture with its axes and what they show."""
        grid = []
        for x, text in x_ticks.items():
            (a, b), (_, top) = self.place(x, self.y[0]), self.place(x, self.y[1])
            grid += [_line(a, a, b, top), _text(a, b + 15.0, text, "middle")]
        for y, text in y_ticks.items():
            (a, b), (right, _) = self.place(self.x[0], y), self.place(self.x[1], y)
            grid += [_line(a, right, b, b), _text(a - 5.0, b + 4.0, text, "end")]
        a, b = self.place(0.5 * sum(self.x), 0.5 * sum(self.y))
        grid.append(f'<text x="{a:.1f}" y="{self.height - 3}" text-anchor="middle">{label}</text>')
        turned = f'transform="translate(13 {b:.1f}) rotate(-90)" text-anchor="middle"'
        grid.append(f"<text {turned}>{upwards}</text>")
        return (
            f'<svg width="{self.width:g}" height="{self.height:g}" '
            f'viewBox="0 0 {self.width:g} {self.height:g}" xmlns="http://www.w3.org/2000/svg">'
            + "".join(grid + self.marks)
            + "</svg>"
        )


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'


def _line(x: float, to_x: float, y: float, to_y: float) -> str:
    return f'<line x1="{x:.1f}" x2="{to_x:.1f}" y1="{y:.1f}" y2="{to_y:.1f}" stroke="#eee"/>'


def ticks_of(low: float, high: float, count: int = 5) -> dict[float, str]:
    """Round numbers between two, and how each is written."""
    step = 10.0 ** math.floor(math.log10(max(high - low, 1e-300) / count))
    step *= min(
        (m for m in (1.0, 2.0, 5.0, 10.0) if (high - low) / (step * m) <= count), default=10.0
    )
    first = math.ceil(low / step)
    return {k * step: f"{k * step:g}" for k in range(first, math.floor(high / step) + 1)}


def length_unit_of(size: float) -> tuple[float, str]:
    """What a length (m) is multiplied by to be shown, and its unit."""
    return (1.0, "m") if size >= 2.0 else (1e2, "cm") if size >= 0.02 else (1e3, "mm")
