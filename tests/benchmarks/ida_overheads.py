"""What a step and a start of IDA cost, two ways: ``python -m tests.benchmarks.ida_overheads``.

Two bodies on springs that lie on each other, every step examined: IDA called from compiled
code, and, as where that cannot be had, through scikit-sundae's own interface. Median of five.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial

from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.mechanics.model import assemble
from eventpound.scene import GROUND, BilinearElastic, Body, Contact, Linear, Scene, Spring
from eventpound.solvers.base import Task
from eventpound.solvers.events.instant_loop import make_ready
from eventpound.solvers.events.integrator import Start
from eventpound.solvers.events.loop import EventLoop, Segment
from eventpound.solvers.events.scales import scene_scales, tolerances
from eventpound.solvers.sundials.compiled_ida import DirectIda
from eventpound.solvers.sundials.descriptor_modes import DescriptorModes
from eventpound.solvers.sundials.library import ida_library
from eventpound.solvers.sundials.python_ida import WrappedIda

END, RTOL, REPEATS, STARTS = 60.0, 1e-10, 5, 200


def scene() -> Scene:
    """a on a spring, b pressed against it by another; they swing together."""
    bodies = (Body("a", 2.0), Body("b", 0.7))
    springs = (
        Spring("k", (GROUND, "a"), Linear(10.8)),
        Spring("l", (GROUND, "b"), BilinearElastic(4.0, 4.0, -1.0)),
    )
    return Scene(bodies, springs, (), (Contact("joint", "a", "b", 0.0, 0.5),))


def segment(*, wrapped: bool) -> tuple[Segment, DirectIda | WrappedIda]:
    """Their motion on IDA."""
    task = Task(scene(), 0.0, END, RTOL)
    model = assemble(task.scene)
    scales = scene_scales(task.scene, model, END)
    modes = DescriptorModes(model, scales, tolerances(task, scales), RTOL, ledger=False)
    ida = WrappedIda(modes) if wrapped else DirectIda(ida_library(), modes)
    loop = EventLoop(task, ida)
    now = loop.now
    now.state.resting[:] = now.state.pressed[:] = True
    now.enter_mode()
    piece = now.piece(task.scene.motion.pieces()[0], END)
    make_ready(now, now.mode, piece)
    return Segment(now, ida, piece, NO_FRAME), ida


def whole(*, wrapped: bool) -> tuple[int, float]:
    """Steps of the whole motion, and their time (s)."""
    run, _ = segment(wrapped=wrapped)
    began = time.process_time()
    run.run()
    return run.now.steps, time.process_time() - began


def start_time(start: Callable[[], None]) -> float:
    """Time of a start (s)."""
    began = time.process_time()
    for _ in range(STARTS):
        start()
    return (time.process_time() - began) / STARTS


def main() -> None:
    """Print the table."""
    print("| way | steps | µs a step | µs a start |")
    print("| --- | --- | --- | --- |")
    for way, wrapped in (("from compiled code", False), ("through scikit-sundae", True)):
        run, ida = segment(wrapped=wrapped)
        y = run._examined.y[0].copy()
        given = Start(run.mode, run.forcing, run.frame, y, run.atol)
        whole(wrapped=wrapped)
        steps, taken = sorted(whole(wrapped=wrapped) for _ in range(REPEATS))[REPEATS // 2]
        begun = statistics.median(start_time(partial(ida.start, given)) for _ in range(REPEATS))
        print(f"| {way} | {steps} | {1e6 * taken / steps:.1f} | {1e6 * begun:.0f} |")


if __name__ == "__main__":
    main()
