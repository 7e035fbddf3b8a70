"""One random scene: is it in equilibrium, the same in other units, and does it stay there?"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from eventpound.errors import ComputationError, InputError
from eventpound.scene import Scene
from eventpound.scene.check import check_scene
from eventpound.scene.statics import in_equilibrium
from eventpound.solvers import solver_named, takes_points
from eventpound.solvers.base import Task
from tests.equilibria.oracle import judge, loose, room
from tests.equilibria.scenes import SI, Drawn

KN_MM = (1e3, 1.0 / 1.7, 3.0)
"""Units that are no powers of two of the first."""
LIMITS = {
    "unbalanced": 1e-9,
    "overlap": 1e-14,
    "farther": 1e-12,
    "units": 1e-10,
    "fast": 1e-10,
    "cvode": 1e-10,
}
"""Parts of the largest force or length that anything may be off."""


@dataclass
class Examined:
    """What was found of a scene."""

    word: str
    remark: str = ""
    numbers: dict[str, float] = field(default_factory=dict)

    @property
    def wrong(self) -> bool:
        """Whether something is."""
        return bool(self.remark)


def places(scene: Scene) -> np.ndarray:
    """Displacements of the bodies (N,)."""
    return np.array([body.displacement for body in scene.bodies])


def moved(standing: Scene, solver: str, period: float) -> float:
    """How far a scene moves that should not (m)."""
    held = solver_named(solver).solve(Task(standing, 0.0, 10.0 * period, 1e-12))
    u = places(standing)
    extremes = held.displacement.maximum - u, held.displacement.minimum - u
    return float(max(np.abs(each).max() for each in extremes))


def examine(
    seed: int, solvers: tuple[str, ...] = ("fast", "cvode"), memory: bool = False
) -> Examined:
    """Everything about a scene, perhaps one with soil, sliders and springs that degrade."""
    scene = drawn(seed, memory)
    try:
        standing = in_equilibrium(scene)
    except InputError as error:
        return _refused(scene, str(error))
    if loose(scene) is not None or not room(scene):
        return Examined("accepted", "nothing holds it, or it has no room")
    verdict = judge(scene, standing)
    numbers = {name: getattr(verdict, name) for name in ("unbalanced", "overlap", "farther")}
    length = max(np.abs(places(standing)).max(), 1e-3)
    other = places(in_equilibrium(drawn(seed, memory, KN_MM))) / KN_MM[0]
    numbers["units"] = float(np.abs(other - places(standing)).max() / length)
    try:
        check_scene(standing)
        for solver in solvers:
            if takes_points(solver_named(solver), scene):
                numbers[solver] = moved(standing, solver, 1.0) / length
    except (InputError, ComputationError) as error:
        return Examined("fails in a run", str(error), numbers)
    over = [f"{name} {value:.1e}" for name, value in numbers.items() if not value <= LIMITS[name]]
    return Examined("wrong" if over else "right", ", ".join(over), numbers)


def drawn(seed: int, memory: bool, units: Sequence[float] = SI) -> Scene:
    """A scene of a seed."""
    made = Drawn(seed, units)
    return made.with_memory() if memory else made.scene()


def _refused(scene: Scene, said: str) -> Examined:
    """Whether a refusal gives the true reason."""
    away = loose(scene)
    if "no room" in said:
        return Examined("no room", said if room(scene) else "")
    if "degrading springs bear" in said:
        return Examined("beyond what degrading springs bear")
    if "nothing holds" in said and away is not None:
        name = said.split("'")[1]
        i = [body.name for body in scene.bodies].index(name)
        return Examined("held by nothing", "" if away[i] != 0.0 else f"{said} ({away})")
    return Examined("refused without need", said)
