"""Derivatives of a linear motion with impacts, by SciPy and saltation matrices; no code shared.

The state x = (u, v) of bodies with masses M, stiffnesses K and dashpots C under a ground
acceleration follows x' = f(t, x, p). Its derivative S = dx/dp follows S' = f_x S + f_p between
impacts. At one, where the gap g(x, p) is zero, the state jumps to R(x, p), and S to

    R_x S + R_p + (R_x f- - f+) dt/dp,    dt/dp = -(g_x S + g_p) / (g_x f-).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}


@dataclass(frozen=True)
class LinearSystem:
    """One contact that closes as `direction` @ u reaches the gap.

    ``matrices(p)`` gives M (n,), K and C (n, n), gap and restitution; ``ground(t, p)`` the
    ground acceleration. All may depend on p.
    """

    matrices: Callable[[Array], tuple[Array, Array, Array, Any, Any]]
    ground: Callable[[float, Array], Any]
    direction: Array

    def rate(self, t: float, x: Array, p: Array) -> Array:
        """x'."""
        m, k, c, _, _ = self.matrices(p)
        u, v = np.split(x, 2)
        return np.concatenate((v, -(k @ u + c @ v) / m - self.ground(t, p)))

    def gap(self, x: Array, p: Array) -> Any:
        """g."""
        return self.matrices(p)[3] - self.direction @ x[: x.size // 2]

    def after(self, x: Array, p: Array) -> Array:
        """R."""
        m, _, _, _, e = self.matrices(p)
        u, v = np.split(x, 2)
        w = self.direction
        impulse = -(1.0 + e) * (w @ v) / (w @ (w / m))
        return np.concatenate((u, v + impulse * w / m))


def by_complex_step(of: Callable[[Any], Any], at: Array) -> Array:
    """Jacobian of an analytic function, exact to rounding."""
    step, columns = 1e-30, []
    for i in range(at.size):
        moved = at.astype(complex)
        moved[i] += 1j * step
        columns.append(np.imag(np.atleast_1d(of(moved))) / step)
    return np.array(columns).T


def through_impact(system: LinearSystem, t: float, x: Array, p: Array, s: Array) -> Array:
    """State and derivative after an impact, one behind the other."""
    before, after = system.rate(t, x, p), system.after(x, p)
    g_x = by_complex_step(lambda x: system.gap(x, p), x)
    g_p = by_complex_step(lambda p: system.gap(x, p), p)
    dt = -(g_x @ s + g_p) / (g_x @ before)
    r_x = by_complex_step(lambda x: system.after(x, p), x)
    r_p = by_complex_step(lambda p: system.after(x, p), p)
    jump = r_x @ before - system.rate(t, after, p)
    return np.concatenate((after, (r_x @ s + r_p + np.outer(jump, dt)).ravel()))


def final_sensitivity(
    system: LinearSystem, x: Array, p: Array, end: float
) -> tuple[Array, Array, int]:
    """State at the end, its derivative by p, (2n, parameters), and the number of impacts."""
    size, width = x.size, p.size

    def both(t: float, y: Array) -> Array:
        x, s = y[:size], y[size:].reshape(size, width)
        by_x = by_complex_step(lambda x: system.rate(t, x, p), x)
        by_p = by_complex_step(lambda p: system.rate(t, x, p), p)
        return np.concatenate((system.rate(t, x, p), (by_x @ s + by_p).ravel()))

    def closes(_: float, y: Array) -> float:
        return system.gap(y[:size], p)

    closes.terminal, closes.direction = True, -1.0
    t, y, impacts = 0.0, np.concatenate((x, np.zeros(size * width))), 0
    while True:
        found = solve_ivp(both, (t, end), y, events=closes, **TIGHT)
        t, y = float(found.t[-1]), found.y[:, -1]
        x, s = y[:size], y[size:].reshape(size, width)
        if t >= end:
            return x, s, impacts
        impacts += 1
        y = through_impact(system, t, x, p, s)
