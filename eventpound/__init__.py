"""Earthquake response of structures that collide, every impact located.

case = eventpound.load_case("cases/bridge-pulse")
response = eventpound.simulate(case)
response.peaks, response.events, response.history
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eventpound.accuracy.judged import simulate
    from eventpound.accuracy.verify import certify as verify
    from eventpound.case import Case, load_case
    from eventpound.errors import (
        AccuracyWarning,
        ComputationError,
        EventpoundError,
        InputError,
    )
    from eventpound.many import simulate_many
    from eventpound.many_response import Many
    from eventpound.report import plot
    from eventpound.response import Response
    from eventpound.results import write
    from eventpound.scene import (
        BilinearElastic,
        Body,
        BoucWen,
        Contact,
        Dashpot,
        Linear,
        Scene,
        Series,
        Spring,
    )
    from eventpound.study.suite import simulate_suite

__all__ = [
    "AccuracyWarning",
    "BilinearElastic",
    "Body",
    "BoucWen",
    "Case",
    "ComputationError",
    "Contact",
    "Dashpot",
    "EventpoundError",
    "InputError",
    "Linear",
    "Many",
    "Response",
    "Scene",
    "Series",
    "Spring",
    "load_case",
    "plot",
    "simulate",
    "simulate_many",
    "simulate_suite",
    "verify",
    "write",
]

_HOME = {
    "Case": "case",
    "load_case": "case",
    "plot": "report",
    "Response": "response",
    "write": "results",
    "simulate": "accuracy.judged",
    "Many": "many_response",
    "simulate_many": "many",
    "simulate_suite": "study.suite",
    "verify": "accuracy.verify",
    "AccuracyWarning": "errors",
    "ComputationError": "errors",
    "EventpoundError": "errors",
    "InputError": "errors",
}

_CALLED = {"verify": "certify"}
"""Public names of what has another one where it is written."""


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used, so that importing the package costs little."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    home = import_module(f"{__name__}.{_HOME.get(name, 'scene')}")
    return getattr(home, _CALLED.get(name, name))
