"""The forces on a single body (`eventpound.solvers.fast.single_model`) in its present state."""

from __future__ import annotations

from eventpound.mechanics.backbone import backbone
from eventpound.solvers.fast.backbone_parts import CORE, SATURATED, UNLOADING
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.plan import Hysteresis, State
from eventpound.solvers.fast.single_model import Oscillator


@compiled
def part_and_direction(oscillator: Oscillator, state: State) -> tuple[int, float]:
    """Part of the backbone, and direction of u on it; an elastic body is always in the core."""
    if oscillator.strength == 0.0:
        return CORE, 1.0
    return state.part[0], oscillator.side * state.sigma[0]


@compiled
def place_of(u: float, oscillator: Oscillator, state: State) -> float:
    """ξ of the hysteretic link at the displacement u (m)."""
    x = oscillator.side * u
    return state.xi_r[0] + state.sigma[0] * (x - state.x_r[0]) / oscillator.scale


@compiled
def spring_state(u: float, oscillator: Oscillator, hysteresis: Hysteresis, state: State) -> float:
    """``σ y`` at the displacement u (m), reached without reversal, in the direction of u."""
    if oscillator.strength == 0.0:
        return 0.0
    sigma = oscillator.side * state.sigma[0]
    if state.part[0] == SATURATED:
        return sigma
    xi = place_of(u, oscillator, state)
    if state.part[0] <= UNLOADING:
        return sigma * xi
    return sigma * backbone(hysteresis.tables, hysteresis.at[0], xi)


@compiled
def absolute_acceleration(u: float, v: float, z: float, oscillator: Oscillator) -> float:
    """Acceleration that the links give the body (m/s²)."""
    o = oscillator
    return o.pull - o.stiffness * u - o.damping * v - o.strength * z
