"""Equations of motion written anew with full matrices, straight from a scene.

    M u'' + C u' + Σ_s B_s F_s - W λ = -M 1 a_g,    Wᵀ u'' = 0 over the resting contacts

solved as one linear system for u'' and λ: no clusters, no links, no branches.
"""

from dataclasses import dataclass

import numpy as np

from eventpound.mechanics.link_law import link_law
from eventpound.scene import BARRIER, GROUND, BilinearElastic, BoucWen, Linear, Scene


def spring_force(law: Linear | BilinearElastic | BoucWen, x: float, z: float = 0.0) -> float:
    """Force (N) of a law at an elongation x (m)."""
    if isinstance(law, Linear):
        return law.stiffness * x
    if isinstance(law, BilinearElastic):
        return (law.compression if x < law.offset else law.extension) * (x - law.offset)
    return law.stiffness * x + law.strength * z


def memory_of(n: float, beta: float, gamma: float, yield_displacement: float = 1.0) -> np.ndarray:
    """Constants of one Bouc-Wen law of unit strength, as solvers hold them."""
    return link_law([BoucWen(0.0, 1.0, yield_displacement, n, beta, gamma)], [0.0]).memory


def literal_z_rate(law: BoucWen, x_rate: float, z: float) -> float:
    """Eq. 3 of the founding paper as printed."""
    n = law.exponent
    hardening = law.gamma * abs(x_rate) * z * abs(z) ** (n - 1.0)
    return (x_rate - hardening - law.beta * x_rate * abs(z) ** n) / law.yield_displacement


def direction(scene: Scene, first: str, second: str) -> np.ndarray:
    """+1 at the second end, -1 at the first, nothing for ground and barrier."""
    column = np.zeros(len(scene.bodies))
    for name, sign in ((first, -1.0), (second, 1.0)):
        if name not in (GROUND, BARRIER):
            column[[b.name for b in scene.bodies].index(name)] += sign
    return column


@dataclass(frozen=True)
class Answer:
    """Rates of one instant: u'' (N,), λ (R,), z' (H,), and the three ledger rates (W)."""

    acceleration: np.ndarray
    contact_force: np.ndarray
    z_rate: np.ndarray
    ledger: np.ndarray


def rates(
    scene: Scene, resting: list[int], ground: float, u: np.ndarray, v: np.ndarray, z: np.ndarray
) -> Answer:
    """Everything that follows from a state with the given contacts at rest."""
    mass = np.array([b.mass for b in scene.bodies])
    force = -mass * ground
    z_rates, viscous, hysteretic = [], 0.0, 0.0
    for spring in scene.springs:
        B = direction(scene, *spring.between)
        own = 0.0
        if isinstance(spring.law, BoucWen):
            own = z[len(z_rates)]
            z_rates.append(literal_z_rate(spring.law, B @ v, own))
            hysteretic += spring.law.strength * own * (B @ v)
        force -= B * spring_force(spring.law, B @ u, own)
    for dashpot in scene.dashpots:
        B = direction(scene, *dashpot.between)
        force -= B * dashpot.coefficient * (B @ v)
        viscous += dashpot.coefficient * (B @ v) ** 2
    contacts = [scene.contacts[j] for j in resting]
    W = np.array([direction(scene, c.left, c.right) for c in contacts]).reshape(-1, mass.size).T
    size = mass.size + W.shape[1]
    saddle = np.zeros((size, size))
    saddle[: mass.size, : mass.size] = np.diag(mass)
    saddle[: mass.size, mass.size :] = -W
    saddle[mass.size :, : mass.size] = W.T
    # Least squares, since the forces of a locked group are not unique.
    answer = np.linalg.lstsq(saddle, np.concatenate((force, np.zeros(W.shape[1]))), rcond=1e-13)[0]
    ledger = np.array([-(mass @ v) * ground, viscous, hysteretic])
    return Answer(answer[: mass.size], answer[mass.size :], np.array(z_rates), ledger)
