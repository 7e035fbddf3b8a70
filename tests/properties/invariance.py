"""Whether an answer stays the same when the scene is seen otherwise, and who is to blame if not.

A difference from the first answer is allowed up to `OWN` units of rtol. Beyond, both scenes run
again at `TIGHT`; if they still differ, the first scene is run with masses and forces (`nudged`),
or velocities at some time (`_kicked`), changed in their last digits, and a difference of up to
`TIMES` times what that makes is called ill-conditioned. What is left is a violation. A broken rule
must be broken at `TIGHT`, too; where a body just reaches a contact, or all but leaves one, what
follows may differ by the root of the error; one that bounces with less than the rounding of speeds
may be called at rest a bounce sooner or later; a scene in which nothing is defined may be refused.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from eventpound.contact.cascade import UNDEFINED
from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.model import assemble
from eventpound.motion.record import Record
from eventpound.scene import Scene
from eventpound.scene.check import check_scene
from eventpound.solvers import solver_named
from eventpound.solvers.base import Event, EventKind, Recording, Task
from eventpound.solvers.events.scales import SceneScales, scene_scales
from tests.benchmarks.agreement import distances, sequence
from tests.properties.checks import violations
from tests.properties.restored import in_order, joined, restored
from tests.properties.transforms import (
    free_row,
    from_state,
    mirrored,
    reordered,
    same,
    scaled,
    shifted,
    with_far_bodies,
    with_far_contacts,
)
from tests.solvers.random_scenes import nudged, random_scene

RTOL, TIGHT = 1e-9, 1e-12
OWN, TIMES = 1e3, 20.0
NUDGES, NUDGE = 12, 10.0 * TIGHT
"""How often, and by what part, masses and forces, or velocities, are changed."""
CHAOS = 1e-4
"""Difference made by `NUDGE` beyond which answers cannot be compared at all."""
SOFT = np.sqrt(OWN * TIGHT)
"""Part of the largest speed with which a body may meet a contact that it just reaches."""
FAINT = 1e-12
"""Part of L/T below which a closing speed is rounding."""
ALONE = 1e-3
"""Part of the run between an impact and others of its contact that is no cascade."""
ROUNDING = 64.0 * np.finfo(float).eps
"""Of a gap, in parts of the scene's length."""
ROWS = 60
"""Rows of the history between events."""
MANY = 20_000
"""Events beyond which a scene is run once only: an elastic contact pressed shut."""
BEYOND = 1.001
"""Gap of contacts that never close, in parts of the largest displacement; not less than the
scene's length, which it is a part of where nothing else moves the scene."""
PATIENCE = 20.0
"""Processor time of one run (s)."""


class TooLongError(Exception):
    """A run that takes more than `PATIENCE`."""


Answer = Callable[[float], Recording]
"""The answer of a scene seen otherwise at a relative tolerance, in the terms of the first."""


@dataclass(frozen=True)
class Finding:
    """What was found about one property of one scene."""

    property: str
    word: str
    remark: str = ""


def run(
    scene: Scene,
    end: float,
    solver: str,
    rtol: float,
    view_time: float = 1.0,
    like: SceneScales | None = None,
    energy: bool = True,
) -> Recording:
    """The recording of a run, with its energy ledger where wanted, or `TooLongError`.

    With the absolute tolerances that a scene of the scales `like` has, where given.
    """
    began = time.process_time()

    def progress(t: float) -> None:
        if time.process_time() - began > PATIENCE:
            raise TooLongError(f"at {rtol:g}: t = {t:.6g} of {end:.6g}")

    times = np.linspace(0.0, end / view_time, ROWS + 1)[1:-1] * view_time
    task = Task(scene, 0.0, end, rtol, output_times=times, energy=energy, progress=progress)
    if like is not None:
        atol = {"displacement": rtol * like.length, "velocity": rtol * like.speed}
        task = replace(task, atol=atol)
    recording = solver_named(solver).solve(task)
    return replace(recording, events=in_order(recording.events))


def examine(seed: int, solver: str) -> list[Finding]:
    """Every property of a random scene and of what it becomes seen otherwise."""
    scene, end = random_scene(seed)
    try:
        first = run(scene, end, solver, RTOL)
    except (ComputationError, TooLongError) as error:
        word = "refused" if UNDEFINED in str(error) else type(error).__name__
        return [Finding("run", word, str(error))]
    found = _ruled("rules", scene, end, solver, violations(scene, 0.0, end, RTOL, first))
    found += _momentum(scene, end, solver)
    if len(first.events) > MANY:
        return [*found, Finding("run", "too many events", f"{len(first.events)} events")]
    for name, answer in variants(scene, end, solver, first, np.random.default_rng(seed)):
        found.append(judge(name, scene, end, solver, first, answer))
    return found


def variants(
    scene: Scene, end: float, solver: str, first: Recording, rng: np.random.Generator
) -> Iterator[tuple[str, Answer]]:
    """The scene seen otherwise, in every way."""
    scales = scene_scales(scene, assemble(scene), end)
    units = 2.0 ** rng.integers(-20, 21, 3)
    if isinstance(scene.motion, Record):
        # The mean period is taken over a band in Hz, so that a slower record is another one.
        units[1] = 1.0
    reach = max(first.displacement.maximum.max(), -first.displacement.minimum.min())
    far = max(scales.length, BEYOND * float(reach))
    for name, (other, view) in (
        ("mirror", mirrored(scene)),
        ("units", scaled(scene, *map(float, units))),
        ("order", reordered(scene, rng)),
        ("far bodies", with_far_bodies(scene, rng, scales.speed, scales.time)),
        ("far contacts", with_far_contacts(scene, far)),
    ):
        # What is far away makes the scene larger, not its accuracy less.
        like = scales if name.startswith("far") else None

        def answer(rtol: float, other: Scene = other, view=view, like=like) -> Recording:
            seen = run(other, end * view.time, solver, rtol, view.time, like)
            return restored(seen, view)

        yield name, answer
    # Without it a body by itself takes steps of its own.
    yield "no ledger", lambda rtol: run(scene, end, solver, rtol, energy=False)
    split = float(rng.uniform(0.05, 0.95)) * end

    yield "split", lambda rtol: _in_two_parts(scene, end, solver, rtol, split)


def _in_two_parts(
    scene: Scene, end: float, solver: str, rtol: float, split: float, kick: np.ndarray | float = 0.0
) -> Recording:
    """A run stopped at `split` (s) and continued from the state there.

    With the velocities of bodies that touch nothing changed by `kick` (N,), in parts of the
    scene's own.
    """
    model = assemble(scene)
    scales = scene_scales(scene, model, end)
    one = run(scene, split, solver, rtol)
    bound = scales.z_bound
    touching = np.flatnonzero(model.gaps(one.u) <= 1e-6 * scales.length)
    free = ~np.isin(
        np.arange(one.u.size), np.concatenate((model.left[touching], model.right[touching]))
    )
    v = one.v + np.where(free, kick * scales.speed, 0.0)
    z = np.clip(one.z, -bound, bound)
    rest = from_state(scene, one.u, v, z, ROUNDING * scales.length)
    check_scene(rest)
    two = run(shifted(rest, split), end - split, solver, rtol)
    return joined(one, restored(two, same(scene), split))


def _kicked(scene: Scene, end: float, solver: str, rng: np.random.Generator) -> Recording:
    """The run with velocities changed by `NUDGE` of the scene's own, early rather than late."""
    kick = NUDGE * rng.uniform(-1.0, 1.0, len(scene.bodies))
    split = end * 10.0 ** float(rng.uniform(-3.0, 0.0))
    return _in_two_parts(scene, end, solver, TIGHT, split, kick)


def judge(
    name: str, scene: Scene, end: float, solver: str, first: Recording, answer: Answer
) -> Finding:
    """Compare an answer with the first one, and look for the cause of a difference."""
    try:
        other = answer(RTOL)
        if len(other.events) > MANY:
            return Finding(name, "too many events", f"{len(other.events)} events")
        apart, worst = _apart(first, other, end)
        if apart == 0.0:
            return Finding(name, "identical")
        if apart <= OWN * RTOL and sequence(first) == sequence(other):
            return Finding(name, "holds")
        return _explained(name, scene, end, solver, answer, f"{worst} {apart:.1e}")
    except TooLongError as error:
        return Finding(name, "TooLongError", str(error))
    except (ComputationError, InputError) as error:
        return Finding(name, "VIOLATION", f"fails where the first did not: {error}")


def _explained(
    name: str, scene: Scene, end: float, solver: str, answer: Answer, remark: str
) -> Finding:
    """Whether a smaller tolerance or the conditioning explains a difference."""
    first, other = run(scene, end, solver, TIGHT), answer(TIGHT)
    apart, worst = _apart(first, other, end)
    alike = sequence(first) == sequence(other)
    remark += f"; at {TIGHT:g} {worst} {apart:.1e}{'' if alike else ', events differ'}"
    if apart <= 10.0 * OWN * TIGHT and alike:
        return Finding(name, "holds when tight", remark)
    rng = np.random.default_rng(1)
    moved, steady = 0.0, True
    for i in range(NUDGES):
        if i % 2 == 0:
            again = run(nudged(scene, rng, NUDGE), end, solver, TIGHT)
        else:
            again = _kicked(scene, end, solver, rng)
        moved = max(moved, _apart(first, again, end)[0])
        steady = steady and sequence(first) == sequence(again)
        # Where an answer moves much more than by errors, so do the times of its events.
        told = alike or not steady or moved > 10.0 * OWN * NUDGE
        if moved > CHAOS or (apart <= TIMES * max(moved, OWN * TIGHT) and told):
            return Finding(name, "ill-conditioned", remark)
    if apart <= SOFT and (_grazes(first) or _grazes(other)):
        return Finding(name, "a graze", remark)
    if differ_in_faint_rests(first, other, scene_scales(scene, assemble(scene), end), end):
        return Finding(name, "a faint rest", remark)
    remark += f"; nudged {moved:.1e}{'' if steady else ', events differ'}"
    return Finding(name, "VIOLATION", remark)


def _grazes(recording: Recording) -> bool:
    """Whether a body touches a contact as softly as an error makes it that just reaches it.

    It meets it with a speed that goes as the square root of the error, or not at all. So does
    one whose contact force just vanishes: it leaves the contact for as short a time.
    """
    soft = SOFT * float(np.max(np.abs(recording.history.v)))
    last: dict[int, Event] = {}
    for e in recording.events:
        before = last.get(e.contact)
        apart = np.inf if before is None else (e.t - before.t) / recording.t
        left = before is not None and before.kind is EventKind.DETACHMENT and apart <= SOFT
        gentle = e.kind is EventKind.IMPACT and 0.0 < -e.gap_velocity_before <= soft
        if gentle and (apart > ALONE or left):
            return True
        last[e.contact] = e
    return False


def differ_in_faint_rests(
    first: Recording, other: Recording, scales: SceneScales, end: float
) -> bool:
    """Whether only resting times differ, by no more than the last faint bounces before them."""
    apart = distances(first, other, end)
    if any(apart[key] > 10.0 * OWN * TIGHT for key in apart if key != "resting"):
        return False
    allowed = np.maximum(_faint_bounces(first, scales), _faint_bounces(other, scales))
    allowed += 10.0 * OWN * TIGHT * end
    return bool(np.all(np.abs(first.resting_time - other.resting_time) <= allowed))


def _faint_bounces(recording: Recording, scales: SceneScales) -> np.ndarray:
    """Time (s) for each contact (K,) from its last impacts that are rounding to its rests."""
    total = np.zeros(recording.resting_time.size)
    last: dict[int, float] = {}
    for e in recording.events:
        if e.kind in (EventKind.IMPACT, EventKind.ACCUMULATION):
            if -e.gap_velocity_before <= FAINT * scales.speed:
                total[e.contact] += e.t - last.get(e.contact, e.t)
            last[e.contact] = e.t
    return total


def _apart(first: Recording, other: Recording, end: float) -> tuple[float, str]:
    """Largest difference in parts of scale, and of what."""
    apart = distances(first, other, end)
    worst = max(apart, key=lambda key: apart[key])
    return apart[worst], worst


def _momentum(scene: Scene, end: float, solver: str) -> list[Finding]:
    """``Σ m (v + v_g)`` of a row that nothing holds stays what it was."""
    row = free_row(scene)
    try:
        recording = run(row, end, solver, RTOL)
    except ComputationError as error:
        return _ruled("momentum", row, end, solver, [str(error)])
    except TooLongError as error:
        return [Finding("momentum", "TooLongError", str(error))]
    lines = violations(row, 0.0, end, RTOL, recording)
    mass = np.array([b.mass for b in row.bodies])
    t = recording.history.t
    ground = row.motion.velocity(t) - row.motion.velocity(np.zeros(1))
    momentum = recording.history.v @ mass + mass.sum() * ground
    change = float(np.max(np.abs(momentum - mass @ [b.velocity for b in row.bodies])))
    speed = float(np.max(np.abs(recording.history.v))) or 1.0
    if change > OWN * RTOL * mass.sum() * speed:
        lines.append(f"momentum changes by {change:.3e} of {mass.sum() * speed:.1e}")
    return _ruled("momentum", row, end, solver, lines)


def _ruled(name: str, scene: Scene, end: float, solver: str, lines: list[str]) -> list[Finding]:
    """One finding for each broken rule, unless none is broken at a smaller tolerance."""
    if not lines:
        return [Finding(name, "holds")]
    try:
        again = violations(scene, 0.0, end, TIGHT, run(scene, end, solver, TIGHT))
    except (ComputationError, TooLongError) as error:
        again = [str(error)]
    if not again:
        return [Finding(name, "holds when tight", "; ".join(lines))]
    return [Finding(name, "VIOLATION", f"{line}; at {TIGHT:g} {again[0]}") for line in lines]
