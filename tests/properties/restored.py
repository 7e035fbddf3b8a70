"""Recordings of scenes seen otherwise, translated back, and those of two parts as one."""

from collections.abc import Iterable
from dataclasses import fields, replace

import numpy as np

from eventpound.solvers.base import Event, EventKind, Extremes, History, Recording
from tests.properties.transforms import View

FOREIGN = -1
"""Contact of an event that the first scene does not have."""


def restored(recording: Recording, view: View, shift: float = 0.0) -> Recording:
    """What a scene seen otherwise did, in the terms of the first scene.

    Parameters
    ----------
    recording : Recording
        Of the other scene.
    view : View
        How it shows the first.
    shift : float
        Time of the first scene at zero of the other (s).
    """
    length, time, mass = view.length, view.time, view.mass
    speed, acceleration, force = length / time, length / time**2, mass * length / time**2
    turned, bodies, sign = view.sign * view.turned, view.bodies, view.sign

    def extremes(of: Extremes, place: np.ndarray, factor: np.ndarray) -> Extremes:
        part = [getattr(of, f.name)[place] for f in fields(of)]
        high, t_high, low, t_low = part
        t_high, t_low = t_high / time + shift, t_low / time + shift
        up = factor > 0.0
        return Extremes(
            np.where(up, high, low) * factor,
            np.where(up, t_high, t_low),
            np.where(up, low, high) * factor,
            np.where(up, t_low, t_high),
        )

    every = np.full(bodies.size, sign)
    shear = np.arange(1)
    return replace(
        recording,
        t=recording.t / time + shift,
        u=recording.u[bodies] * sign / length,
        v=recording.v[bodies] * sign / speed,
        z=recording.z[view.loops] * sign * view.loop_signs,
        history=_history(recording.history, view, shift),
        events=in_order(_events(recording.events, view, shift)),
        displacement=extremes(recording.displacement, bodies, every / length),
        elongation=extremes(recording.elongation, view.springs, turned / length),
        acceleration=extremes(recording.acceleration, bodies, every / acceleration),
        base_shear=extremes(recording.base_shear, shear, np.full(1, sign / force)),
        smallest_gap=recording.smallest_gap[view.contacts] / length,
        resting_time=recording.resting_time[view.contacts] / time,
        max_force=recording.max_force[view.contacts] / force,
        unique_forces=recording.unique_forces[view.contacts],
    )


def _history(of: History, view: View, shift: float) -> History:
    length, time = view.length, view.time
    acceleration, force = length / time**2, view.mass * length / time**2
    sign, bodies = view.sign, view.bodies
    return History(
        of.t / time + shift,
        of.ground * sign / acceleration,
        of.u[:, bodies] * sign / length,
        of.v[:, bodies] * sign * time / length,
        of.a[:, bodies] * sign / acceleration,
        of.z[:, view.loops] * sign * view.loop_signs,
        of.force[:, view.springs] * sign * view.turned / force,
        of.gap[:, view.contacts] / length,
        of.contact_force[:, view.contacts] / force,
    )


def _events(events: Iterable[Event], view: View, shift: float) -> tuple[Event, ...]:
    time, mass = view.time, view.mass
    speed = view.length / time
    here = {int(there): j for j, there in enumerate(view.contacts)}
    return tuple(
        Event(
            e.t / time + shift,
            e.kind,
            e.group,
            here.get(e.contact, FOREIGN),
            e.gap_velocity_before / speed,
            e.gap_velocity_after / speed,
            e.impulse / (mass * speed),
            e.energy_lost / (mass * speed**2),
            e.count,
        )
        for e in events
    )


def in_order(events: Iterable[Event]) -> tuple[Event, ...]:
    """Events by time and problem; the contacts of one problem have no order of their own."""
    return tuple(sorted(events, key=lambda e: (e.t, e.group, e.contact)))


def joined(first: Recording, second: Recording) -> Recording:
    """Two parts of a run as one; contacts that rest at the joint came to rest once."""
    resting = {
        e.contact: e.kind is EventKind.REST
        for e in first.events
        if e.kind in (EventKind.REST, EventKind.DETACHMENT, EventKind.SEPARATION)
    }
    later = tuple(
        e
        for e in second.events
        if not (e.kind is EventKind.REST and e.t == first.t and resting.get(e.contact))
    )
    history = History(
        *(
            np.concatenate((getattr(first.history, f.name), getattr(second.history, f.name)))
            for f in fields(History)
        )
    )
    return replace(
        second,
        history=history,
        events=(*first.events, *later),
        displacement=_wider(first.displacement, second.displacement),
        elongation=_wider(first.elongation, second.elongation),
        acceleration=_wider(first.acceleration, second.acceleration),
        base_shear=_wider(first.base_shear, second.base_shear),
        smallest_gap=np.minimum(first.smallest_gap, second.smallest_gap),
        resting_time=first.resting_time + second.resting_time,
        max_force=np.maximum(first.max_force, second.max_force),
        unique_forces=first.unique_forces & second.unique_forces,
    )


def _wider(one: Extremes, other: Extremes) -> Extremes:
    up, down = one.maximum >= other.maximum, one.minimum <= other.minimum
    return Extremes(
        np.maximum(one.maximum, other.maximum),
        np.where(up, one.time_of_maximum, other.time_of_maximum),
        np.minimum(one.minimum, other.minimum),
        np.where(down, one.time_of_minimum, other.time_of_minimum),
    )
