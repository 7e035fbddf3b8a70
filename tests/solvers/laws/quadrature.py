"""One impact of a free body of mass m under each law, by quadrature and closed forms.

With w = d'/d'_0 and the law ``m d'' = -F(d, d')``:

    linear, kelvin-voigt  d = e^(-ζωt) sin(ω_d t) v/ω_d; F from it; the contact ends at π/ω_d
    hertz, hertz-damp     d'^2 is separable: ∫ w dw/(1 + a w) = -(2k/5) d^2.5/(m v²), so that
                          the depth of every rate is known and t = ∫ dd/d' a quadrature
    jankowski             y' = -F(x, y)/m over the depth while approaching, elastic after

Nothing is taken from the program.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq, minimize_scalar


class Impact(NamedTuple):
    """Rate after over rate before, time in contact (s), largest and smallest force (N)."""

    restitution: float
    duration: float
    largest: float
    smallest: float
    depth: float


def kelvin_voigt(k: float, m: float, v: float, zeta: float) -> Impact:
    """Closed form, ζ < 1; linear with ζ = 0."""
    omega = math.sqrt(k / m)
    damped = omega * math.sqrt(1.0 - zeta**2)
    c = 2.0 * zeta * math.sqrt(k * m)

    def force(t: float) -> float:
        decay = v * math.exp(-zeta * omega * t)
        d = decay / damped * math.sin(damped * t)
        rate = decay * (math.cos(damped * t) - zeta * omega / damped * math.sin(damped * t))
        return k * d + c * rate

    end = math.pi / damped
    # F' = 0 where tan(ω_d t) = sqrt(1 - ζ²) (1 - 4ζ²)/(ζ (3 - 4ζ²)).
    across = math.sqrt(1.0 - zeta**2) * (1.0 - 4.0 * zeta**2)
    t = math.atan2(across, zeta * (3.0 - 4.0 * zeta**2)) / damped
    inner = [force(x) for x in (t, t + math.pi / damped) if 0.0 < x < end]
    forces = [force(0.0), force(end), *inner]
    turn = math.atan2(damped, zeta * omega) / damped
    depth = v * math.exp(-zeta * omega * turn) / damped * math.sin(damped * turn)
    return Impact(math.exp(-zeta * omega * end), end, max(forces), min(forces), depth)


def hertz(k: float, m: float, v: float, a: float) -> Impact:
    """Separated variables; a = 0 is undamped."""

    nodes, weights = np.polynomial.legendre.leggauss(40)

    def between(low: float, high: float) -> float:
        # ∫ x dx / (1 + a x): the closed form would cancel near the ends.
        x = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        return float(0.5 * (high - low) * (weights @ (x / (1.0 + a * x))))

    whole = between(0.0, 1.0)
    e = brentq(lambda x: between(0.0, -x) - whole, 1e-9, 1.0, xtol=1e-16, rtol=1e-15) if a else 1.0
    unit = (2.5 * m * v**2 / k) ** 0.4

    def depth(w: float) -> float:
        # From the nearer end.
        return unit * (between(w, 1.0) if w > 0.0 else between(w, -e)) ** 0.4

    def force(w: float) -> float:
        return k * depth(w) ** 1.5 * (1.0 + a * w)

    def near(end: float, sign: float) -> float:
        """Time between w = 0 and the end of the contact at w = `end` (s)."""

        # d^1.5 dd = -(m v²/k) w dw/(1 + a w) and dt = dd/d'. With w = end - sign s^2.5 the
        # factor s^1.5 of d^1.5 = (unit^2.5 s^2.5 mean)^0.6 is that of dw.
        def weighted(s: float) -> float:
            x = end - sign * s**2.5 * 0.5 * (1.0 + nodes)
            mean = abs(0.5 * weights @ (x / (1.0 + a * x)))
            w = end - sign * s**2.5
            return 2.5 * m * v / k / ((unit**2.5 * mean) ** 0.6 * (1.0 + a * w))

        return float(quad(weighted, 0.0, abs(end) ** 0.4, epsabs=0.0, epsrel=1e-12)[0])

    best = minimize_scalar(lambda w: -force(w), bounds=(-e, 1.0), options={"xatol": 1e-12})
    return Impact(e, near(1.0, 1.0) + near(-e, -1.0), max(-best.fun, force(0.0)), 0.0, depth(0.0))


def jankowski(k: float, m: float, v: float, xi: float) -> Impact:
    """The approach by an integrator, in the scaled form d'' = -d^1.5 - 2ξ d^0.25 d'."""
    unit = (m * v**2 / k) ** 0.4

    # x = s^4 with a time of its own, dt = s^3 dτ: nothing is singular at the closing.
    def rates(_: float, y: np.ndarray) -> list[float]:
        s, w, _ = y
        return [w / 4.0, -(s**9) - 2.0 * xi * s**4 * w, s**3]

    def stopped(_: float, y: np.ndarray) -> float:
        return float(y[1])

    stopped.terminal = True
    run = solve_ivp(
        rates,
        (0.0, 1e3),
        [0.0, 1.0, 0.0],
        method="DOP853",
        rtol=1e-13,
        atol=1e-15,
        events=stopped,
        dense_output=True,
    )
    s, _, time = run.y[:, -1]
    x = s**4

    def force(tau: float) -> float:
        s, w, _ = run.sol(tau)
        return float(s**6 + 2.0 * xi * s * w)

    best = minimize_scalar(
        lambda tau: -force(tau), bounds=(0.0, run.t[-1]), options={"xatol": 1e-12}
    )
    back = hertz(1.0, 1.0, math.sqrt(0.8 * x**2.5), 0.0)
    total = (time + 0.5 * back.duration) * unit / v
    return Impact(
        math.sqrt(0.8 * x**2.5), total, max(-best.fun, x**1.5) * k * unit**1.5, 0.0, x * unit
    )
