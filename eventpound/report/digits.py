"""Digits that hold over a run, and the amplification that takes them away."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eventpound.accuracy.certificate import Certificate
from eventpound.report.style import PALETTE, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SMALLEST = 1e-3
"""Amplification at which the axis begins: before the motion does, there is none."""


def digits_figure(certificate: Certificate) -> Figure | None:
    """Digits on which routes agree and amplification over time, one above the other.

    Parameters
    ----------
    certificate : Certificate
        Of a case; without digits over time there is no figure.
    """
    digits = certificate.digits_over_time
    if digits is None:
        return None
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=(6.5, 4.0), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        edges = np.concatenate(([digits.start], digits.t))
        upper.stairs(digits.digits, edges, baseline=None, color=PALETTE[0], linewidth=1.0)
        upper.set_ylabel("digits agreed (-)")
        upper.set_ylim(0.0, 16.5)
        amplification = np.maximum(digits.amplification, SMALLEST)
        lower.stairs(amplification, edges, baseline=None, color=PALETTE[1], linewidth=1.0)
        lower.set_yscale("log")
        lower.set_ylabel("amplification (-)")
        lower.set_xlabel("time (s)")
        given = "certified" if certificate.certified else "refused"
        upper.set_title(f"{certificate.case}: {given}, worst body", loc="left")
        _marks(upper, certificate)
        _marks(lower, certificate)
    return figure


def _marks(axes: Axes, certificate: Certificate) -> None:
    """Where routes part, and from where on digits are lost."""
    digits, parting = certificate.digits_over_time, certificate.parting
    if digits is not None and digits.lost_from is not None:
        axes.axvline(digits.lost_from, color=PALETTE[7], linestyle="--", label="digits lost from")
    if parting is not None:
        axes.axvline(parting.t, color=PALETTE[3], linestyle=":", label="routes part")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="best")
