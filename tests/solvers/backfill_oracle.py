"""Bodies between soils by SciPy with events: soil remembers its deepest point, and no z.

A soil is apart, inside what it has been pushed to, or pushed further: on its backbone. Nothing
here is taken from the package but the numbers of a scene and the acceleration of the ground.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

from eventpound.scene import Backfill, Linear, Scene

APART, INSIDE, PUSHED = range(3)
TOLERANCE = 1e-12
NOISE = 1e-13
"""By how much (m, m/s) a value passes zero before it counts, so that none is passed twice."""
MOST_IMPACTS = 200
MOST_STEPS = 2000
"""A run has more: SciPy does not see what begins and ends within one."""


@dataclass
class Soil:
    """One spring: its row of B, its law, how deep it was pushed (m), and where it is now."""

    row: np.ndarray
    law: Backfill
    deepest: float = 0.0
    state: int = APART

    def backbone(self, y: float) -> float:
        """Force at a depth that is new (N)."""
        law = self.law
        return y / (1.0 / law.initial_stiffness + law.failure_ratio * y / law.ultimate_force)

    @property
    def left(self) -> float:
        """Depth at which it is touched again (m)."""
        return self.deepest - self.backbone(self.deepest) / self.law.initial_stiffness

    def depth(self, u: np.ndarray) -> float:
        """How deep it is pushed beyond the gap (m)."""
        return -float(self.row @ u) - self.law.gap

    def push(self, u: np.ndarray) -> float:
        """Force of the present state, continued (N)."""
        if self.state == APART:
            return 0.0
        if self.state == PUSHED:
            return self.backbone(self.depth(u))
        return self.law.initial_stiffness * (self.depth(u) - self.left)

    def turn(self, which: int, u: np.ndarray) -> None:
        """Go on after its event of a number."""
        if self.state == APART:
            self.state = INSIDE if self.deepest > 0.0 else PUSHED
        elif self.state == PUSHED:
            self.deepest, self.state = self.depth(u), INSIDE
        else:
            self.state = (APART, PUSHED)[which]

    def events(self, n: int) -> list:
        """Functions that fall through zero where its state ends."""
        if self.state == APART:
            return [lambda t, y: self.left - self.depth(y[:n]) + NOISE]
        if self.state == PUSHED:
            return [lambda t, y: NOISE - float(self.row @ y[n:])]
        return [
            lambda t, y: self.depth(y[:n]) - self.left + NOISE,
            lambda t, y: self.deepest - self.depth(y[:n]) + NOISE,
        ]


@dataclass
class Answer:
    """Final state, times of changes of soils (s) and of impacts (s), the soils at the end.

    Also when which soil was touched (-1) or left (1).
    """

    u: np.ndarray
    v: np.ndarray
    turns: list[float] = field(default_factory=list)
    impacts: list[float] = field(default_factory=list)
    touched: list[tuple[float, int, int]] = field(default_factory=list)
    soils: list[Soil] = field(default_factory=list)


def solved(scene: Scene, end: float, corners: tuple[float, ...] = ()) -> Answer:
    """The scene from rest to `end` (s), whose motion has corners at some times."""
    names = [body.name for body in scene.bodies]
    n, mass = len(names), np.array([body.mass for body in scene.bodies])

    def row(ends: tuple[str, str]) -> np.ndarray:
        found = np.zeros(n)
        for end_name, sign in zip(ends, (-1.0, 1.0), strict=True):
            if end_name in names:
                found[names.index(end_name)] += sign
        return found

    stiffness, damping = np.zeros((n, n)), np.zeros((n, n))
    soils = []
    for spring in scene.springs:
        B = row(spring.between)
        if isinstance(spring.law, Backfill):
            soils.append(Soil(B, spring.law))
        else:
            assert isinstance(spring.law, Linear)
            stiffness += spring.law.stiffness * np.outer(B, B)
    for dashpot in scene.dashpots:
        B = row(dashpot.between)
        damping += dashpot.coefficient * np.outer(B, B)
    contacts = [(row((c.left, c.right)), c.gap, c.restitution) for c in scene.contacts]

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        u, v = y[:n], y[n:]
        force = -stiffness @ u - damping @ v
        for soil in soils:
            force = force + soil.push(u) * soil.row
        ground = float(scene.motion.acceleration(np.array(t)))
        return np.concatenate((v, force / mass - ground))

    u0 = np.array([body.displacement for body in scene.bodies])
    v0 = np.array([body.velocity for body in scene.bodies])
    answer = Answer(u0, v0, soils=soils)
    for soil in soils:
        if soil.depth(u0) > 0.0:
            soil.deepest = soil.depth(u0)
            soil.state = INSIDE if float(soil.row @ v0) > 0.0 else PUSHED
    y, t = np.concatenate((u0, v0)), 0.0
    for stop in [*(c for c in corners if 0.0 < c < end), end]:
        while t < stop:
            events, owners = [], []
            for s, soil in enumerate(soils):
                for which, function in enumerate(soil.events(n)):
                    events.append(function)
                    owners.append(("soil", s, which))
            for c, (W, gap, _) in enumerate(contacts):
                events.append(lambda t, y, W=W, gap=gap: gap + float(W @ y[:n]) + NOISE)
                owners.append(("contact", c, 0))
            for function in events:
                function.terminal, function.direction = True, -1.0  # type: ignore[attr-defined]
            tolerances = {"rtol": TOLERANCE, "atol": 1e-15, "max_step": end / MOST_STEPS}
            run = solve_ivp(rate, (t, stop), y, "DOP853", events=events, **tolerances)
            t, y = float(run.t[-1]), run.y[:, -1]
            for (kind, i, which), times in zip(owners, run.t_events, strict=True):
                if times.size == 0:
                    continue
                if kind == "soil":
                    apart = soils[i].state == APART
                    soils[i].turn(which, y[:n])
                    answer.turns.append(t)
                    if apart != (soils[i].state == APART):
                        answer.touched.append((t, i, -1 if apart else 1))
                else:
                    W, _, restitution = contacts[i]
                    impulse = -(1.0 + restitution) * float(W @ y[n:]) / float(W @ (W / mass))
                    y = np.concatenate((y[:n], y[n:] + impulse * W / mass))
                    answer.impacts.append(t)
                    if len(answer.impacts) > MOST_IMPACTS:
                        raise ArithmeticError("impacts accumulate")
                    for soil in soils:
                        if soil.state == PUSHED and float(soil.row @ y[n:]) > 0.0:
                            soil.turn(0, y[:n])
    answer.u, answer.v = y[:n], y[n:]
    return answer
