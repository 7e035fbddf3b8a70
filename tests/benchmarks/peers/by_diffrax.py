"""diffrax: Runge-Kutta of order 8 in JAX, compiled once, called again from event to event."""

from typing import Any

import diffrax as dx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx

from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Task
from tests.benchmarks.answers import Answer
from tests.benchmarks.peers.rules import OF_A_BODY, Modes, Row
from tests.benchmarks.scipy_baseline import tolerances

jax.config.update("jax_enable_x64", True)
LEAST = 1e-15
MOST_STEPS = 100_000
ROOTS = 1e-13
FAR = 2.0
"""Where |z| is cut in z^20: a trial step lands anywhere."""


class Diffrax:
    """A program for one problem under a pulse, whose bodies do not stay at a barrier."""

    def __init__(self, task: Task) -> None:
        self.row = Row(task)
        self._go = jax.jit(_stretch_of(self.row, task.rtol, tolerances(task.scene, task.rtol)))

    def run(self) -> Answer:
        """Run it."""
        row, modes, n = self.row, Modes(self.row), len(self.row.m)
        t, y = 0.0, np.zeros(3 * n)
        modes.begin(0.0, y, row.stretches[0])
        _lift(y, modes)
        for stretch in row.stretches:
            while t < stretch.end:
                now = (modes.loading, modes.flowing, modes.way, modes.side)
                t, y, first = self._go(t, stretch.end, y, np.array(now), stretch.A)
                t, y, first = float(t), np.array(y), int(first)
                if t < stretch.end:
                    kind, i = divmod(first, n)
                    event = OF_A_BODY * i + kind if kind < 2 else OF_A_BODY * n + first - 2 * n
                    modes.happens(event, t, y, stretch)
                    _lift(y, modes)
        return modes.answer(y)


def _lift(y: Any, modes: Modes) -> None:
    """Begin on the right side of what has just been zero."""
    n, row = len(modes.way), modes.row
    for i in range(n):
        y[n + i] = modes.way[i] * max(modes.way[i] * y[n + i], LEAST)
        y[2 * n + i] = modes.side[i] * max(modes.side[i] * y[2 * n + i], LEAST)
    for (left, right), gap in zip(row.ends, row.gaps, strict=True):
        y[left] = min(y[left], gap + (y[right] if right >= 0 else 0.0) - LEAST)


def _stretch_of(row: Row, rtol: float, atol: Floats) -> Any:
    n = len(row.m)
    m, k, Q, u_y = (jnp.array(x) for x in (row.m, row.k, row.Q, row.u_y))
    contacts = list(zip(row.ends, row.gaps, strict=True))

    def field(t: Any, y: Any, args: Any) -> Any:
        (loading, flowing, _, _), A = args
        u, v, z = y[:n], y[n : 2 * n], y[2 * n :]
        a_g = A * jnp.cos(row.omega * t + row.phase)
        z_rate = flowing * v / u_y * (1.0 - loading * jnp.clip(z, -FAR, FAR) ** 20)
        return jnp.concatenate((v, -(k * u + Q * z) / m - a_g, z_rate))

    def nearest(t: Any, y: Any, args: Any, **_: Any) -> Any:
        (_, _, way, side), _ = args
        # One condition: of several in one step it would not take the first.
        gaps = [gap - y[a] + (y[b] if b >= 0 else 0.0) for (a, b), gap in contacts]
        return jnp.concatenate((way * y[n : 2 * n], side * y[2 * n :], jnp.array(gaps)))

    event = dx.Event(
        lambda *args, **kwargs: nearest(*args, **kwargs).min(), optx.Bisection(ROOTS, ROOTS), False
    )
    control = dx.PIDController(rtol=rtol, atol=jnp.array(atol))

    def go(t: Any, end: Any, y: Any, modes: Any, A: Any) -> Any:
        found = dx.diffeqsolve(
            *(dx.ODETerm(field), dx.Dopri8(), t, end, None, y, (modes, A)),
            stepsize_controller=control,
            event=event,
            max_steps=MOST_STEPS,
        )
        t, y = found.ts[-1], found.ys[-1]
        return t, y, jnp.argmin(nearest(t, y, (modes, A)))

    return go
