"""Earthquake response of structures that collide, every impact located.

case = eventpound.load_case("cases/bridge-pulse")
response = eventpound.simulate(case)
response.peaks, response.events, response.history
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eventpound.accuracy.judged import compare, simulate
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
    from eventpound.motion import (
        AntisymmetricRicker,
        Cosine,
        Harmonic,
        MavroeidisPapageorgiou,
        NoMotion,
        Record,
        Ricker,
        Sine,
        TypeC,
        read_record,
    )
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
    from eventpound.scene.modes import rayleigh
    from eventpound.study.suite import simulate_suite

__all__ = [
    "AccuracyWarning",
    "AntisymmetricRicker",
    "BilinearElastic",
    "Body",
    "BoucWen",
    "Case",
    "ComputationError",
    "Contact",
    "Cosine",
    "Dashpot",
    "EventpoundError",
    "Harmonic",
    "InputError",
    "Linear",
    "Many",
    "MavroeidisPapageorgiou",
    "NoMotion",
    "Record",
    "Response",
    "Ricker",
    "Scene",
    "Series",
    "Sine",
    "Spring",
    "TypeC",
    "compare",
    "load_case",
    "plot",
    "rayleigh",
    "read_record",
    "simulate",
    "simulate_many",
    "simulate_suite",
    "verify",
    "write",
]

_MOTIONS = (
    "AntisymmetricRicker",
    "Cosine",
    "Harmonic",
    "MavroeidisPapageorgiou",
    "NoMotion",
    "Record",
    "Ricker",
    "Sine",
    "TypeC",
    "read_record",
)
_HOME = {
    **dict.fromkeys(_MOTIONS, "motion"),
    "rayleigh": "scene.modes",
    "compare": "accuracy.judged",
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


def __dir__() -> list[str]:
    """Public names, whether they were imported by now or not."""
    return sorted({*globals(), *__all__})
