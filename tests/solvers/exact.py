"""The elastic oscillator with a barrier, solved piece by piece in closed form.

    u'' + ω² u = -a_p sin(p t) for t < t_p, 0 after;  gap δ - u, γ⁺ = -ε γ⁻

Between impacts u is a sum of sines; an impact is a root of ``δ - u`` found by
bisection between samples too dense for two crossings.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq


@dataclass(frozen=True)
class Oscillator:
    """ω (rad/s), gap δ (m), ε, and a sine pulse of amplitude a_p and frequency p."""

    omega: float
    gap: float
    restitution: float
    a_p: float = 0.0
    p: float = 1.0

    @property
    def pulse_end(self) -> float:
        """One period of the pulse (s)."""
        return 2.0 * math.pi / self.p if self.a_p else 0.0

    def flow(self, t0: float, u0: float, v0: float, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacement and velocity at times on the same side of the pulse's end as t0."""
        D = -self.a_p / (self.omega**2 - self.p**2) if t0 < self.pulse_end else 0.0
        free_u = u0 - D * math.sin(self.p * t0)
        free_v = (v0 - D * self.p * math.cos(self.p * t0)) / self.omega
        c, s = np.cos(self.omega * (t - t0)), np.sin(self.omega * (t - t0))
        u = free_u * c + free_v * s + D * np.sin(self.p * t)
        v = self.omega * (free_v * c - free_u * s) + D * self.p * np.cos(self.p * t)
        return u, v

    def _closing(self, t0: float, u0: float, v0: float, end: float) -> float | None:
        """First time after t0 at which the gap closes, before `end`."""
        times = t0 + (end - t0) * np.linspace(0.0, 1.0, 4001)[1:]
        below = np.flatnonzero(self.gap - self.flow(t0, u0, v0, times)[0] < 0.0)
        if below.size == 0:
            return None
        i = int(below[0])
        low = float(times[i - 1]) if i else t0 + 1e-6 * (times[0] - t0)

        def gap(t: float) -> float:
            return self.gap - float(self.flow(t0, u0, v0, np.array(t))[0])

        return float(brentq(gap, low, float(times[i]), xtol=1e-15, rtol=1e-15))

    def solve(
        self, u: float, v: float, end: float
    ) -> tuple[list[float], list[float], float, float]:
        """Impact times and speeds before them, and the state at `end`."""
        t, times, speeds = 0.0, [], []
        while t < end:
            stop = self.pulse_end if t < self.pulse_end < end else end
            hit = self._closing(t, u, v, stop)
            new = stop if hit is None else hit
            u, v = (float(x) for x in self.flow(t, u, v, np.array(new)))
            t = new
            if hit is not None:
                times.append(t)
                speeds.append(v)
                u, v = self.gap, -self.restitution * v
            assert len(times) < 200, "this case accumulates impacts: no closed form"
        return times, speeds, u, v
