"""What figures need of a run's results: names, contacts, springs, columns, events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import compress
from typing import Any

import numpy as np

from eventpound.contact.event import ENDS_OF_REST, STRIKES
from eventpound.errors import InputError
from eventpound.numerics.arrays import Bools, Floats
from eventpound.quantities.loops import loop_of
from eventpound.results import StoredResults
from eventpound.results.shown_units import GRAVITY, Unit, unit_by_size
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.contact_law import ContactLaw
from eventpound.scene.ends import End, Joining, direction_of, point_of
from eventpound.scene.plan_point import ACROSS, ALONG, TURN, coordinate_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, LawName
from eventpound.scene.structures import joined_groups
from eventpound.units import Dimension

# A gap below this part of the largest one is closed: rounding of stored gaps.
_CLOSED = 1e-9


@dataclass(frozen=True, slots=True)
class DrawnSpring(Joining):
    """A spring as far as a figure needs it.

    Parameters
    ----------
    name : str
        Its name.
    between : tuple of End
        First and second end.
    law : LawName
        Kind of its law.
    """

    name: str
    between: tuple[End, End]
    law: LawName

    @property
    def sides(self) -> tuple[End, End]:
        """Its first and its second end."""
        return self.between


@dataclass(frozen=True)
class View:
    """Results of a run as a figure reads them.

    Parameters
    ----------
    results : StoredResults
        The tables.
    scene : Scene, optional
        What moved, for what lies between the rows of the history.
    pi : bool
        Whether axes are in Π-terms, as L_e and 1/omega_g, which takes a motion with scales.
    """

    results: StoredResults
    scene: Scene | None = None
    pi: bool = False
    units_of: View | None = None
    """Whose units are used, of a run beside another."""

    def within(self, xlim: tuple[float, float] | None) -> View:
        """Results of a stretch of time (s), of all of it where none is given.

        Raises
        ------
        InputError
            Where there are no rows to draw.
        """
        if xlim is None:
            return self
        low, high = xlim
        rows, events = self.results.history_columns, self.results.event_columns
        inside = (low <= rows["t"]) & (rows["t"] <= high)
        if np.count_nonzero(inside) < 2:
            raise InputError(
                f"xlim: found {low:g} to {high:g} s, in which there are no rows to draw"
            )
        shown = [low <= t <= high for t in events["t"]]
        results = replace(
            self.results,
            history_columns={name: values[inside] for name, values in rows.items()},
            event_columns={name: list(compress(cells, shown)) for name, cells in events.items()},
        )
        return replace(self, results=results)

    @property
    def shocks(self) -> list[tuple[float, str]]:
        """When the records of a sequence begin (s), and what they are called with their factors."""
        record = self.results.manifest.get("record", {})
        each = (record.get(key, ()) for key in ("begins", "shocks", "factors"))
        found = zip(*each, strict=True)
        return [(t, f"{name} ×{factor:.3g}") for t, name, factor in found]

    @property
    def time_unit(self) -> Unit:
        """Of an axis of time."""
        if self.units_of is not None:
            return self.units_of.time_unit
        return Unit(r"$1/\omega_g$", 1.0 / self.scale("omega_g")) if self.pi else Unit("s", 1.0)

    def length_unit(self, largest: float) -> Unit:
        """Of an axis of lengths up to this one (m)."""
        return (
            Unit("$L_e$", self.scale("L_e")) if self.pi else unit_by_size(Dimension.LENGTH, largest)
        )

    def force_unit(self, largest: float) -> Unit:
        """Of an axis of forces up to this one (N); m is the mass of the first body."""
        if not self.pi:
            return unit_by_size(Dimension.FORCE, largest)
        mass = self.results.summary["scene"]["bodies"][0]["mass"]
        return Unit(r"$m\,a_g$", mass * self.scale("a_g"))

    @property
    def acceleration_unit(self) -> Unit:
        """Of an axis of accelerations."""
        return Unit("$a_g$", self.scale("a_g")) if self.pi else GRAVITY

    def scale(self, name: str) -> float:
        """One of the scales of the ground motion (SI).

        Raises
        ------
        InputError
            Where it has none.
        """
        value = (self.results.summary.get("scales") or {}).get(name)
        if value is None:
            raise InputError("Π-terms need a ground motion with scales; this run has none")
        return float(value)

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies from left to right."""
        return [body["name"] for body in self.results.summary["scene"]["bodies"]]

    @property
    def structures(self) -> list[list[str]]:
        """Bodies that springs and dashpots join, by structures."""
        scene = self.results.summary["scene"]
        links = (*scene["springs"], *scene["dashpots"])
        joints = [[name for name, _ in direction_of(_sides(link))] for link in links]
        return joined_groups(self.bodies, joints)

    @property
    def contacts(self) -> list[Contact]:
        """Contacts in the order of the scene."""
        return [_contact(entry) for entry in self.results.summary["scene"]["contacts"]]

    @property
    def springs(self) -> list[DrawnSpring]:
        """Springs in the order of the scene."""
        return [
            DrawnSpring(entry["name"], _sides(entry), LawName(entry["law"]))
            for entry in self.results.summary["scene"]["springs"]
        ]

    @property
    def t(self) -> Floats:
        """Times of the history, in their unit, shape (n,)."""
        return self.column("t") / self.time_unit.size

    def column(self, name: str) -> Floats:
        """A column of the history, shape (n,)."""
        return self.results.history_columns[name]

    @property
    def ground(self) -> dict[str, Floats]:
        """Accelerations of the ground, in plan along and across, shape (n,) each."""
        columns = self.results.history_columns
        return {name: columns[name] for name in ("a_g", "a_across") if name in columns}

    def displacement(self, end: End) -> Floats:
        """Displacement of a body, a point or a support, zero of ground and barriers (m), (n,)."""
        return self._of_end(end, "u", "s")

    def _of_end(self, end: End, of_body: str, of_support: str) -> Floats:
        """Columns of one kind of a body or a support, together those of a point, or zero, (n,)."""
        if not isinstance(end, str):
            parts = [w * self._of_end(name, of_body, of_support) for name, w in end.parts]
            return np.sum(parts, axis=0)
        if end in (GROUND, BARRIER):
            return np.zeros(self.t.size)
        return self.column(f"{of_support if end in self.supports else of_body}.{end}")

    @property
    def supports(self) -> list[str]:
        """Names of the supports."""
        return [each["name"] for each in self.results.summary["scene"].get("supports", [])]

    def elongation(self, spring: DrawnSpring) -> Floats:
        """U of the second end minus u of the first (m), shape (n,)."""
        first, second = spring.sides
        return self.displacement(second) - self.displacement(first)

    def loop(self, spring: DrawnSpring) -> tuple[Floats, Floats]:
        """Elongation (m) and force (N) of a spring, between rows too where the scene is known."""
        x, columns = self.elongation(spring), set(self.results.history_columns)
        moving = [end for end in spring.ends if end != GROUND]
        wanted = {f"sv.{end}" if end in self.supports else f"v.{end}" for end in moving}
        memory = [] if self.scene is None else self.scene.memory
        own = [f"{name}.{of}" for of, name in memory if of == spring.name]
        if self.scene is None or x.size < 2 or not wanted.union(own) <= columns:
            return x, self.column(f"force.{spring.name}")
        law = next(each.acting for each in self.scene.springs if each.name == spring.name)
        first, second = (self._of_end(end, "v", "sv") for end in spring.sides)
        return loop_of(law, self.column("t"), x, second - first, *map(self.column, own))

    def impact_times(self, contact: str) -> Floats:
        """Times of the impacts of a contact and of the limits they accumulate at."""
        return self._event_times(contact, STRIKES)

    def opening_times(self, contact: str) -> Floats:
        """Times at which a resting contact opened."""
        return self._event_times(contact, ENDS_OF_REST)

    def rests(self, contact: str) -> list[tuple[float, float]]:
        """Stretches over which the contact stayed closed between two rows."""
        t, gap = self.t, np.abs(self.column(f"gap.{contact}"))
        closed = gap <= _CLOSED * np.nanmax(gap, initial=0.0)
        lasting = closed[1:] & closed[:-1] & (t[1:] > t[:-1])
        return stretches(t, lasting)

    def _event_times(self, contact: str, kinds: tuple[str, ...]) -> Floats:
        events = self.results.event_columns
        each = zip(events["t"], events["contact"], events["kind"], strict=True)
        times = [t for t, name, kind in each if name == contact and kind in kinds]
        return np.array(times, np.float64) / self.time_unit.size


def _sides(entry: Mapping[str, Any]) -> tuple[End, End]:
    """Ends of a spring or a dashpot from its lines in a summary."""
    first, second = (end if isinstance(end, str) else point_of(end) for end in entry["between"])
    return first, second


def _contact(entry: Mapping[str, Any]) -> Contact:
    """A contact from its lines in a summary, where a law stands only if it has one."""
    law = entry.get("law")
    return Contact(**{**entry, "law": ContactLaw(**law) if law else None})


def stretches(borders: Floats, inside: Bools) -> list[tuple[float, float]]:
    """Ends of the runs of True, of which entry i lies between borders i and i + 1."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(int)))
    pairs = zip(edges[::2], edges[1::2], strict=True)
    return [(float(borders[a]), float(borders[b])) for a, b in pairs]


@dataclass(frozen=True)
class OtherRun:
    """Another run that is drawn beside one, pale.

    Parameters
    ----------
    view : View
        Its results.
    name : str
        What a legend calls it.
    """

    view: View
    name: str


@dataclass(frozen=True)
class Traces:
    """Displacements that share an axis.

    Parameters
    ----------
    name : str
        What the axis calls them.
    curves : dict
        Of each body the name and the values, lengths (m) or rotations (rad), shape (n,).
    turned : bool
        Whether they are rotations.
    """

    name: str
    curves: dict[str, tuple[str, Floats]]
    turned: bool = False


def traces_of(view: View) -> list[Traces]:
    """Displacements of all bodies; with decks in plan those along, those across, and rotations."""
    scene = view.scene
    if scene is None or not scene.decks:
        return [Traces("displacement", {b: (b, view.displacement(b)) for b in view.bodies})]
    radius = {coordinate_of(deck.name, TURN): deck.radius for deck in scene.decks}
    found = []
    for way, name in ((ALONG, "along"), (ACROSS, "across"), (TURN, "rotation")):
        curves = {
            body.name: (
                body.name.removesuffix(f".{way}"),
                view.displacement(body.name) / radius.get(body.name, 1.0),
            )
            for body in scene.bodies
            if body.direction == way
        }
        found.append(Traces(name, curves, way == TURN))
    return found


def view_of(source: StoredResults | View) -> View:
    """Results as a figure reads them."""
    return source if isinstance(source, View) else View(source)
