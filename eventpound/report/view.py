"""What figures need of a run's results: names, contacts, springs, columns, events."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.results import StoredResults
from eventpound.results.description import LawName
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.spring import GROUND
from eventpound.scene.structures import joined_groups
from eventpound.solvers.base import EventKind

# A gap below this part of the largest one is closed: rounding of stored gaps.
_CLOSED = 1e-9

_OPENINGS = (EventKind.DETACHMENT.value, EventKind.SEPARATION.value)
_IMPACTS = (EventKind.IMPACT.value, EventKind.ACCUMULATION.value)


@dataclass(frozen=True, slots=True)
class DrawnSpring:
    """A spring as far as a figure needs it.

    Parameters
    ----------
    name : str
        Its name.
    between : tuple of str
        First and second end.
    law : LawName
        Kind of its law.
    """

    name: str
    between: tuple[str, str]
    law: LawName


@dataclass(frozen=True)
class View:
    """Results of a run as a figure reads them.

    Parameters
    ----------
    results : StoredResults
        The tables.
    """

    results: StoredResults

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies from left to right."""
        return [body["name"] for body in self.results.summary["scene"]["bodies"]]

    @property
    def structures(self) -> list[list[str]]:
        """Bodies that springs and dashpots join, by structures."""
        scene = self.results.summary["scene"]
        joints = [tuple(part["between"]) for part in (*scene["springs"], *scene["dashpots"])]
        return joined_groups(self.bodies, joints)

    @property
    def contacts(self) -> list[Contact]:
        """Contacts in the order of the scene."""
        return [Contact(**entry) for entry in self.results.summary["scene"]["contacts"]]

    @property
    def springs(self) -> list[DrawnSpring]:
        """Springs in the order of the scene."""
        return [
            DrawnSpring(entry["name"], tuple(entry["between"]), LawName(entry["law"]))
            for entry in self.results.summary["scene"]["springs"]
        ]

    @property
    def t(self) -> Floats:
        """Times of the history (s), shape (n,)."""
        return self.column("t")

    def column(self, name: str) -> Floats:
        """A column of the history, shape (n,)."""
        return np.asarray(self.results.history[name], dtype=np.float64)

    def displacement(self, end: str) -> Floats:
        """Displacement of a body, zero of the ground and a barrier (m), shape (n,)."""
        if end in (GROUND, BARRIER):
            return np.zeros(len(self.results.history))
        return self.column(f"u.{end}")

    def elongation(self, spring: DrawnSpring) -> Floats:
        """U of the second end minus u of the first (m), shape (n,)."""
        first, second = spring.between
        return self.displacement(second) - self.displacement(first)

    def impact_times(self, contact: str) -> Floats:
        """Times of the impacts of a contact and of the limits they accumulate at (s)."""
        return self._event_times(contact, _IMPACTS)

    def opening_times(self, contact: str) -> Floats:
        """Times at which a resting contact opened (s)."""
        return self._event_times(contact, _OPENINGS)

    def rests(self, contact: str) -> list[tuple[float, float]]:
        """Stretches (s) over which the contact stayed closed between two rows."""
        t, gap = self.t, np.abs(self.column(f"gap.{contact}"))
        closed = gap <= _CLOSED * np.nanmax(gap, initial=0.0)
        lasting = closed[1:] & closed[:-1] & (t[1:] > t[:-1])
        return _stretches(t, lasting)

    def _event_times(self, contact: str, kinds: tuple[str, ...]) -> Floats:
        events = self.results.events
        chosen = (events["contact"] == contact) & events["kind"].isin(kinds)
        return np.asarray(events.loc[chosen, "t"], dtype=np.float64)


def _stretches(t: Floats, inside: np.ndarray) -> list[tuple[float, float]]:
    """Runs of True, of which entry i stands for the interval from t_i to t_(i+1)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(int)))
    return [(float(t[a]), float(t[b])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
