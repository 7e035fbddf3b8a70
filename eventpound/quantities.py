"""Every number of a run that tables, figures and messages know: one list.

From `LISTED` are made ``summary.json``, the tables of suites, studies and `simulate_many`,
``Response.summary``, the labels of figures, suggestions and ``docs/quantities.md``. A path
holds the kind of its owner in angle brackets, ``peaks.<body>.max``; a name has the owner's
own, ``peaks.deck.max``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.motion.base import Scales
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen
from eventpound.solvers.base import Event, EventKind, Extremes, Recording
from eventpound.units import Dimension

if TYPE_CHECKING:
    from eventpound.many_response import Many

FREE = "free."
"""Before the name of a quantity of the same scene without contact."""


class Source(StrEnum):
    """What a quantity is taken from."""

    EXTREMES = "every run"
    ACCELERATIONS = "every run; of many, where accelerations are asked for"
    EVENTS = "every run; of many, where it is named"
    ENERGY = "the ledger (energy = true)"
    FREE = "one more run, without contact, where it is named"


_FROM_ONE = (Source.EVENTS, Source.ENERGY)
"""What needs all of a run, not its extremes only."""

Value = Callable[["Many", int], Any]
"""Values of a quantity of owner i in n runs, shape (n,)."""


def _always(_scene: Scene, _i: int) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class Quantity:
    """One entry of the list.

    Parameters
    ----------
    path : str
        Where it stands, as ``contacts.<contact>.smallest_gap``.
    called : str
        What an axis calls it, perhaps with mathtext.
    dimension : Dimension
        Its unit, and what makes a Π-term of it (`pi_unit`).
    text : str
        What it is, a sentence.
    value : callable
        How it is computed.
    source : Source
        What from.
    only : callable
        Whether owner i of a scene has it.
    kind : type
        ``float``, ``int`` of a count, ``bool`` of a flag.
    tabled : bool
        Whether it stands in tables without being named.
    six : str
        Of the six numbers of an extreme, their paths with ``*`` in the place of `SIX`.
    """

    path: str
    called: str
    dimension: Dimension
    text: str
    value: Value
    source: Source = Source.EXTREMES
    only: Callable[[Scene, int], bool] = _always
    kind: type = float
    tabled: bool = True
    six: str = ""

    @property
    def owner(self) -> str:
        """Kind of its owner, as ``body``; empty where that is the run."""
        return self.path.partition("<")[2].partition(">")[0]

    def name(self, owner: str) -> str:
        """Its name, of one owner."""
        return self.path.replace(f"<{self.owner}>", owner) if self.owner else self.path


@dataclass(frozen=True, slots=True)
class Named:
    """A quantity of one owner of a scene."""

    name: str
    quantity: Quantity
    i: int

    def of(self, many: Many) -> Floats:
        """Its values, shape (n,)."""
        values = np.asarray(self.quantity.value(many, self.i))
        return values if values.ndim else np.broadcast_to(values, many.t.shape)

    def of_one(self, many: Many) -> float | int | bool | None:
        """Its value in the only run; None where it has none."""
        value = float(self.of(many)[0])
        return None if np.isnan(value) else self.quantity.kind(value)


def owners(scene: Scene, kind: str) -> Sequence[str]:
    """Names of the parts of a scene that are of a kind; one without a name for the run."""
    return {
        "": [""],
        "body": [body.name for body in scene.bodies],
        "spring": [spring.name for spring in scene.springs],
        "contact": [contact.name for contact in scene.contacts],
    }[kind]


def tabled(many: Many) -> Iterator[Named]:
    """Quantities that stand in the table of some runs without being named."""
    there = {Source.EXTREMES}
    if many.acceleration is not None:
        there.add(Source.ACCELERATIONS)
    if many.recordings:
        there.add(Source.EVENTS)
        if many.recordings[0].energy is not None:
            there.add(Source.ENERGY)
    for named in all_of(many.scene):
        if named.quantity.tabled and named.quantity.source in there:
            yield named


def all_of(scene: Scene) -> Iterator[Named]:
    """Every quantity of a scene, in the order of the list."""
    for quantity in LISTED:
        for i, owner in enumerate(owners(scene, quantity.owner)):
            if quantity.only(scene, i):
                yield Named(quantity.name(owner), quantity, i)


def names_of(scene: Scene) -> list[str]:
    """Names of every quantity of a scene, those without contact last."""
    own = [named.name for named in all_of(scene)]
    free = [
        FREE + named.name
        for named in all_of(scene)
        if named.quantity.owner != "contact" and named.quantity.source is not Source.FREE
    ]
    return own + free


def find(scene: Scene, name: str) -> Named | None:
    """The quantity of a name, None where the scene has none."""
    for quantity in LISTED:
        before, _, after = quantity.path.partition(f"<{quantity.owner}>")
        if not quantity.owner:
            if name == quantity.path and quantity.only(scene, 0):
                return Named(name, quantity, 0)
        elif name.startswith(before) and name.endswith(after):
            owner = name[len(before) : len(name) - len(after)]
            names = owners(scene, quantity.owner)
            if owner in names and quantity.only(scene, names.index(owner)):
                return Named(name, quantity, names.index(owner))
    return None


def values_of(many: Many, name: str) -> Floats | None:
    """Values of a quantity by its name, shape (n,); None where the scene has no such quantity."""
    if name.startswith(FREE):
        return None if many.free is None else many.free(name.removeprefix(FREE))
    if name in many.further:
        return many.further[name]
    found = find(many.scene, name)
    return None if found is None else found.of(many)


def needs_one(scene: Scene, name: str) -> bool:
    """Whether a quantity needs all of each run, not its extremes only."""
    found = find(scene, name.removeprefix(FREE))
    return found is not None and found.quantity.source in _FROM_ONE


def needs_energy(names: Sequence[str]) -> bool:
    """Whether one of these quantities is of the energy ledger."""
    return any(name.startswith("energy.") for name in names)


def is_whole(name: str) -> bool:
    """Whether the values of a quantity are whole numbers, of whatever scene."""
    stem = name.removeprefix(FREE)
    return any(
        q.kind is int
        and stem.startswith(q.path.partition("<")[0])
        and stem.endswith(q.path.rpartition(">")[2])
        for q in LISTED
    )


def listing() -> Iterator[tuple[str, str, str, str]]:
    """Path, unit, sentence and source of every quantity; of the six of an extreme one line."""
    for q in LISTED:
        if not q.six:
            yield q.path, q.dimension.unit, q.text, q.source
        elif q.path == q.six.replace("*", "abs_max"):
            yield q.six, q.dimension.unit, q.text, q.source


def pi_unit(dimension: Dimension, scales: Scales, mass: float) -> float:
    """What a quantity is divided by to be a Π-term.

    Parameters
    ----------
    dimension : Dimension
        Of the quantity.
    scales : Scales
        a_g and omega_g of the motion.
    mass : float
        Of the body looked at (kg).

    Returns
    -------
    float
        SI: L_e = a_g/omega_g^2 of a length, m a_g of a force, and so on; 1 of a number.
    """
    a, w = scales.a_g, scales.omega_g
    return {
        Dimension.LENGTH: a / w**2,
        Dimension.VELOCITY: a / w,
        Dimension.ACCELERATION: a,
        Dimension.TIME: 1.0 / w,
        Dimension.ANGULAR_FREQUENCY: w,
        Dimension.FORCE: mass * a,
        Dimension.IMPULSE: mass * a / w,
        Dimension.ENERGY: mass * a**2 / w**2,
    }.get(dimension, 1.0)


def _upward(x: Extremes, i: int) -> Any:
    """Whether the maximum is the larger in size, or the earlier of two of one size."""
    high, low = x.maximum[:, i], x.minimum[:, i]
    earlier = x.time_of_maximum[:, i] <= x.time_of_minimum[:, i]
    return (high > -low) | ((high == -low) & earlier)


SIX: dict[str, tuple[str, Callable[[Extremes, int], Floats]]] = {
    "max": ("greatest", lambda x, i: x.maximum[:, i]),
    "t_max": ("time of the greatest", lambda x, i: x.time_of_maximum[:, i]),
    "min": ("least", lambda x, i: x.minimum[:, i]),
    "t_min": ("time of the least", lambda x, i: x.time_of_minimum[:, i]),
    "abs_max": ("peak", lambda x, i: np.where(_upward(x, i), x.maximum[:, i], -x.minimum[:, i])),
    "t_abs_max": (
        "time of the peak",
        lambda x, i: np.where(_upward(x, i), x.time_of_maximum[:, i], x.time_of_minimum[:, i]),
    ),
}
"""Numbers that an extreme has: both extremes, and the larger in size."""


def _six(
    path: str,
    what: str,
    dimension: Dimension,
    text: str,
    extremes: Callable[[Many], Extremes | None],
    source: Source = Source.EXTREMES,
    only: Callable[[Scene, int], bool] = _always,
) -> Iterator[Quantity]:
    """The six numbers of an extreme; ``*`` of the path is which."""

    def value(pick: Callable[[Extremes, int], Floats]) -> Value:
        def values(many: Many, i: int) -> Floats:
            found = extremes(many)
            return many.t * np.nan if found is None else pick(found, i)

        return values

    for word, (which, pick) in SIX.items():
        own = Dimension.TIME if word.startswith("t_") else dimension
        called = (
            "$u_{max}$" if path == "peaks.<body>.*" and word == "abs_max" else f"{which} {what}"
        )
        sentence = f"{which[0].upper()}{which[1:]} {what}{text}."
        yield Quantity(
            path.replace("*", word), called, own, sentence, value(pick), source, only, six=path
        )


def _hysteretic(scene: Scene, i: int) -> bool:
    return isinstance(scene.springs[i].law, BoucWen)


def _ductility(many: Many, i: int) -> Floats:
    spring = many.scene.springs[i]
    law = spring.law
    assert isinstance(law, BoucWen)
    limit = many.parameters.get(f"spring.{spring.name}.yield_displacement", law.yield_displacement)
    return np.asarray(SIX["abs_max"][1](many.elongation, i) / limit)


def _drift_ratio(many: Many, i: int) -> Floats:
    height = many.scene.springs[i].height
    return np.asarray(SIX["abs_max"][1](many.elongation, i) / (height or np.nan))


def _z(many: Many, i: int) -> Floats:
    name = many.scene.springs[i].name
    return many.z[:, many.scene.hysteretic_springs.index(name)]


def _peak_term(many: Many, i: int) -> Floats:
    scales = many.scales
    length = np.nan if scales is None else scales.length
    return np.asarray(SIX["abs_max"][1](many.displacement, i) / length)


def _amplification(many: Many, i: int) -> Floats:
    body = many.scene.bodies[i].name
    # Of the two terms, where there are any, as tables have had it to the last digit.
    name = f"peaks.{body}.abs_max" if many.scales is None else f"pi_um.{body}"
    own, free = values_of(many, name), None if many.free is None else many.free(name)
    if own is None or free is None:
        return many.t * np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        return own / free


def _scale(key: str) -> Value:
    return lambda many, i: np.nan if many.scales is None else getattr(many.scales, key)


_Rows = list[Event]


def _of_events(number: Callable[[_Rows], float]) -> Value:
    """A number of the events of contact i."""

    def values(many: Many, i: int) -> Floats:
        found = [[e for e in r.events if e.contact == i] for r in many.recordings]
        return np.array([number(events) for events in found], dtype=np.float64)

    return values


def _of_recording(number: Callable[[Recording, int], float]) -> Value:
    return lambda many, i: np.array([number(r, i) for r in many.recordings], dtype=np.float64)


def _max_force(recording: Recording, i: int) -> float:
    return float(recording.max_force[i]) if recording.unique_forces[i] else np.nan


def _struck(events: _Rows) -> _Rows:
    return [e for e in events if e.kind in (EventKind.IMPACT, EventKind.ACCUMULATION)]


def _closing(event: Event) -> float:
    return -event.gap_velocity_before


def _time_of_largest(events: _Rows, size: Callable[[Event], float]) -> float:
    struck = _struck(events)
    return max(struck, key=size).t if struck else np.nan


def energy_shares(events: Sequence[Event], contacts: int) -> Floats:
    """Kinetic energy lost in each contact (J), shape (contacts,).

    What a problem of several contacts loses is ``-1/2 sum_j L_j (g_j- + g_j+)``, with the
    impulses L and the rates g of the gaps before and after, so that each has its part. A row
    that stands for several impacts keeps what its problem lost.
    """
    groups: dict[int, _Rows] = {}
    for event in _struck(list(events)):
        groups.setdefault(event.group, []).append(event)
    lost = np.zeros(contacts)
    for group in groups.values():
        shared = len(group) > 1 and all(e.count == 1 for e in group)
        for e in group:
            rates = e.gap_velocity_before + e.gap_velocity_after
            lost[e.contact] += -0.5 * e.impulse * rates if shared else e.energy_lost
    return lost


def _lost(recording: Recording, i: int) -> float:
    return float(energy_shares(recording.events, recording.resting_time.size)[i])


def _faster(many: Many, i: int) -> Floats:
    least = many.stated.threshold_speed
    return _of_events(lambda events: sum(e.count for e in _struck(events) if _closing(e) > least))(
        many, i
    )


def _ledger(term: str) -> Value:
    return _of_recording(lambda r, _: np.nan if r.energy is None else getattr(r.energy, term))


_LEDGER = {
    "initial": "at the start",
    "input": "that the ground motion put in",
    "kinetic": "of motion at the end",
    "elastic": "stored in the k x parts of the springs at the end",
    "hysteretic": "of the work done on the Q z parts of the springs",
    "viscous": "of the work done in the dashpots",
    "impact": "lost in impacts",
}
_NUMBER, _LENGTH, _TIME = Dimension.NUMBER, Dimension.LENGTH, Dimension.TIME
_EVENTS = Source.EVENTS

LISTED: tuple[Quantity, ...] = (
    Quantity("t_final", "end of the run", _TIME, "Time reached.", lambda m, i: m.t),
    *_six(
        "peaks.<body>.*",
        "displacement",
        _LENGTH,
        " relative to the ground",
        lambda m: m.displacement,
    ),
    Quantity(
        "residual.<body>",
        "residual displacement",
        _LENGTH,
        "Displacement when the run ends: what is left if the motion has died down by then.",
        lambda m, i: m.u[:, i],
    ),
    *_six(
        "acceleration.<body>.*",
        "absolute acceleration",
        Dimension.ACCELERATION,
        " between impacts (in an impact it is not finite)",
        lambda m: m.acceleration,
        Source.ACCELERATIONS,
    ),
    *_six(
        "springs.<spring>.*_elongation",
        "elongation",
        _LENGTH,
        ": of a storey, its drift",
        lambda m: m.elongation,
    ),
    Quantity(
        "springs.<spring>.ductility",
        "ductility",
        _NUMBER,
        "Largest elongation of either sign over the yield displacement (Bouc-Wen springs).",
        _ductility,
        only=_hysteretic,
    ),
    Quantity(
        "springs.<spring>.drift_ratio",
        "drift ratio",
        _NUMBER,
        "Largest elongation of either sign over the height of the storey, where it is given.",
        _drift_ratio,
        only=lambda scene, i: scene.springs[i].height is not None,
    ),
    *_six(
        "base_shear.*",
        "base shear",
        Dimension.FORCE,
        ": sum of the forces of springs and dashpots on the ground, positive to the right",
        lambda m: m.base_shear,
        Source.ACCELERATIONS,
    ),
    Quantity(
        "impacts",
        "impacts",
        _NUMBER,
        "Impacts of all contacts, with those that accumulations stand for.",
        lambda m, i: m.impacts.sum(axis=1),
        kind=int,
    ),
    Quantity(
        "resting_time",
        "resting time",
        _TIME,
        "Time at rest, the sum of all contacts.",
        lambda m, i: m.resting_time.sum(axis=1),
    ),
    Quantity(
        "contacts.<contact>.impacts",
        "impacts",
        _NUMBER,
        "Impacts, with those that accumulations stand for.",
        lambda m, i: m.impacts[:, i],
        kind=int,
    ),
    Quantity(
        "contacts.<contact>.resting_time",
        "resting time",
        _TIME,
        "Time at rest.",
        lambda m, i: m.resting_time[:, i],
    ),
    Quantity(
        "contacts.<contact>.max_impulse",
        "largest impulse",
        Dimension.IMPULSE,
        "Largest impulse of an impact.",
        _of_events(lambda events: max((e.impulse for e in events), default=0.0)),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.max_force",
        "largest force",
        Dimension.FORCE,
        "Largest force while resting; none where it was not unique at some time.",
        _of_recording(_max_force),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.unique_force",
        "unique force",
        _NUMBER,
        "Whether its force was always unique: not so in a group locked between two barriers.",
        _of_recording(lambda r, i: float(r.unique_forces[i])),
        _EVENTS,
        kind=bool,
    ),
    Quantity(
        "contacts.<contact>.smallest_gap",
        "smallest gap",
        _LENGTH,
        "Smallest gap while open.",
        lambda m, i: m.smallest_gap[:, i],
    ),
    Quantity(
        "contacts.<contact>.t_max_impulse",
        "time of the strongest impact",
        _TIME,
        "Time of the impact of the largest impulse; none without an impact.",
        _of_events(lambda events: _time_of_largest(events, lambda e: e.impulse)),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.t_first_impact",
        "time of the first impact",
        _TIME,
        "Time of the first impact; none without an impact.",
        _of_events(lambda events: min((e.t for e in _struck(events)), default=np.nan)),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.sum_impulse",
        "sum of impulses",
        Dimension.IMPULSE,
        "Sum of the impulses of all impacts.",
        _of_events(lambda events: sum(e.impulse for e in _struck(events))),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.energy_lost",
        "energy lost",
        Dimension.ENERGY,
        "Kinetic energy lost in its impacts, of joint ones its share.",
        _of_recording(_lost),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.fastest_closing",
        "fastest closing",
        Dimension.VELOCITY,
        "Largest closing speed of an impact; 0 without one.",
        _of_events(lambda events: max(map(_closing, _struck(events)), default=0.0)),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.t_fastest_closing",
        "time of the fastest closing",
        _TIME,
        "Time of the impact of the largest closing speed; none without an impact.",
        _of_events(lambda events: _time_of_largest(events, _closing)),
        _EVENTS,
    ),
    Quantity(
        "contacts.<contact>.impacts_faster",
        "impacts above the threshold",
        _NUMBER,
        "Impacts that close faster than threshold_speed of [run], 1 cm/s where it is not given.",
        _faster,
        _EVENTS,
        kind=int,
    ),
    Quantity(
        "final.<body>.u",
        "final displacement",
        _LENGTH,
        "Displacement at the end.",
        lambda m, i: m.u[:, i],
    ),
    Quantity(
        "final.<body>.v",
        "final velocity",
        Dimension.VELOCITY,
        "Velocity at the end, relative to the ground.",
        lambda m, i: m.v[:, i],
    ),
    Quantity(
        "final.<spring>.z",
        "final $z$",
        _NUMBER,
        "Hysteretic variable at the end.",
        _z,
        only=_hysteretic,
    ),
    Quantity(
        "work.steps", "steps", _NUMBER, "Steps of the solver.", lambda m, i: m.steps, kind=int
    ),
    *(
        Quantity(
            f"energy.{term}",
            f"energy {text}",
            Dimension.ENERGY,
            f"Energy {text}.",
            _ledger(term),
            Source.ENERGY,
        )
        for term, text in _LEDGER.items()
    ),
    *(
        Quantity(
            "pi_um" + owner,
            "$u_{max}/L_e$",
            _NUMBER,
            f"Largest displacement of either sign over L_e (eq. 8), of {whose}.",
            _peak_term,
            tabled=False,
        )
        for owner, whose in (("", "the first body"), (".<body>", "each body"))
    ),
    *(
        Quantity(
            "amplification" + owner,
            "peak with contact / without",
            _NUMBER,
            f"Peak displacement over that of the same scene without contact, of {whose}.",
            _amplification,
            Source.FREE,
            tabled=False,
        )
        for owner, whose in (("", "the first body"), (".<body>", "each body"))
    ),
    *(
        Quantity(f"scales.{key}", called, dimension, text, _scale(attribute), tabled=False)
        for key, attribute, called, dimension, text in (
            ("a_g", "a_g", "$a_g$", Dimension.ACCELERATION, "Amplitude of a pulse, else PGA."),
            (
                "omega_g",
                "omega_g",
                r"$\omega_g$",
                Dimension.ANGULAR_FREQUENCY,
                "2 pi over the period of a pulse, of a record over T_m.",
            ),
            ("L_e", "length", "$L_e$", _LENGTH, "The energetic length a_g / omega_g^2."),
        )
    ),
)
"""All of them, in the order of the tables."""
