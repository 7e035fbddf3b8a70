"""Digits that hold over a run, and the amplification that takes them away."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from eventpound.accuracy.certificate import Certificate
from eventpound.report.style import PALETTE, new_figure, styled

SMALLEST = 1e-3
"""Amplification at which the axis begins: before the motion does, there is none."""


@styled()
def digits_figure(certificate: Certificate) -> Figure | None:
    """Digits on which routes agree and amplification over time, one above the other.

    Parameters
    ----------
    certificate : Certificate
        Of a case; without digits over time there is no figure.
    """
    digits, parting = certificate.digits_over_time, certificate.parting
    if digits is None:
        return None
    figure = new_figure(6.5, 4.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    edges = np.concatenate(([digits.start], digits.t))
    look: Any = {"baseline": None, "linewidth": 1.0}
    upper.stairs(digits.digits, edges, color=PALETTE[0], **look)
    upper.set(ylabel="digits agreed (-)", ylim=(0.0, 16.5))
    lower.stairs(np.maximum(digits.amplification, SMALLEST), edges, color=PALETTE[1], **look)
    lower.set(ylabel="amplification (-)", xlabel="time (s)", yscale="log")
    given = "certified" if certificate.certified else "refused"
    upper.set_title(f"{certificate.case}: {given}, worst body", loc="left")
    # Where routes part, and from where on digits are lost.
    for axes in (upper, lower):
        if digits.lost_from is not None:
            axes.axvline(digits.lost_from, color=PALETTE[7], ls="--", label="digits lost from")
        if parting is not None:
            axes.axvline(parting.t, color=PALETTE[3], ls=":", label="routes part")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="best")
    return figure
