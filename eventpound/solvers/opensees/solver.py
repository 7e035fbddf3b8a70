"""OpenSeesPy as a solver: its Newmark, its Bouc-Wen, its contact materials.

Its licence does not allow it to be passed on, so it is not a dependency and is imported
only where the user has installed it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np

from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.link_law import yielding
from eventpound.mechanics.model import Model, assemble
from eventpound.numerics.arrays import Floats
from eventpound.scene.contact_law import BY_WORD
from eventpound.solvers.base import Recording, Task, Work
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.from_samples import sampled_recording
from eventpound.solvers.opensees import PACKAGE
from eventpound.solvers.opensees.elements import (
    DEFAULT,
    STEPS_IN_CONTACT,
    ContactKind,
    contact_choice,
    elements_of,
)
from eventpound.solvers.opensees.run import AnalysisRows, analyse
from eventpound.solvers.settings import Settings, number
from eventpound.tolerances import SAME_SAMPLE

_STEP = "a positive time (s)"


class OpenSees:
    """OpenSeesPy with a fixed step."""

    name = "opensees"
    summary = "OpenSeesPy: Newmark, contact springs, a fixed step; as installed"
    settings: Mapping[str, str] = {
        "time_step": "fixed step (s), needed",
        "contact": f"{', '.join(ContactKind)} (default {DEFAULT})",
        "contact_stiffness": (
            "k (N/m, or N/m^1.5 of the Hertz kinds and impact); "
            f"default for linear and kelvin-voigt: a contact lasts {STEPS_IN_CONTACT} steps"
        ),
        "indentation": "largest indentation (m) that contact = impact is made for",
    }

    contact_laws = tuple(BY_WORD)

    def check_settings(self, settings: Settings) -> None:
        """Refuse values that it cannot take; see `eventpound.solvers.base.Solver`."""
        _time_step(settings)
        contact_choice(settings)

    def check_task(self, task: Task) -> None:
        """Refuse what it has no material for."""
        elements_of(task.scene, assemble(task.scene), contact_choice(task.settings), 1.0)

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        began = time.perf_counter()
        model = assemble(task.scene)
        steps = _steps(task)
        step = (task.end - task.start) / steps
        elements = elements_of(task.scene, model, contact_choice(task.settings), step)
        length = scene_scales(task.scene, model, task.end - task.start).length
        rows = analyse(_opensees(), task, model, elements, steps, length)
        work = Work(rows.iterations, 0, rows.t.size - 1, 0, time.perf_counter() - began)
        recording = sampled_recording(task, rows.t, rows.u, rows.v, _z(model, rows), work=work)
        if not recording.success:
            raise ComputationError(
                "Newton's iterations of OpenSees did not converge; try a smaller time_step or "
                "contact_stiffness",
                recording.t,
                recording,
            )
        return recording


def _time_step(settings: Settings) -> float:
    step = number(settings, "time_step", _STEP, 0.0)
    if step is None:
        raise InputError(f"[solver]: time_step: missing; accepted: {_STEP}")
    return step


def _steps(task: Task) -> int:
    step = _time_step(task.settings)
    return max(1, math.ceil((task.end - task.start) / step * (1.0 - SAME_SAMPLE)))


def _opensees() -> Any:
    try:
        return import_module(f"{PACKAGE}.opensees")
    # It raises RuntimeError where a library it needs is missing.
    except (ImportError, RuntimeError) as error:
        cause = error.__context__ or error
        raise InputError(
            f"solver = 'opensees': {PACKAGE} does not import ({cause}); "
            'the page "opensees" of the documentation says what it needs'
        ) from error


def _z(model: Model, rows: AnalysisRows) -> Floats:
    """``z = (F - k x)/Q`` of the Bouc-Wen springs, shape (n, H); NaN where F was not asked for."""
    z = np.zeros((rows.t.size, model.hysteretic.size))
    force = yielding(model.law.memory).force
    for h, link in enumerate(model.hysteretic):
        if force[link] > 0.0:
            x = model.elongations(rows.u)[:, link]
            z[:, h] = (rows.force[:, link] - model.elastic.extension[link] * x) / force[link]
            z[0, h] = model.z0[h]
    return z
