"""From names to quantities of a scene and to their values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eventpound.case.run_options import DEMAND_OVER_CAPACITY, RunOptions, Stated
from eventpound.case.table import suggestion
from eventpound.errors import InputError, told_of
from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import FROM_FURTHER, FROM_ONE, Quantity, TakenFrom, parts_of
from eventpound.quantities.listed import LISTED
from eventpound.quantities.owners import is_told, owners_of
from eventpound.quantities.runs import Runs
from eventpound.scene.scene import Scene

FREE = "free."
"""Before the name of a quantity of the same scene without contact."""


@dataclass(frozen=True, slots=True)
class Named:
    """A quantity of one owner of a scene."""

    name: str
    quantity: Quantity
    i: int

    def of(self, many: Runs) -> Floats:
        """Its values, shape (n,)."""
        values = np.asarray(self.quantity.value(many, self.i))
        return values if values.ndim else np.broadcast_to(values, many.t.shape)

    def of_one(self, many: Runs) -> float | int | bool | None:
        """Its value in the only run; None where it has none."""
        value = float(self.of(many)[0])
        return None if np.isnan(value) else self.quantity.kind(value)


def tabled(many: Runs) -> Iterator[Named]:
    """Quantities that stand in the table of some runs without being named."""
    there = {TakenFrom.EXTREMES}
    if many.acceleration is not None:
        there.add(TakenFrom.ACCELERATIONS)
    if many.recordings or many.struck is not None:
        there.add(TakenFrom.CONTACTS)
        if not _laws_vary(many.parameters):
            there.add(TakenFrom.FORCES)
    if many.recordings:
        there.add(TakenFrom.LAWS)
        if many.recordings[0].energy is not None:
            there.add(TakenFrom.ENERGY)
    return all_of(many.scene, [q for q in LISTED if q.tabled and q.source in there])


def all_of(scene: Scene, listed: Sequence[Quantity] = LISTED) -> Iterator[Named]:
    """Every quantity of a scene among those listed, in their order."""
    names: dict[str, Sequence[str]] = {}
    for quantity in listed:
        kind = quantity.owner
        if kind not in names:
            names[kind] = owners_of(scene, kind)
        for i, owner in enumerate(names[kind]):
            if is_told(scene, kind, i) and quantity.only(scene, i):
                yield Named(quantity.name(owner), quantity, i)


def names_of(scene: Scene) -> list[str]:
    """Names of every quantity of a scene, those without contact last."""
    own = [named.name for named in all_of(scene)]
    free = [
        FREE + named.name
        for named in all_of(scene)
        if named.quantity.owner != "contact" and named.quantity.source is not TakenFrom.FREE
    ]
    return own + free


_BY_KIND: dict[str, list[Quantity]] = {}
"""Quantities by the first word of their paths."""
for _each in LISTED:
    _BY_KIND.setdefault(_each.path.partition(".")[0], []).append(_each)


def find(scene: Scene, name: str) -> Named | None:
    """The quantity of a name, None where the scene has none."""
    for quantity in _BY_KIND.get(name.partition(".")[0], ()):
        before, kind, after = parts_of(quantity.path)
        if not kind:
            if name == quantity.path and quantity.only(scene, 0):
                return Named(name, quantity, 0)
        elif name.startswith(before) and name.endswith(after):
            owner = name[len(before) : len(name) - len(after)]
            names = owners_of(scene, kind)
            if owner in names and quantity.only(scene, names.index(owner)):
                return Named(name, quantity, names.index(owner))
    return None


def asked(parts: Iterable[tuple[Scene, Stated]]) -> list[str]:
    """Names of the quantities that ``[run]`` asks for.

    Parameters
    ----------
    parts : iterable of (Scene, Stated)
        Scenes and what is said of each; where there are several, one that has it is enough.

    Raises
    ------
    InputError
        Naming every option that no scene has anything for.
    """
    names: dict[str, None] = {}
    missing: dict[tuple[str, str], str] = {}
    there: set[tuple[str, str]] = set()
    for scene, stated in parts:
        for option, word in stated.named():
            try:
                names |= dict.fromkeys(chosen(scene, [word], stated))
                _check_capacity(scene, word, stated)
                there.add((option, word))
            except InputError as error:
                needs = f"{option}: needs a contact, and there is none"
                said = str(error).replace("quantities: ", f"{option}: ")
                missing[option, word] = said if option in ("quantities", "capacity") else needs
    problems = [text for key, text in missing.items() if key not in there]
    if problems:
        raise InputError(problems)
    return list(names)


def _check_capacity(scene: Scene, name: str, stated: Stated) -> None:
    """Refuse a capacity in a unit of something else than its quantity."""
    found = dict(stated.capacity_dimensions).get(name)
    for dimension in {named.quantity.dimension for named in asked_of(scene, name)}:
        if found not in (None, dimension):
            unit = f"a unit of {found.value[0]}"
            raise InputError(f"capacity: {name}: found {unit}; accepted: {dimension.accepted}")


def quantities_asked(parts: Iterable[tuple[Scene, RunOptions]]) -> list[str]:
    """Names of the quantities that ``[run]`` asks for where many runs are tabulated.

    Parameters
    ----------
    parts : iterable of (Scene, RunOptions)
        Scenes and the options of each; where there are several, one that has it is enough.

    Raises
    ------
    InputError
        Naming every option that no scene has anything for.
    """
    parts = list(parts)
    with told_of("[run]: "):
        names = asked((scene, run.stated) for scene, run in parts)
    ledger = [
        name
        for scene, run in parts
        if run.energy or needs_energy(names)
        for name in ledger_of(scene)
    ]
    return list(dict.fromkeys([*ledger, *names]))


def chosen(scene: Scene, wanted: Sequence[str], stated: Stated | None = None) -> list[str]:
    """Names of quantities that were asked for by name, or by path for all owners.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    stated : Stated, optional
        What is said of the numbers that some are about: what needs one that is missing is
        refused then.
    wanted : sequence of str
        Names, or paths as ``velocity.<body>.abs_max`` or ``springs.<spring>.*_force``, with
        ``free.`` before them for the scene without contact.

    Raises
    ------
    InputError
        Naming every one that there is not, and what may be meant.
    """
    names: dict[str, None] = {}
    problems = []
    for word in wanted:
        found = [named.name for named in asked_of(scene, word)]
        if not found:
            listed = "; `eventpound check CASE --quantities` lists them"
            meant = suggestion(word, names_of(scene)) or listed
            problems.append(f"quantities: found {word!r}{meant}")
        elif stated is not None:
            problems += [text for name in found if (text := unstated(name, stated))]
        names |= dict.fromkeys(found)
    if problems:
        raise InputError(problems)
    return list(names)


def asked_of(scene: Scene, word: str) -> list[Named]:
    """Quantities that a word of ``quantities`` means: a name, a path, a path of six, or `FREE`."""
    stem = word.removeprefix(FREE)
    found = [
        named
        for named in all_of(scene)
        if stem in (named.quantity.path, named.quantity.six, named.name)
    ]
    if stem == word:
        return found
    called = "{} without contact".format
    return [
        Named(FREE + n.name, replace(n.quantity, called=called(n.quantity.called)), n.i)
        for n in found
    ]


def unstated(name: str, stated: Stated) -> str:
    """What is missing for a quantity to be about anything, as a problem; empty if nothing is."""
    if name == DEMAND_OVER_CAPACITY and not stated.capacities:
        return f"quantities: {name!r} needs capacities in the case"
    if not name.endswith(".estimated_force") or stated.contact_stiffness is not None:
        return ""
    return f"quantities: {name!r} needs contact_stiffness in [run] of a case"


def values_of(many: Runs, name: str) -> Floats | None:
    """Values of a quantity by its name, shape (n,); None where the scene has no such quantity."""
    if name in many.further:
        return many.further[name]
    if name.startswith(FREE):
        return None if many.free is None else many.free(name.removeprefix(FREE))
    found = find(many.scene, name)
    return None if found is None else found.of(many)


def _source(scene: Scene, name: str) -> TakenFrom | None:
    """What a quantity is taken from; None where the scene has no such quantity."""
    found = find(scene, name)
    return None if found is None else found.quantity.source


def needs_one(scene: Scene, name: str, varied: Iterable[str] = ()) -> bool:
    """Whether a quantity needs all of each run, not its extremes only.

    Parameters
    ----------
    scene : Scene
        What the runs have in common.
    name : str
        Of the quantity.
    varied : iterable of str
        Dotted keys of the numbers that vary.
    """
    source = _source(scene, name.removeprefix(FREE))
    return source in FROM_ONE and (source is not TakenFrom.FORCES or _laws_vary(varied))


def _laws_vary(varied: Iterable[str]) -> bool:
    """Whether springs vary: forces are computed from extremes with the laws of the scene."""
    return any(key.startswith("spring.") for key in varied)


def needs_free(scene: Scene, name: str) -> bool:
    """Whether a quantity needs a run without contact."""
    return name.startswith(FREE) or _source(scene, name) in FROM_FURTHER


def needs_accelerations(scene: Scene, names: Sequence[str]) -> bool:
    """Whether one of these quantities needs the extremes of accelerations."""
    return any(_source(scene, n.removeprefix(FREE)) is TakenFrom.ACCELERATIONS for n in names)


def needs_impacts(scene: Scene, names: Sequence[str]) -> bool:
    """Whether one of these quantities needs the impacts of each run."""
    return any(_source(scene, name) is TakenFrom.CONTACTS for name in names)


def needs_energy(names: Sequence[str]) -> bool:
    """Whether one of these quantities is of the energy ledger."""
    return any(q.source is TakenFrom.ENERGY for name in names for q in _of_form(name))


def ledger_of(scene: Scene) -> list[str]:
    """Names of all quantities of the energy ledger."""
    return [named.name for named in all_of(scene) if named.quantity.source is TakenFrom.ENERGY]


def is_whole(name: str) -> bool:
    """Whether the values of a quantity are whole numbers, of whatever scene."""
    return any(q.kind is int for q in _of_form(name))


def _of_form(name: str) -> Iterator[Quantity]:
    """Quantities that may have a name or path, of whatever scene."""
    stem = name.removeprefix(FREE)
    for q in _BY_KIND.get(stem.partition(".")[0], ()):
        before, _, after = parts_of(q.path)
        if stem.startswith(before) and stem.endswith(after):
            yield q


def listing() -> Iterator[tuple[str, str, str, str]]:
    """Path, unit, sentence and source of every quantity; of the six of an extreme one line."""
    for q in LISTED:
        if not q.six:
            yield q.path, q.dimension.unit, q.text, q.source
        elif q.path == q.six.replace("*", "abs_max"):
            yield q.six, q.dimension.unit, q.text, q.source
