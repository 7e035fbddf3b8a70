"""Marks of contact events: open circles for impacts, filled ones for detachments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eventpound.numerics.arrays import Floats
from eventpound.report.style import Color

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes


def marker_size(events: int) -> float:
    """Diameter of a circle (points): smaller, the more there are."""
    if events <= 40:
        return 5.5
    return 4.0 if events <= 200 else 2.6


def draw_circles(
    axes: Axes,
    impacts: tuple[Floats, Floats],
    openings: tuple[Floats, Floats],
    color: Color,
    size: float,
) -> None:
    """Draw events at (times, heights).

    Parameters
    ----------
    axes : Axes
        Where.
    impacts, openings : tuple of ndarray
        Times (s) and heights of the open and of the filled circles.
    color : Color
        Of the circles.
    size : float
        Diameter (points).
    """
    for (times, heights), fill, order in ((impacts, "white", 4), (openings, color, 5)):
        # An empty line outside the clip would count in the layout as a point of the figure.
        if times.size:
            axes.plot(
                times,
                heights,
                linestyle="none",
                marker="o",
                markersize=size,
                markerfacecolor=fill,
                markeredgecolor=color,
                markeredgewidth=0.9,
                clip_on=False,
                zorder=order,
            )


def circle_legend(impacts: bool, openings: bool, rests: bool) -> list[Artist]:
    """Legend entries of those kinds of event that occur."""
    from matplotlib.lines import Line2D

    def circle(fill: str, label: str) -> Line2D:
        return Line2D(
            [],
            [],
            linestyle="none",
            marker="o",
            markersize=5.5,
            color="#444444",
            markerfacecolor=fill,
            label=label,
        )

    entries: list[Artist] = []
    if impacts:
        entries.append(circle("white", "impact"))
    if openings:
        entries.append(circle("#444444", "detachment"))
    if rests:
        entries.append(
            Line2D(
                [],
                [],
                color="#444444",
                linewidth=4.0,
                alpha=0.35,
                solid_capstyle="butt",
                label="in contact",
            )
        )
    return entries


def draw_rests(axes: Axes, rests: list[tuple[float, float]], height: float, color: Color) -> None:
    """Draw the stretches (s) over which a contact stayed closed as a bar."""
    if rests:
        starts, ends = zip(*rests, strict=True)
        axes.hlines(
            [height] * len(rests),
            starts,
            ends,
            color=color,
            linewidth=4.0,
            alpha=0.35,
            capstyle="butt",
            zorder=2,
        )
