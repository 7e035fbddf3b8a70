"""Values of storeys, and of the structures that have some."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import Value
from eventpound.quantities.runs import Runs
from eventpound.quantities.values import law_of, peak_size
from eventpound.scene.at_rest import theta_at_rest
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.scene.structures import distances, is_storey, neighbours, structures_of


def has_height(scene: Scene, i: int) -> bool:
    """Whether spring i has a height, over which its drift is told: a storey, or a pier."""
    return scene.springs[i].height is not None


def storeys_of_scene(scene: Scene) -> Iterator[int]:
    """Springs that are storeys."""
    return (i for i in range(len(scene.springs)) if is_storey(scene, i))


def storeys_of_structure(scene: Scene, i: int) -> list[int]:
    """Springs of structure i that are storeys."""
    group = set(structures_of(scene)[i])
    return [k for k in storeys_of_scene(scene) if group.intersection(scene.springs[k].ends)]


def has_floors(scene: Scene, i: int) -> bool:
    """Whether structure i has storeys."""
    return bool(storeys_of_structure(scene, i))


def storey_drift_ratio(many: Runs, i: int) -> Floats:
    """Largest drift ratio of the storeys of structure i."""
    storeys = storeys_of_structure(many.scene, i)
    return np.asarray(np.max([peak_drift_ratio(many, k) for k in storeys], axis=0))


def roof_drift(many: Runs, i: int) -> Floats:
    """Largest displacement of the floors of structure i that carry no storey (m)."""
    scene = many.scene
    level = distances([GROUND, *(s.name for s in scene.supports)], neighbours(scene.springs))
    storeys = [scene.springs[k].ends for k in storeys_of_structure(scene, i)]
    # The end that is farther from the ground stands on the other, in whichever order they are.
    pairs = [sorted(ends, key=lambda end: level.get(end, len(level))) for ends in storeys]
    carrying = {low for low, _ in pairs}
    floors = {high for _, high in pairs}
    roofs = (floors - carrying) or floors
    names = [body.name for body in scene.bodies]
    return np.asarray(np.max([peak_size(many.displacement, names.index(r)) for r in roofs], axis=0))


def has_storeys(scene: Scene, _: int) -> bool:
    """Whether a scene has storeys."""
    return any(True for _ in storeys_of_scene(scene))


def peak_drift_ratio(many: Runs, i: int) -> Floats:
    """Largest elongation of a spring over its height, NaN without one."""
    return peak_size(many.elongation, i) / (many.scene.springs[i].height or np.nan)


def has_weight(scene: Scene, i: int) -> bool:
    """Whether P-Delta softens spring i, which resists by itself."""
    return theta_at_rest(scene.springs[i]) is not None


def stability_coefficient(many: Runs, i: int) -> Floats:
    """P D/(V h) of a storey: V its resistance at the largest drift D when first loaded to there."""
    spring, x = many.scene.springs[i], peak_size(many.elongation, i)
    given = many.parameters.get(f"spring.{spring.name}.weight")
    weight = spring.geometric_stiffness if given is None else given / (spring.height or np.nan)
    secant = [law_of(many, i, n).secant(drift) for n, drift in enumerate(x.tolist())]
    return np.asarray(weight / np.array(secant) + 0.0 * x)


def largest_drift(many: Runs, _: int) -> Floats:
    """Largest elongation of all storeys (m)."""
    return _largest_of_storeys(many, lambda many, i: peak_size(many.elongation, i))


def largest_drift_ratio(many: Runs, _: int) -> Floats:
    """Largest drift ratio of all storeys."""
    return _largest_of_storeys(many, peak_drift_ratio)


def _largest_of_storeys(many: Runs, value: Value) -> Floats:
    return np.asarray(np.max([value(many, i) for i in storeys_of_scene(many.scene)], axis=0))
