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
from typing import Any

from eventpound.case.figure import OF_STUDIES, FigureKind, common_words, one_or_several, read_kind
from eventpound.case.table import Table
from eventpound.study.plan import Plan
from eventpound.units import Dimension

_SCALES = ("linear", "logarithmic")
_TEXTS = ("curves", "rows", "columns", "pages", "grey", "nested")


@dataclass(frozen=True)
class FigurePlan:
    """One figure of a study.

    Parameters
    ----------
    name : str
        Of its file, without the ending.
    title : str
        Above it; empty for none.
    x, y : tuple of str
        Columns of the table; a column of panels for each pair. An empty `x` is
        the last axis of the part that a panel shows.
    curves, rows, columns, pages : str
        Columns of the table whose values make curves, rows and columns of
        panels, and files; empty for none.
    grey : str
        Column drawn in grey, once a panel; empty for none.
    regions : float or None
        Value of `curves` whose amplification is marked.
    map : bool
        Whether `y` is drawn in colours, over `x` and the values of `curves`.
    gain : bool
        Whether that amplification is drawn in a strip below each panel.
    x_scale, y_scale : str
        ``"linear"`` or ``"logarithmic"``.
    y_max : float or None
        End of the vertical axis.
    x_labels, y_labels : tuple of str
        What stands at the axes instead of the symbols of the columns; may be empty.
    marks : tuple of float
        Where vertical lines are drawn.
    nested : str
        Column of `y` whose curves fall on each other: one is drawn within the other.
    column_titles : tuple of str
        What the columns of panels are called, from the left; may be empty.
    largest : float or None
        Value of `x` from which on a marker stands where each curve is largest.
    levels : tuple of float
        Where horizontal lines are drawn.
    line : tuple of tuple of float
        Points x and y of a map that a dashed line joins; may be empty.
    model : bool
        Whether the scene is drawn, too, with the laws of its springs, in a file of its own.
    claim : str
        What the figure is held against, for the page of all figures.
    note : str
        A line below the figure.
    """

    name: str
    title: str
    x: tuple[str, ...]
    y: tuple[str, ...]
    curves: str
    rows: str
    columns: str
    pages: str
    grey: str
    regions: float | None
    map: bool
    gain: bool
    x_scale: str
    y_scale: str
    y_max: float | None
    x_labels: tuple[str, ...]
    y_labels: tuple[str, ...]
    marks: tuple[float, ...]
    nested: str
    column_titles: tuple[str, ...]
    largest: float | None
    levels: tuple[float, ...]
    line: tuple[tuple[float, float], ...]
    model: bool
    claim: str
    note: str

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
    x, y = _columns(table, "x", ("",)), _columns(table, "y")
    if len(x) != len(y) and y:
        table.reject("y", f"as many columns as x has ({len(x)})")
    regions = table.optional_quantity("regions", Dimension.NUMBER)
    further: dict[str, Any] = {
        **common_words(table),
        **{key: table.text(key, "some text") if table.has(key) else "" for key in _TEXTS},
        **{key: table.optional_quantity(key, Dimension.NUMBER) for key in ("y_max", "largest")},
        **{
            key: table.numbers(key, "a list of numbers") if table.has(key) else ()
            for key in ("marks", "levels")
        },
        **{
            k: table.choice(k, _SCALES) if table.has(k) else "linear"
            for k in ("x_scale", "y_scale")
        },
    }
    figure = FigurePlan(
        name=table.file_name("name", "study"),
        x=x,
        y=y,
        regions=regions,
        map=_map(table),
        gain=_gain(table, regions),
        x_labels=_columns(table, "x_label", ()),
        y_labels=_columns(table, "y_label", ()),
        column_titles=_columns(table, "column_titles", ()),
        line=_line(table),
        model=table.flag("model"),
        **further,
    )
    table.close()
    return figure


def _map(table: Table) -> bool:
    wanted = read_kind(table, OF_STUDIES, "a [study]") is FigureKind.MAP
    others = [key for key in ("grey", "regions", "nested", "largest") if table.has(key)]
    accepted = "a figure with curves, the second axis, and without grey, regions, nested, largest"
    table.require("kind", not wanted or (table.has("curves") and not others), accepted)
    return wanted


def _line(table: Table) -> tuple[tuple[float, float], ...]:
    """Points of a line on a map."""
    given: Any = table.data["line"] if table.has("line") else []
    good = isinstance(given, list) and all(
        isinstance(p, list) and len(p) == 2 and all(type(v) in (int, float) for v in p)
        for p in given
    )
    of_map = not given or table.data.get("kind") == FigureKind.MAP
    if not (good and of_map):
        table.reject("line", 'points [[x, y], ...] as numbers in SI, of a figure of kind "map"')
        return ()
    return tuple((float(x), float(y)) for x, y in given)


def _gain(table: Table, regions: float | None) -> bool:
    if not table.has("gain"):
        return False
    table.require("gain", regions is not None or table.data["gain"] is False, "a figure's regions")
    return table.flag("gain")


def _columns(table: Table, key: str, default: tuple[str, ...] | None = None) -> tuple[str, ...]:
    """One text or a list of them."""
    if table.has(key) and isinstance(table.data[key], list):
        return table.texts(key, "a list of texts")
    if default is not None and not table.has(key):
        return default
    text = table.text(key, "a column of the table")
    return (text,) if text else ()
