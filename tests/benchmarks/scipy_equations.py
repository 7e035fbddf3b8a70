"""The equation of motion as someone would write it for SciPy's `solve_ivp`.

    y = (u, v, z),    u' = v,    m v' = -k x - Q z - c x' - m a_g(t)
    z' = (x'/u_y) (1 - (beta + gamma sgn(x' z)) |z|^n)

in plain Python numbers: for up to the eight bodies of the cases a loop over the
springs takes 3 to 7 microseconds a call where NumPy, all springs at once, takes
8 to 15. One body on one spring is written out.
"""

import math
from collections.abc import Callable

from eventpound.motion.base import Family, Piece
from eventpound.numerics.arrays import Floats
from eventpound.scene import GROUND, BoucWen, Linear, Scene
from eventpound.scene.elastic_laws import reduced

Ground = Callable[[float], float]
Rates = Callable[[float, Floats], list[float]]

FAR = 10.0
"""Where |z| is cut in |z|^n: a trial step of an explicit method lands anywhere, and
plain numbers overflow. Such a step is refused anyway."""


def ground(piece: Piece) -> Ground:
    """The ground acceleration of one piece (m/s^2) as a function of time (s)."""
    numbers = piece.coefficients.tolist()
    if piece.family is Family.ZERO:
        return lambda t: 0.0
    if piece.family is Family.GAUSSIAN:
        center, q, c0, c1, c2, c3 = numbers

        def bell(t: float) -> float:
            s = t - center
            return (c0 + s * (c1 + s * (c2 + s * c3))) * math.exp(-q * s * s)

        return bell
    if piece.family is Family.SAMPLES:
        start, step = numbers
        return _record(start, step, piece.samples.tolist())
    start, waves = numbers[0], list(zip(*(numbers[i::3] for i in (1, 2, 3)), strict=True))
    if len(waves) == 1:
        ((amplitude, omega, phase),) = waves
        return lambda t: amplitude * math.cos(omega * (t - start) + phase)
    return lambda t: sum(a * math.cos(w * (t - start) + p) for a, w, p in waves)


def _record(start: float, step: float, samples: list[float]) -> Ground:
    last = len(samples) - 2

    def between(t: float) -> float:
        place = (t - start) / step
        i = min(max(int(place), 0), last)
        return samples[i] + (samples[i + 1] - samples[i]) * (place - i)

    return between


def rates(scene: Scene, acceleration: Ground) -> Rates:
    """y' as a function of t (s) and y = (u, v, z) of the whole scene."""
    if len(scene.bodies) == len(scene.springs) == 1 and scene.springs[0].between[0] == GROUND:
        law = scene.springs[0].law
        if isinstance(law, Linear):
            return _elastic_oscillator(scene, law, acceleration)
        if isinstance(law, BoucWen):
            return _hysteretic_oscillator(scene, law, acceleration)
    return _structure(scene, acceleration)


def _elastic_oscillator(scene: Scene, law: Linear, acceleration: Ground) -> Rates:
    m, k = scene.bodies[0].mass, law.stiffness
    c = sum(dashpot.coefficient for dashpot in scene.dashpots)

    def motion(t: float, y: Floats) -> list[float]:
        u, v = y.tolist()
        return [v, -(k * u + c * v) / m - acceleration(t)]

    return motion


def _hysteretic_oscillator(scene: Scene, law: BoucWen, acceleration: Ground) -> Rates:
    m, k, q, u_y = scene.bodies[0].mass, law.stiffness, law.strength, law.yield_displacement
    c = sum(dashpot.coefficient for dashpot in scene.dashpots)
    n, beta, gamma = law.exponent, law.beta, law.gamma

    def motion(t: float, y: Floats) -> list[float]:
        u, v, z = y.tolist()
        kappa = beta + gamma if v * z > 0.0 else beta - gamma
        z_rate = v * (1.0 - kappa * min(abs(z), FAR) ** n) / u_y
        return [v, -(k * u + q * z + c * v) / m - acceleration(t), z_rate]

    return motion


def _structure(scene: Scene, acceleration: Ground) -> Rates:
    count = len(scene.bodies)
    place = {body.name: i for i, body in enumerate(scene.bodies)}
    # The ground stands behind the last body; its displacement and velocity are zero.
    place[GROUND] = count

    def ends(between: tuple[str, str]) -> tuple[int, int]:
        return place[between[0]], place[between[1]]

    yielding = [(*ends(s.between), s.law) for s in scene.springs if isinstance(s.law, BoucWen)]
    hysteretic = [
        (a, b, law.stiffness, law.strength, law.yield_displacement, law.exponent, law.beta,
         law.gamma) for a, b, law in yielding
    ]  # fmt: skip
    curves = [
        (*ends(s.between), reduced(s.law)) for s in scene.springs if not isinstance(s.law, BoucWen)
    ]
    elastic = [(a, b, law.offset, law.compression, law.extension) for a, b, law in curves]
    viscous = [(*ends(d.between), d.coefficient) for d in scene.dashpots]
    mass = [body.mass for body in scene.bodies]

    def motion(t: float, y: Floats) -> list[float]:
        state = y.tolist()
        u, v, z = [*state[:count], 0.0], [*state[count : 2 * count], 0.0], state[2 * count :]
        force = [0.0] * (count + 1)
        for i, (a, b, k, q, u_y, n, beta, gamma) in enumerate(hysteretic):
            x_rate, z_i = v[b] - v[a], z[i]
            pull = k * (u[b] - u[a]) + q * z_i
            force[a] += pull
            force[b] -= pull
            kappa = beta + gamma if x_rate * z_i > 0.0 else beta - gamma
            z[i] = x_rate * (1.0 - kappa * min(abs(z_i), FAR) ** n) / u_y
        for a, b, offset, compression, extension in elastic:
            x = u[b] - u[a] - offset
            pull = (compression if x < 0.0 else extension) * x
            force[a] += pull
            force[b] -= pull
        for a, b, c in viscous:
            pull = c * (v[b] - v[a])
            force[a] += pull
            force[b] -= pull
        a_g = acceleration(t)
        return v[:count] + [f / m - a_g for f, m in zip(force, mass, strict=False)] + z

    return motion
