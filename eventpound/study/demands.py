"""What is decided by the numbers of a scene: its elements by kind, and what is asked of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from eventpound.case.run_options import Stated
from eventpound.quantities.base import TakenFrom
from eventpound.quantities.decks import translates
from eventpound.quantities.listed import LISTED
from eventpound.quantities.lookup import Named, all_of, asked_of, unstated
from eventpound.quantities.owners import owners_of
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Backfill, BoucWen, Hysteretic, Slider
from eventpound.scene.structures import is_storey

_CONTACT, _SPRING = "contacts.<contact>.", "springs.<spring>."
NEEDED = _CONTACT + "separation_needed"
"""The gap with which nothing touches, of a joint."""
_FORCE, _ENERGY = _CONTACT + "max_force", _SPRING + "dissipated_energy"
_RESIDUALS = _SPRING + "residual_elongation", "residual.<body>"
_FASTER = _CONTACT + "impacts_faster"
STOREY_DRIFT = ".storey_drift_ratio"
"""Ends the name of the largest drift of a structure."""
_FORCED = "abs_max_force"


def _paths(owner: str, words: str) -> tuple[str, ...]:
    """Paths by the last words of quantities of springs or contacts."""
    return tuple(f"{owner}s.<{owner}>.{word}" for word in words.split())


def _of_law(*kinds: type) -> Callable[[Scene, int], bool]:
    """Whether a spring has such a law, and is no storey."""

    def has(scene: Scene, i: int) -> bool:
        return isinstance(scene.springs[i].law, kinds) and not is_storey(scene, i)

    return has


def _elastic(compression: bool, extension: bool) -> Callable[[Scene, int], bool]:
    """Whether an elastic spring, no storey, resists on these sides."""

    def has(scene: Scene, i: int) -> bool:
        spring = scene.springs[i]
        if isinstance(spring.law, Hysteretic) or is_storey(scene, i):
            return False
        own = reduced(spring.law)
        return (own.compression > 0.0, own.extension > 0.0) == (compression, extension)

    return has


@dataclass(frozen=True)
class ElementKind:
    """Elements of one kind, and what is asked of them.

    Parameters
    ----------
    name : str
        Heading.
    demands : tuple of str
        Quantities by paths, in their order; all of one kind of owner.
    has : callable
        Whether owner i of a scene is of this kind.
    """

    name: str
    demands: tuple[str, ...]
    has: Callable[[Scene, int], bool] = lambda scene, i: True


KINDS = (
    ElementKind("Joints", (NEEDED,)),
    ElementKind("Seats", ("seats.<seat>.max_opening",)),
    ElementKind(
        "Contacts",
        _paths(
            "contact",
            "avoiding_gap avoiding_gap_alone absolute_sum srss cqc largest_gap seat_used impacts "
            "impacts_faster fastest_closing max_impulse estimated_force max_force largest_overlap",
        ),
    ),
    ElementKind("Structure", ("base_shear.abs_max", "base_shear_across.abs_max")),
    ElementKind(
        "Structures",
        _paths(
            "structure",
            "abs_max_base_shear abs_max_base_shear_across roof_drift storey_drift_ratio",
        ),
    ),
    ElementKind(
        "Piers and other yielding springs",
        _paths(
            "spring",
            f"{_FORCED} ductility drift_ratio abs_max_elongation residual_elongation "
            "stability_coefficient strength_lost stiffness_lost dissipated_energy",
        ),
        _of_law(BoucWen),
    ),
    ElementKind(
        "Sliding bearings",
        _paths(
            "spring",
            f"abs_max_elongation {_FORCED} slip_path residual_elongation dissipated_energy",
        ),
        _of_law(Slider),
    ),
    ElementKind(
        "Bearings and other elastic springs",
        _paths("spring", f"abs_max_elongation {_FORCED} drift_ratio stability_coefficient"),
        _elastic(compression=True, extension=True),
    ),
    ElementKind(
        "Restrainers",
        _paths("spring", f"{_FORCED} slack_left"),
        _elastic(compression=False, extension=True),
    ),
    ElementKind(
        "Stops",
        _paths("spring", f"{_FORCED} slack_left"),
        _elastic(compression=True, extension=False),
    ),
    ElementKind(
        "Backfill",
        _paths("spring", "passive_depth passive_force residual_gap dissipated_energy"),
        _of_law(Backfill),
    ),
    ElementKind(
        "Storeys",
        _paths(
            "spring",
            f"drift_ratio abs_max_elongation {_FORCED} ductility residual_elongation "
            "stability_coefficient strength_lost stiffness_lost",
        ),
        is_storey,
    ),
    ElementKind("Decks", _paths("deck", "abs_max_rotation")),
    ElementKind(
        "Bodies",
        ("peaks.<body>.abs_max", "residual.<body>", "acceleration.<body>.abs_max"),
        translates,
    ),
)
"""Kinds of elements, in the order of a report."""
_OTHERS = ElementKind("Asked for in the case", ())
"""By its capacities, and by ``quantities`` of ``[run]``."""
DEMANDS = tuple(dict.fromkeys(path for kind in KINDS for path in kind.demands))
_LISTED = [q for q in LISTED if q.path in DEMANDS]


@dataclass(frozen=True)
class Demand:
    """A quantity of an element, with its kind."""

    kind: ElementKind
    named: Named


def demands_of(scene: Scene, stated: Stated) -> list[Demand]:
    """Design numbers that a scene has, by kinds of elements, then by elements."""
    there = [n for n in all_of(scene, _LISTED) if not unstated(n.name, stated)]
    found = [
        Demand(kind, named)
        for kind in KINDS
        for named in there
        if named.quantity.path in kind.demands
        and kind.has(scene, named.i)
        and _says_something(scene, named)
    ]
    capacities = [name for name, _ in stated.capacities]

    def place(demand: Demand) -> tuple[int, int, int]:
        path = demand.named.quantity.path
        return KINDS.index(demand.kind), demand.named.i, demand.kind.demands.index(path)

    found = sorted(found, key=place)
    named = {demand.named.name for demand in found}
    words = [word for word in (*capacities, *stated.quantities) if word not in named]
    others = {other.name: other for word in words for other in asked_of(scene, word)}
    return found + [Demand(_OTHERS, other) for name, other in others.items() if name not in named]


def _says_something(scene: Scene, named: Named) -> bool:
    """Whether a number is one of design, of its owner."""
    path = named.quantity.path
    if path == _FORCE:
        # Without a law of its own a contact has a force at rest only.
        return scene.contacts[named.i].law is not None
    if path == _ENERGY:
        # Of others it takes further runs.
        return named.quantity.source is TakenFrom.LAWS
    if path == _RESIDUALS[0]:
        # What an elastic spring has left is what still swings.
        return isinstance(scene.springs[named.i].law, Hysteretic)
    if path == _RESIDUALS[1]:
        return any(isinstance(spring.law, Hysteretic) for spring in scene.springs)
    return True


def words_of(scene: Scene, demand: Demand, stated: Stated) -> dict[str, object]:
    """What a demand is, of what, and its unit."""
    named, quantity = demand.named, demand.named.quantity
    called = quantity.called
    if quantity.path == _FASTER:
        called = f"impacts {stated.faster}"
    return {
        "kind": demand.kind.name,
        "quantity": named.name,
        "of": owners_of(scene, quantity.owner)[named.i],
        "demand": called,
        "unit": quantity.dimension.unit,
    }
