"""The plan and the state of one run among many, whose arrays have a leading axis of runs."""

from __future__ import annotations

from typing import Any

from eventpound.mechanics.model import LinkLaw
from eventpound.solvers.fast.columns import Motions
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.run import (
    Contacts,
    Ground,
    Hysteresis,
    Limits,
    Links,
    Oscillator,
    Plan,
    State,
)


@compiled
def plan_of_run(i: int, plans: Plan, motions: Motions) -> Plan:
    """Constants of run i."""
    contacts = plans.contacts
    return Plan(
        plans.mass[i],
        _links_of(i, plans.links),
        _hysteresis_of(i, plans.hysteresis),
        Contacts(contacts.left, contacts.right, contacts.gap[i], contacts.restitution[i]),
        _ground_of(i, motions),
        _limits_of(i, plans.limits),
        plans.output_times,
        _oscillator_of(i, plans.oscillator),
        plans.laws,
    )


@compiled
def _links_of(i: int, links: Links) -> Links:
    law = links.law
    kinked: Any = links.kinked
    return Links(
        links.ends,
        LinkLaw(
            law.damping[i],
            law.strength[i],
            law.yield_displacement[i],
            law.exponent[i],
            law.beta[i],
            law.gamma[i],
        ),
        links.compression[i],
        links.extension[i],
        links.offset[i],
        links.z_of_link,
        links.springs,
        links.plain,
        kinked[i],
        links.grounded,
    )


@compiled
def _hysteresis_of(i: int, hysteresis: Hysteresis) -> Hysteresis:
    return Hysteresis(
        hysteresis.link,
        hysteresis.tables,
        hysteresis.at[i],
        hysteresis.core[i],
        hysteresis.down[i],
        hysteresis.saturated[i],
        hysteresis.scale[i],
        hysteresis.bound[i],
    )


@compiled
def _limits_of(i: int, limits: Any) -> Limits:
    return Limits(
        limits.end[i],
        limits.rtol,
        limits.atol_u[i],
        limits.atol_v[i],
        limits.length[i],
        limits.time[i],
        limits.mass[i],
        limits.order,
        limits.hysteresis[i],
        limits.ledger,
    )


@compiled
def _oscillator_of(i: int, one: Any) -> Oscillator:
    return Oscillator(
        one.alone[i],
        one.stiffness[i],
        one.damping[i],
        one.pull[i],
        one.strength[i],
        one.side[i],
        one.scale[i],
        one.right,
        one.left,
    )


@compiled
def _ground_of(i: int, motions: Motions) -> Ground:
    """Ground motion of run i; its samples are put into `motions.scaled`."""
    ground, scaled = motions.ground, motions.scaled
    m = motions.of_variant[i]
    size = ground.first_sample[m, -1]
    if i == 0 or m != motions.of_variant[i - 1]:
        for k in range(size):
            scaled[k] = ground.samples[motions.begins[m] + k] * motions.factor[m]
    return Ground(
        ground.ends[m],
        ground.family,
        ground.coefficients[m],
        ground.first,
        scaled[:size],
        ground.first_sample[m],
    )


@compiled
def state_of_run(i: int, states: State) -> State:
    """What moves in run i."""
    return State(
        states.u[i],
        states.v[i],
        states.sigma[i],
        states.x_r[i],
        states.xi_r[i],
        states.part[i],
        states.gap[i],
        states.gap_rate[i],
        states.resting[i],
        states.pressed[i],
        states.unlocked[i],
        states.branch[i],
        states.ledger[i],
        states.clock[i],
        states.count[i],
    )
