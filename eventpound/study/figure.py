"""The table ``[figure]``: what of a study is drawn, and where.

[figure]
x = "pi.Q"                  # any columns of the table
y = "pi_um"
curves = "pi.delta"         # a curve for each of its values
rows = "excitation.kind"    # a row of panels for each
columns = "excitation.reverse"
pages = "pi.uy"             # a file for each
grey = "free.pi_um"         # drawn once a panel, in grey
regions = 0.1               # the curve whose amplification is marked
kind = "map"                # y in colours over x and curves; "curves" without it
gain = true                 # its amplification, in a strip below each panel
largest = 0.25              # a marker where each curve is largest from this x on
line = [[0.1, 0.2], [1, 2]] # of a map: points that a dashed line joins, as of a closed form
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from eventpound.case.figure import OF_STUDIES, FigureKind, one_or_several, read_kind
from eventpound.case.keys import declared, flag_key, number_key, read_keys, text_key
from eventpound.case.table import Table
from eventpound.study.plan import Plan
from eventpound.units import Dimension

_SCALES = ("linear", "logarithmic")


def _columns(table: Table, key: str) -> tuple[str, ...]:
    """One text or a list of them."""
    if table.has(key) and isinstance(table.data[key], list):
        return table.texts(key, "a list of texts")
    text = table.text(key, "a column of the table")
    return (text,) if text else ()


def _map(table: Table, key: str) -> bool:
    wanted = read_kind(table, OF_STUDIES, "a [study]") is FigureKind.MAP
    others = [key for key in ("grey", "regions", "nested", "largest") if table.has(key)]
    accepted = "a figure with curves, the second axis, and without grey, regions, nested, largest"
    table.require(key, not wanted or (table.has("curves") and not others), accepted)
    return wanted


def _line(table: Table, key: str) -> tuple[tuple[float, float], ...]:
    """Points of a line on a map."""
    given: Any = table.data[key]
    good = isinstance(given, list) and all(
        isinstance(p, list) and len(p) == 2 and all(type(v) in (int, float) for v in p)
        for p in given
    )
    of_map = not given or table.data.get("kind") == FigureKind.MAP
    if not (good and of_map):
        table.reject(key, 'points [[x, y], ...] as numbers in SI, of a figure of kind "map"')
        return ()
    return tuple((float(x), float(y)) for x, y in given)


def _gain(table: Table, key: str) -> bool:
    table.require(key, table.has("regions") or table.data[key] is False, "a figure's regions")
    return table.flag(key)


_text, _number = partial(text_key, "some text"), partial(number_key, usual=None)
_numbers = partial(declared, read=lambda table, key: table.numbers(key, "a list of numbers"))
_scale = partial(declared, read=lambda table, key: table.choice(key, _SCALES), usual="linear")


@dataclass(frozen=True)
class FigurePlan:
    """One figure of a study: columns `x` and `y` of its table, a column of panels for each pair.

    An empty `x` is the last axis of the part that a panel shows.
    """

    x: tuple[str, ...]
    y: tuple[str, ...]
    regions: float | None = _number(
        "value of `curves` whose amplification is marked", Dimension.NUMBER
    )
    title: str = _text("above it")
    claim: str = _text("what the figure is held against, for the page of all figures")
    note: str = _text("a line below the figure")
    curves: str = _text("column of the table whose values make curves")
    rows: str = _text("that whose values make rows of panels")
    columns: str = _text("columns of panels")
    pages: str = _text("files")
    grey: str = _text("column drawn in grey, once a panel")
    nested: str = _text("column of `y` whose curves fall on each other: one is drawn in the other")
    y_max: float | None = _number("end of the vertical axis", Dimension.NUMBER)
    largest: float | None = _number(
        "value of `x` from which on a marker stands where each curve is largest", Dimension.NUMBER
    )
    marks: tuple[float, ...] = _numbers("where vertical lines are drawn")
    levels: tuple[float, ...] = _numbers("where horizontal lines are drawn")
    x_scale: str = _scale("`linear` or `logarithmic`")
    y_scale: str = _scale("`linear` or `logarithmic`")
    name: str = declared(
        "of its file, without the ending", lambda table, key: table.file_name(key, ""), "study"
    )
    map: bool = declared(
        "whether `y` is drawn in colours, over `x` and `curves`", _map, False, name="kind"
    )
    gain: bool = declared("whether the amplification is in a strip below each panel", _gain, False)
    x_labels: tuple[str, ...] = declared(
        "what stands at the axes instead of symbols of columns", _columns, name="x_label"
    )
    y_labels: tuple[str, ...] = declared("of the vertical axes", _columns, name="y_label")
    column_titles: tuple[str, ...] = declared("of the columns of panels, from the left", _columns)
    line: tuple[tuple[float, float], ...] = declared(
        "points x and y of a map that a dashed line joins", _line
    )
    model: bool = flag_key("whether the scene is drawn, too, with its laws, in a file of its own")

    def problems(self, study: Plan) -> Iterator[str]:
        """Columns of the figure that the table does not have, axes that a map does not show."""
        known = (*study.columns, *study.quantities)
        words = ("curves", "rows", "columns", "pages", "grey")
        found = [("x", name) for name in self.x if name] + [("y", name) for name in self.y]
        found += [(key, name) for key in words if (name := getattr(self, key))]
        if self.regions is not None:
            found.append(("regions", "amplification"))
        for key, name in found:
            if name not in known:
                yield (
                    f"[figure]: {key}: found {name!r}, which is neither an axis nor among the "
                    f"quantities; accepted: {', '.join(known)}"
                )
        if self.map:
            yield from self._map_problems(study)

    def _map_problems(self, study: Plan) -> Iterator[str]:
        # Numbers of decks, each of which makes another scene, are axes as others are.
        labels = (each for base in study.bases for each in base.labels.items())
        axes = {key: key for key, value in labels if type(value) in (int, float)}
        axes |= {axis.key: axis.together or axis.key for base in study.bases for axis in base.axes}
        for x in {key or [*axes][-1] for key in self.x} if axes else ("",):
            own = (x, self.curves)
            if len({axes.get(key, "") for key in own} - {""}) < len(own):
                yield (
                    f"[figure]: kind: found map of {x!r} over {self.curves!r}; accepted: two of "
                    f"the axes that vary by themselves, {', '.join(axes)}"
                )
            shown = {axes.get(key, key) for key in (*own, self.rows, self.columns, self.pages)}
            if left := [key for key in study.columns if axes.get(key, key) not in shown]:
                yield (
                    "[figure]: kind: found several runs in one place of the map; accepted: "
                    f"{', '.join(left)} in rows, columns or pages"
                )


def read_figures(top: Table) -> tuple[FigurePlan, ...]:
    """Read ``[figure]`` or several ``[[figure]]``; problems are noted."""
    return tuple(_read_figure(table) for table in one_or_several(top, "figure"))


def _read_figure(table: Table) -> FigurePlan:
    x = _columns(table, "x") if table.has("x") else ("",)
    y = _columns(table, "y")
    if len(x) != len(y) and y:
        table.reject("y", f"as many columns as x has ({len(x)})")
    figure = FigurePlan(x, y, **read_keys(table, FigurePlan))
    table.close()
    return figure
