"""Whether the fast solver can run at once: what it needs is loaded, or kept compiled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eventpound.mechanics.model import assemble, with_elements
from eventpound.mechanics.supported import lowered
from eventpound.numerics.compiled.linked import Entry
from eventpound.scene.spring import BoucWen, Linear
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast.advance import advance
from eventpound.solvers.fast.blanks import blank_state
from eventpound.solvers.fast.constants import hysteresis_of, links_of, plan_of
from eventpound.solvers.fast.single.model import oscillator_of
from eventpound.solvers.fast.single.oscillator import oscillate
from eventpound.solvers.fast.solver import BUDGET, run_of


def kernels_kept(task: Task) -> bool:
    """Whether a run of a task would compile none of the large kernels.

    Nothing is compiled to tell: types do not depend on numbers, so the scene stands here with
    linear springs in the place of hysteretic ones, for which no backbone is made, and a kernel
    that has run in this process serves every scene.
    """
    curved = [isinstance(spring.law, BoucWen) for spring in task.scene.springs]
    springs = tuple(
        replace(spring, law=Linear(1.0)) if bends else spring
        for spring, bends in zip(task.scene.springs, curved, strict=True)
    )
    scene = lowered(replace(task.scene, springs=springs), task.start)
    task = replace(task, scene=scene, progress=None)
    model = with_elements(assemble(task.scene))
    scales = scene_scales(task.scene, model, task.end - task.start)
    links, hysteresis = links_of(model), hysteresis_of(model.law, model.hysteretic, 1.0)
    one = oscillator_of(model, scales.length, links, hysteresis, energy=task.energy)
    needed: tuple[Callable[..., Any], ...] = (advance,)
    if one.alone and sum(curved) <= 1:
        needed = (oscillate,)
    if all(isinstance(each, Entry) and each.overloads for each in needed):
        return True
    plan = plan_of(task, model, scales)
    state = blank_state(plan, model.u0, model.v0, model.z0, task.start, model.ledger_entries)
    run = run_of(plan, state, model, scales)
    arguments: dict[Callable[..., Any], tuple[Any, ...]] = {
        oscillate: (BUDGET, plan, state, run.series.single, run.record),
        advance: (BUDGET, run),
    }
    return all(_ready(each, *arguments[each]) for each in needed)


def _ready(function: Callable[..., Any], *arguments: Any) -> bool:
    """Whether a compiled function can be called with such arguments at once."""
    if not isinstance(function, Entry):
        return False
    types = tuple(function.typeof_pyval(each) for each in arguments)
    return types in function.overloads or function._cache.has(types, function.targetctx)
