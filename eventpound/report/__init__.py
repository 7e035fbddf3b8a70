"""Figures and pages of results.

Its modules import matplotlib, which takes a while: here they are imported when they are used.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eventpound.report.run_figures import figures, plot

__all__ = ["figures", "plot"]


def __getattr__(name: str) -> Any:
    if name in __all__:
        from eventpound.report import run_figures

        return getattr(run_figures, name)
    raise AttributeError(name)
