"""Earthquake response of structures that collide, every impact located.

case = eventpound.load_case("cases/bridge-pulse")
response = eventpound.simulate(case)
response.peaks, response.events, response.history
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eventpound.accuracy.judged import compare, simulate
    from eventpound.accuracy.verify import verify
    from eventpound.batch_response import BatchResponse
    from eventpound.case import Case, load_case
    from eventpound.errors import (
        AccuracyWarning,
        ComputationError,
        EventpoundError,
        InputError,
    )
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
        Backfill,
        BilinearElastic,
        Body,
        BoucWen,
        Contact,
        ContactLaw,
        Dashpot,
        DegradingBoucWen,
        Force,
        Linear,
        Point,
        Scene,
        Series,
        Slider,
        Spring,
        Support,
    )
    from eventpound.scene.modal_damping import modal_damping
    from eventpound.scene.modes import rayleigh, stiffness_proportional
    from eventpound.study.design import design_numbers
    from eventpound.study.many import simulate_many
    from eventpound.study.prepared import Prepared, prepare
    from eventpound.study.sensitivities import sensitivities
    from eventpound.study.study import Study, StudyTable
    from eventpound.study.suite import simulate_suite

__all__ = [
    "AccuracyWarning",
    "AntisymmetricRicker",
    "Backfill",
    "BatchResponse",
    "BilinearElastic",
    "Body",
    "BoucWen",
    "Case",
    "ComputationError",
    "Contact",
    "ContactLaw",
    "Cosine",
    "Dashpot",
    "DegradingBoucWen",
    "EventpoundError",
    "Force",
    "Harmonic",
    "InputError",
    "Linear",
    "MavroeidisPapageorgiou",
    "NoMotion",
    "Point",
    "Prepared",
    "Record",
    "Response",
    "Ricker",
    "Scene",
    "Series",
    "Sine",
    "Slider",
    "Spring",
    "Study",
    "StudyTable",
    "Support",
    "TypeC",
    "compare",
    "design_numbers",
    "load_case",
    "modal_damping",
    "plot",
    "prepare",
    "rayleigh",
    "read_record",
    "sensitivities",
    "simulate",
    "simulate_many",
    "simulate_suite",
    "stiffness_proportional",
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
    "modal_damping": "scene.modal_damping",
    "rayleigh": "scene.modes",
    "stiffness_proportional": "scene.modes",
    "compare": "accuracy.judged",
    "Case": "case",
    "load_case": "case",
    "plot": "report",
    "Response": "response",
    "write": "results",
    "simulate": "accuracy.judged",
    "BatchResponse": "batch_response",
    "simulate_many": "study.many",
    "Prepared": "study.prepared",
    "prepare": "study.prepared",
    "sensitivities": "study.sensitivities",
    "design_numbers": "study.design",
    "Study": "study.study",
    "StudyTable": "study.study",
    "simulate_suite": "study.suite",
    "verify": "accuracy.verify",
    "AccuracyWarning": "errors",
    "ComputationError": "errors",
    "EventpoundError": "errors",
    "InputError": "errors",
}

_RENAMED = {"Many": "BatchResponse"}
"""Public names of earlier states, which still work, by the names they have now."""


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used, so that importing the package costs little."""
    from importlib import import_module

    if name in _RENAMED:
        import warnings

        new = _RENAMED[name]
        warnings.warn(f"eventpound.{name} is eventpound.{new} now", DeprecationWarning, 2)
        name = new
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME.get(name, 'scene')}"), name)


def __dir__() -> list[str]:
    """Public names, whether they were imported by now or not."""
    return sorted({*globals(), *__all__})
