"""Figures of results."""

from eventpound.report.plot import figures, plot

__all__ = ["figures", "plot"]
