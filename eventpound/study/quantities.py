"""What a study tabulates of each run.

pi_um, pi_um.<body>            u_peak omega_g^2 / a_g of a body (eq. 8)
amplification, ....<body>      its peak over that of the same scene without contact
free.<quantity>                a quantity of the same scene without contact
resting_time                   of all contacts (s)
scales.a_g, .omega_g, .L_e     of the ground motion (m/s^2, rad/s, m)
spring.frame.strength, ...     a number of the scene, by its dotted key (SI)
peaks.deck.abs_max, ...        a number of the run, by its path in ``summary.json``
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eventpound.case.table import suggestion
from eventpound.many_response import Many, blank_many
from eventpound.numerics.arrays import Floats
from eventpound.scene.parameters import places_of, value_at
from eventpound.scene.scene import Scene
from eventpound.study.plan import Base, Study
from eventpound.study.variants import Rows

Table = Mapping[str, Floats]
FREE = "free."
_PEAK, _GAIN, _RESTING = "pi_um", "amplification", "resting_time"
_SCALES = {"scales.a_g": "a_g", "scales.omega_g": "omega_g", "scales.L_e": "length"}
_ACCELERATIONS = ("acceleration.", "base_shear.")
# Of the six numbers that an extreme has, all but the largest in size.
_EXTREMES = ("max", "t_max", "min", "t_min", "t_abs_max")
_LEFT_OUT = ("success", "message", "t_final", "work.steps")


def default_quantities(bases: Sequence[Base]) -> tuple[str, ...]:
    """What is tabulated where a study does not say."""
    if any(base.case.scene.contacts for base in bases):
        return (_PEAK, _GAIN, "impacts", _RESTING)
    return (_PEAK,)


def needs_free(quantities: Sequence[str]) -> bool:
    """Whether the runs without contact are needed."""
    return any(name.startswith((FREE, _GAIN)) for name in quantities)


def needs_accelerations(quantities: Sequence[str]) -> bool:
    """Whether the extremes of accelerations are needed."""
    return any(name.removeprefix(FREE).startswith(_ACCELERATIONS) for name in quantities)


def without_contacts(scene: Scene) -> Scene:
    """The same scene with nothing that can touch."""
    return replace(scene, contacts=())


def check_quantities(study: Study) -> list[str]:
    """What is wrong with the names of quantities; one that some scene has is accepted."""
    known: dict[str, None] = {}
    for base in study.bases:
        known |= dict.fromkeys(quantities_of(base.case.scene))
    problems = []
    for name in study.quantities:
        if name not in known:
            meant = suggestion(name, list(known)) or f"; accepted: {_kinds(study)}"
            problems.append(f"[study]: quantities: found {name!r}{meant}")
    return problems


def _kinds(study: Study) -> str:
    """Quantities of the scenes of a study, what differs by the name of a part only once."""
    kinds: dict[str, None] = {}
    for base in study.bases:
        scene = base.case.scene
        names = {body.name: "<body>" for body in scene.bodies}
        names |= {spring.name: "<spring>" for spring in scene.springs}
        names |= {contact.name: "<contact>" for contact in scene.contacts}
        places = places_of(scene)
        for quantity in quantities_of(scene):
            last = quantity.rpartition(".")[2]
            if quantity in places or quantity.startswith(FREE) or last.startswith(_EXTREMES):
                continue
            first, *others = quantity.split(".")
            middle = ".".join(others[:-1])
            kind = names.get(".".join(others)) if len(others) == 1 else names.get(middle)
            tail = [kind or others[0]] if len(others) == 1 else [kind or middle, *others[-1:]]
            kinds[".".join([first, *(tail if others else [])])] = None
    return ", ".join([*kinds, "a number of the scene (spring.<spring>.strength), free.<quantity>"])


def quantities_of(scene: Scene) -> list[str]:
    """Every quantity that can be tabulated of a scene.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    """
    bodies = [body.name for body in scene.bodies]
    of_run = _of_run(scene)
    own = [_PEAK, *(f"{_PEAK}.{name}" for name in bodies), _RESTING, *of_run]
    free = [_PEAK, *(f"{_PEAK}.{name}" for name in bodies), *_of_run(without_contacts(scene))]
    gains = [_GAIN, *(f"{_GAIN}.{name}" for name in bodies)]
    return [*own, *gains, *_SCALES, *places_of(scene), *(FREE + name for name in free)]


def _of_run(scene: Scene) -> list[str]:
    mass = {f"body.{scene.bodies[0].name}.mass": np.ones(1)}
    columns = blank_many(scene, mass, accelerations=True).table.columns
    return [name for name in columns if name not in _LEFT_OUT and name not in mass]


@dataclass(frozen=True)
class Results:
    """Runs of some rows, from which quantities are taken.

    Parameters
    ----------
    rows : Rows
        What was run.
    own : mapping of str to ndarray, shape (n,)
        Numbers of the runs, as `table_of` gives them.
    free : callable
        Those of the same scenes without contact, run where they are asked for.
    """

    rows: Rows
    own: Table
    free: Callable[[], Table]

    def quantity(self, name: str) -> Floats | None:
        """Values of a quantity, shape (n,); None where these scenes do not have it."""
        scene, scales = self.rows.base.case.scene, self.rows.scales
        if name in _SCALES:
            return None if scales is None else self._all(getattr(scales, _SCALES[name]))
        if name in self.rows.numbers:
            return self.rows.numbers[name]
        places = places_of(scene)
        if name in places:
            return self._all(value_at(scene, places[name]))
        if name.startswith(FREE):
            return self._of_runs(self.free(), name.removeprefix(FREE))
        if name.startswith(_GAIN):
            peak = _PEAK + name.removeprefix(_GAIN)
            own, free = self._of_runs(self.own, peak), self._of_runs(self.free(), peak)
            with np.errstate(divide="ignore", invalid="ignore"):
                return None if own is None or free is None else own / free
        return self._of_runs(self.own, name)

    def _of_runs(self, table: Table, name: str) -> Floats | None:
        if name == _PEAK or name.startswith(_PEAK + "."):
            looked_at = self.rows.base.case.scene.bodies[0].name
            body = name.removeprefix(_PEAK).removeprefix(".") or looked_at
            peak, scales = table.get(f"peaks.{body}.abs_max"), self.rows.scales
            return None if scales is None or peak is None else peak / scales.length
        return table.get(name)

    def _all(self, value: float | Floats) -> Floats:
        return np.broadcast_to(np.asarray(value, float), (self.rows.count,))


def table_of(many: Many) -> dict[str, Floats]:
    """Columns of the table of some runs, and the resting time of all contacts (s)."""
    columns = {name: column.to_numpy() for name, column in many.table.items()}
    return columns | {_RESTING: np.asarray(many.resting_time.sum(axis=1))}
