"""numbalsoda (LSODA from compiled code) with events written by hand, where it is installed.

numbalsoda integrates from one time to a list of times and knows no events. So, as a
careful user would: integrate over a stretch with outputs on a fine grid, look at the
signs of the gap and of the velocity there, and where one changes, integrate again from
the output before it to the root, by Newton's method. After an impact it starts anew, on a
grid that resolves the flight to come; a rebound slower than the tolerance is rest. All of
it is compiled, and the run is split where a pulse ends.

Needs ``pip install numbalsoda``, which builds with a Fortran compiler.
"""

from __future__ import annotations

import math
import time
from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np
from numba import carray, cfunc, njit

from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Task
from tests.benchmarks.oscillator import Oscillator, baseline_run, oscillator_of
from tests.benchmarks.scipy_baseline import BaselineRun

GRID = 64
"""Outputs in a period of the motion."""
STRETCH = 1.0
"""Length of a stretch in periods: what is beyond an impact was integrated for nothing."""
MOST_IMPACTS = 500
TRIALS, LEAST_SECONDS = 7, 5e-3
HEAD = 10
"""Numbers before the samples in what the right-hand side is given."""


@njit(inline="always")
def _ground(t: float, p: Floats) -> float:
    """Ground acceleration (m/s^2)."""
    count = int(p[8])
    if count > 0:
        place = t / p[9]
        i = min(max(int(place), 0), count - 2)
        first = p[HEAD + i]
        return first + (p[HEAD + i + 1] - first) * (place - i) if place < count - 1 else 0.0
    if p[7] != 0.0:
        return 0.0
    return p[4] * math.cos(p[6] * t) + p[5] * math.sin(p[6] * t)


@njit(inline="always")
def _rates(t: float, y: Floats, dy: Floats, p: Floats) -> None:
    """y = (u, v, z)."""
    z = y[2]
    z2 = z * z
    z4 = z2 * z2
    z8 = z4 * z4
    yielding = z8 * z8 * z4 if y[1] * z > 0.0 else 0.0
    dy[0] = y[1]
    dy[1] = -(p[1] * y[0] + p[2] * z) / p[0] - _ground(t, p)
    dy[2] = y[1] * (1.0 - yielding) / p[3]


@cache
def _solver() -> tuple[Any, int]:
    """The compiled loop and the address of the right-hand side."""
    import numbalsoda

    lsoda = numbalsoda.lsoda

    @cfunc(numbalsoda.lsoda_sig)
    def motion(t: float, y: Any, dy: Any, p: Any) -> None:
        head = carray(p, (HEAD,))
        samples = carray(p, (HEAD + int(head[8]),))
        _rates(t, carray(y, (3,)), carray(dy, (3,)), samples)

    @njit
    def root(address: int, t: float, y: Floats, guess: float, which: int, p: Floats,
             gap: float, rtol: float, atol: float) -> tuple[float, Floats]:  # fmt: skip
        """Length (s) from (t, y) to u = gap (which = 0) or v = 0 (1), and the state there."""
        s, times, dy = guess, np.empty(2), np.empty(3)
        state = y.copy()
        for _ in range(12):
            times[0], times[1] = t, t + s
            if times[1] - times[0] > 1e-12:
                state = lsoda(address, y, times, p, rtol, atol)[0][1]
            else:
                state = y.copy()
            _rates(t + s, state, dy, p)
            off = state[0] - gap if which == 0 else state[1]
            slope = dy[which] if dy[which] != 0.0 else 1e-300
            change = max(-off / slope, -0.9 * s)
            # By then the error of the last, quadratic piece is below rounding.
            if abs(change) < 1e-6:
                state[0] += change * (state[1] + 0.5 * change * dy[1])
                state[1] += change * dy[1]
                state[2] += change * dy[2]
                return s + change, state
            s += change
        return s, state

    @njit
    def release(t: float, stop: float, dt: float, y: Floats, p: Floats) -> float:
        """When a body resting at its barrier is let go: the force on it turns round."""
        dy = np.empty(3)
        low = t
        while low < stop:
            high = min(low + dt, stop)
            _rates(high, y, dy, p)
            if dy[1] < 0.0:
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    _rates(middle, y, dy, p)
                    if dy[1] < 0.0:
                        high = middle
                    else:
                        low = middle
                return high
            low = high
        return stop

    @njit
    def run(address: int, p: Floats, stops: Floats, period: float, gap: float,
            restitution: float, rtol: float, atol: float, slow: float, out: Floats,
            impacts: Floats) -> int:  # fmt: skip
        y, dy, t, count = np.zeros(3), np.empty(3), 0.0, 0
        lowest = highest = 0.0
        for piece in range(stops.size):
            stop = stops[piece]
            p[7] = float(piece)
            dt = fine = period / GRID
            while t < stop:
                _rates(t, y, dy, p)
                if y[0] == gap and y[1] == 0.0 and dy[1] > 0.0:
                    t = release(t, stop, dt, y, p)
                    continue
                if y[0] == gap and y[1] < 0.0 and dy[1] > 0.0:
                    fine = min(dt, -2.0 * y[1] / dy[1] / 8.0)
                many = min(int(period * STRETCH / dt), math.ceil((stop - t) / fine))
                times = t + fine * np.arange(many + 1)
                times[many] = min(times[many], stop)
                if stop - times[many] < 1e-9 * period:
                    times[many] = stop
                states, success = lsoda(address, y, times, p, rtol, atol)
                if not success:
                    out[0], out[1], out[2] = lowest, highest, y[0]
                    return -count - 1
                fine = dt
                hit = False
                for i in range(many):
                    u, v = states[i, 0], states[i, 1]
                    u1, v1 = states[i + 1, 0], states[i + 1, 1]
                    h = times[i + 1] - times[i]
                    if v * v1 < 0.0:
                        at, turned = root(address, times[i], states[i], h * v / (v - v1), 1, p,
                                          gap, rtol, atol)  # fmt: skip
                        if turned[0] <= gap:
                            lowest = min(lowest, turned[0])
                            highest = max(highest, turned[0])
                        elif u1 <= gap:
                            # In and out between two outputs.
                            u1 = turned[0]
                            h = at
                    lowest = min(lowest, u1)
                    if u1 > gap:
                        guess = h * (gap - u) / (u1 - u)
                        at, y = root(address, times[i], states[i], guess, 0, p, gap, rtol, atol)
                        t = times[i] + at
                        if count < impacts.shape[0]:
                            impacts[count, 0], impacts[count, 1] = t, y[1]
                        count += 1
                        y[0], y[1] = gap, -restitution * y[1]
                        if -y[1] < slow:
                            y[1] = 0.0
                        highest, hit = max(highest, gap), True
                        break
                    highest = max(highest, u1)
                if count >= impacts.shape[0]:
                    out[0], out[1], out[2] = lowest, highest, y[0]
                    return -count - 1
                if not hit:
                    t, y = times[many], states[many].copy()
        out[0], out[1], out[2] = lowest, highest, y[0]
        return count

    @njit
    def repeat(times: int, address: int, p: Floats, stops: Floats, period: float, gap: float,
               restitution: float, rtol: float, atol: float, slow: float, out: Floats,
               impacts: Floats) -> int:  # fmt: skip
        count = 0
        for _ in range(times):
            count = run(address, p, stops, period, gap, restitution, rtol, atol, slow, out, impacts)
        return count

    solve: Any = repeat
    # The function must outlive its address.
    solve.motion = motion
    return solve, motion.address


def _numbers(o: Oscillator) -> Floats:
    head = [o.mass, o.stiffness, o.strength, o.yield_displacement, o.cosine, o.sine, o.omega, 0.0]
    return np.array([*head, o.samples.size, o.sample_step, *o.samples])


class NumbaLsoda:
    """numbalsoda as a contender."""

    name = "numbalsoda"

    def missing(self) -> str:
        """Why it cannot run; empty where it can."""
        return "" if find_spec("numbalsoda") else "numbalsoda is not installed"

    def solve(self, task: Task, seconds: float) -> BaselineRun:
        """Run a task; impacts, not seconds, bound it."""
        out, impacts = np.zeros(3), np.zeros((MOST_IMPACTS, 2))
        count = self._run(task, 1, out, impacts)
        trouble = "" if count >= 0 else "LSODA gave up, or too many impacts"
        found = [(t, v) for t, v in impacts[: max(count, 0)].tolist()]
        return baseline_run((out[0], out[1]), out[2], found, trouble)

    def seconds(self, task: Task) -> float:
        """Wall time of a warm run (s), several within one compiled call."""
        out, impacts = np.zeros(3), np.zeros((MOST_IMPACTS, 2))
        best, repeats = math.inf, 1
        for _ in range(TRIALS):
            began = time.perf_counter()
            self._run(task, repeats, out, impacts)
            once = (time.perf_counter() - began) / repeats
            best, repeats = min(best, once), 1 + int(LEAST_SECONDS / once)
        return best

    def _run(self, task: Task, repeats: int, out: Floats, impacts: Floats) -> int:
        o = oscillator_of(task)
        if o is None:
            raise ValueError("not an oscillator at a barrier")
        solve, address = _solver()
        stops = np.array([o.end] if o.samples.size else o.breaks())
        period = o.sample_step * GRID if o.samples.size else 2.0 * math.pi / o.rate
        return int(
            solve(repeats, address, _numbers(o), stops, period, o.gap, o.restitution, task.rtol,
                  task.rtol * o.length, task.rtol * o.length * o.rate, out, impacts)
        )  # fmt: skip
