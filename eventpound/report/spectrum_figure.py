"""Response spectra: pseudo-acceleration and displacement over the period, and a target."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eventpound.report.style import PALETTE, length_unit, literal, styled

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


def spectrum_figure(
    spectrum: pd.DataFrame, damping: float, title: str = "", target: pd.DataFrame | None = None
) -> Figure:
    """Draw a response spectrum.

    Parameters
    ----------
    spectrum : DataFrame
        As `eventpound.study.response_spectrum` gives it.
    damping : float
        Its damping ratio.
    title : str
        Above it.
    target : DataFrame, optional
        Columns period (s) and PSA_g (g), drawn beside it.
    """
    from matplotlib.figure import Figure

    unit = length_unit(float(spectrum["SD"].max()))
    with styled():
        figure = Figure(figsize=(7.5, 5.2), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        label = f"{100.0 * damping:g} % damping"
        upper.semilogx(spectrum["period"], spectrum["PSA_g"], color=PALETTE[0], label=label)
        lower.semilogx(spectrum["period"], spectrum["SD"] / unit.size, color=PALETTE[0])
        if target is not None:
            upper.plot(target["period"], target["PSA_g"], "--", color=PALETTE[1], label="target")
        upper.legend()
        upper.set_ylabel("PSA (g)")
        lower.set_ylabel(f"SD ({unit.name})")
        lower.set_xlabel("period (s)")
        lower.xaxis.set_major_formatter("{x:g}")
        for axes in (upper, lower):
            axes.set_ylim(bottom=0.0)
            axes.margins(x=0.0)
        figure.suptitle(literal(title), fontsize=10.0)
    return figure
