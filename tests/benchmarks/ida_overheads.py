"""What a step and a start of IDA cost, two ways: ``python -m tests.benchmarks.ida_overheads``.

Two bodies on springs that lie on each other, with compiled residual and Jacobian:
called from compiled code, as ``solver = "ida"`` does, and through scikit-sundae's own interface,
with callbacks in Python that call the same kernels. Median of five.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
from sksundae.ida import IDA

from eventpound.mechanics.descriptor import unpack_descriptor
from eventpound.mechanics.descriptor_jacobian import jacobian
from eventpound.mechanics.descriptor_motion import residual
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.mechanics.model import assemble
from eventpound.scene import GROUND, BilinearElastic, Body, Contact, Linear, Scene, Spring
from eventpound.solvers.base import Task
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.scales import scene_scales, tolerances
from eventpound.solvers.events.segment import Segment
from eventpound.solvers.sundials.ida_direct import DirectIda
from eventpound.solvers.sundials.ida_library import ida_library

END, RTOL, REPEATS, STARTS = 60.0, 1e-10, 5, 200


def scene() -> Scene:
    """a on a spring, b pressed against it by another; they swing together."""
    bodies = (Body("a", 2.0), Body("b", 0.7))
    springs = (
        Spring("k", (GROUND, "a"), Linear(10.8)),
        Spring("l", (GROUND, "b"), BilinearElastic(4.0, 4.0, -1.0)),
    )
    return Scene(bodies, springs, (), (Contact("joint", "a", "b", 0.0, 0.5),))


def segment() -> tuple[Segment, DirectIda]:
    """Their motion on IDA."""
    task = Task(scene(), 0.0, END, RTOL)
    model = assemble(task.scene)
    scales = scene_scales(task.scene, model, END)
    atol = tolerances(task, scales)
    ida = DirectIda(ida_library(), model, scales, atol, RTOL, ledger=False)
    loop = EventLoop(task, ida)
    now = loop.now
    now.state.resting[:] = now.state.pressed[:] = True
    now.enter_mode()
    piece = now.piece(task.scene.motion.pieces()[0], END)
    return Segment(now, ida, piece, NO_FRAME), ida


class Wrapped:
    """The same through scikit-sundae."""

    def __init__(self, ida: DirectIda) -> None:
        own, self.forcing = ida._own, ida._forcing
        self.d = unpack_descriptor(own.ints, own.floats)
        rtol, atol = own.local_tolerances(NO_FRAME)
        # scikit-sundae cannot leave λ out of the error test.
        atol = np.where(own.algebraic, 1e6 * atol, atol)
        self.y, self.rate = ida._memory.state.copy(), ida._memory.rate.copy()
        self.ida = IDA(
            self._residual,
            jacfn=self._jacobian,
            rtol=rtol,
            atol=atol,
            algebraic_idx=np.flatnonzero(own.algebraic),
            max_num_steps=100_000,
        )

    def _residual(self, tau: float, y: np.ndarray, rate: np.ndarray, out: np.ndarray) -> None:
        residual(tau, y, rate, out, self.d, self.forcing, NO_FRAME)

    def _jacobian(
        self,
        tau: float,
        y: np.ndarray,
        rate: np.ndarray,
        out: np.ndarray,
        cj: float,
        J: np.ndarray,
    ) -> None:
        jacobian(tau, y, cj, J, self.d, self.forcing, NO_FRAME)

    def start(self) -> None:
        """Begin anew."""
        self.ida.init_step(0.0, self.y, self.rate)

    def run(self) -> int:
        """Carry the motion to the end; number of steps."""
        self.start()
        steps, t = 0, 0.0
        while t < END:
            result = self.ida.step(END, "onestep", END)
            assert result.success
            steps, t = steps + 1, result.t
        return steps


def direct_run() -> tuple[int, float]:
    """Steps from compiled code, and their time (s)."""
    run, _ = segment()
    began = time.perf_counter()
    run.run()
    return run.now.steps, time.perf_counter() - began


def wrapped_run() -> tuple[int, float]:
    """Steps through scikit-sundae, and their time (s)."""
    wrapped = Wrapped(segment()[1])
    began = time.perf_counter()
    return wrapped.run(), time.perf_counter() - began


def start_time(start: Callable[[], None]) -> float:
    """Time of a start (s)."""
    began = time.perf_counter()
    for _ in range(STARTS):
        start()
    return (time.perf_counter() - began) / STARTS


def main() -> None:
    """Print the table."""
    run, ida = segment()
    wrapped = Wrapped(ida)
    y = run._examined.y[0].copy()

    def direct_start() -> None:
        ida.start(run.mode, run.forcing, run.frame, y, run.atol)

    print("| way | steps | µs a step | µs a start |")
    print("| --- | --- | --- | --- |")
    for way, whole, start in (
        ("from compiled code, every step examined", direct_run, direct_start),
        ("through scikit-sundae, steps only", wrapped_run, wrapped.start),
    ):
        whole()
        steps, taken = sorted(whole() for _ in range(REPEATS))[REPEATS // 2]
        begun = statistics.median(start_time(start) for _ in range(REPEATS))
        print(f"| {way} | {steps} | {1e6 * taken / steps:.1f} | {1e6 * begun:.0f} |")


if __name__ == "__main__":
    main()
