"""Earthquake response of structures that collide, every impact located.

case = eventpound.load_case("cases/bridge-pulse")
response = eventpound.simulate(case)
response.peaks, response.events, response.history
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eventpound.accuracy.judged import compare as compare
    from eventpound.accuracy.judged import simulate as simulate
    from eventpound.accuracy.verify import verify as verify
    from eventpound.batch_response import BatchResponse as BatchResponse
    from eventpound.case import Case as Case
    from eventpound.case import load_case as load_case
    from eventpound.errors import AccuracyWarning as AccuracyWarning
    from eventpound.errors import ComputationError as ComputationError
    from eventpound.errors import EventpoundError as EventpoundError
    from eventpound.errors import InputError as InputError
    from eventpound.motion import AntisymmetricRicker as AntisymmetricRicker
    from eventpound.motion import Cosine as Cosine
    from eventpound.motion import Harmonic as Harmonic
    from eventpound.motion import MavroeidisPapageorgiou as MavroeidisPapageorgiou
    from eventpound.motion import NoMotion as NoMotion
    from eventpound.motion import Record as Record
    from eventpound.motion import Ricker as Ricker
    from eventpound.motion import Sine as Sine
    from eventpound.motion import TypeC as TypeC
    from eventpound.motion import read_record as read_record
    from eventpound.report.run_figures import plot as plot
    from eventpound.response import Response as Response
    from eventpound.results import write as write
    from eventpound.scene import Backfill as Backfill
    from eventpound.scene import BilinearElastic as BilinearElastic
    from eventpound.scene import Body as Body
    from eventpound.scene import BoucWen as BoucWen
    from eventpound.scene import Contact as Contact
    from eventpound.scene import ContactLaw as ContactLaw
    from eventpound.scene import Dashpot as Dashpot
    from eventpound.scene import DegradingBoucWen as DegradingBoucWen
    from eventpound.scene import Force as Force
    from eventpound.scene import Linear as Linear
    from eventpound.scene import Point as Point
    from eventpound.scene import Scene as Scene
    from eventpound.scene import Series as Series
    from eventpound.scene import Slider as Slider
    from eventpound.scene import Spring as Spring
    from eventpound.scene import Support as Support
    from eventpound.scene.modal_damping import modal_damping as modal_damping
    from eventpound.scene.modes import rayleigh as rayleigh
    from eventpound.scene.modes import stiffness_proportional as stiffness_proportional
    from eventpound.study.design import design_numbers as design_numbers
    from eventpound.study.many import simulate_many as simulate_many
    from eventpound.study.prepared import Prepared as Prepared
    from eventpound.study.prepared import prepare as prepare
    from eventpound.study.sensitivities import sensitivities as sensitivities
    from eventpound.study.study import Study as Study
    from eventpound.study.study import StudyTable as StudyTable
    from eventpound.study.suite import simulate_suite as simulate_suite

_NAMES = {
    "accuracy.judged": "compare simulate",
    "accuracy.verify": "verify",
    "batch_response": "BatchResponse",
    "case": "Case load_case",
    "errors": "AccuracyWarning ComputationError EventpoundError InputError",
    "motion": (
        "AntisymmetricRicker Cosine Harmonic MavroeidisPapageorgiou NoMotion "
        "Record Ricker Sine TypeC read_record"
    ),
    "report.run_figures": "plot",
    "response": "Response",
    "results": "write",
    "scene": (
        "Backfill BilinearElastic Body BoucWen Contact ContactLaw "
        "Dashpot DegradingBoucWen Force Linear Point Scene "
        "Series Slider Spring Support"
    ),
    "scene.modal_damping": "modal_damping",
    "scene.modes": "rayleigh stiffness_proportional",
    "study.design": "design_numbers",
    "study.many": "simulate_many",
    "study.prepared": "Prepared prepare",
    "study.sensitivities": "sensitivities",
    "study.study": "Study StudyTable",
    "study.suite": "simulate_suite",
}
"""Where each public name stands, from which it comes when it is first used."""
_HOME = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = sorted(_HOME)
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
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    """Public names, whether they were imported by now or not."""
    return sorted({*globals(), *_HOME})
