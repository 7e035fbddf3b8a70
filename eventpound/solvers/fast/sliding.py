"""Slips and sticks of sliders and of contacts with friction: what fast's series tell of them.

A slider that slips is a link with the constant force of its branch, until x' vanishes; one that
sticks rests as a contact does, whose force λ is what friction lacks of that of a slip, ``Q - λ``.
With Q = σ F, it holds while ``σ λ > 0`` and ``2 F - σ λ > 0``.

A contact with friction that slips has a link without force along it, until x' vanishes, and is in
the equations of the mode (`eventpound.mechanics.oblique`). One that sticks has a contact along it
that rests, and holds while ``μ λ_N + λ_T > 0`` and ``μ λ_N - λ_T > 0``.

What an instant demands `eventpound.contact.sliders` and `eventpound.contact.friction` tell. No
scene has both.
"""

from __future__ import annotations

from eventpound.contact.kinks import still_rate
from eventpound.contact.modes import ends_of_stick
from eventpound.mechanics.elements import pull_per_z
from eventpound.mechanics.observables import difference
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.run import FastRun
from eventpound.solvers.fast.search import (
    acceleration_level,
    distance_coefficient,
    force_level,
    release_time,
)
from eventpound.tolerances import GAP_COEFFICIENT


@compiled
def any_slider(run: FastRun) -> bool:
    """Whether the scene has a slider."""
    return bool(run.plan.links.sliders.size > 0)


@compiled
def any_rubbing(run: FastRun) -> bool:
    """Whether a contact of the scene has friction."""
    return bool(run.plan.contacts.rubbing.size > 0)


@compiled
def holds_stick(j: int, run: FastRun) -> bool:
    """Whether contact j is none of the scene, but rests while something sticks."""
    return bool(j >= own_contacts(run))


@compiled
def own_contacts(run: FastRun) -> int:
    """Number of the contacts of the scene, which come first."""
    sliders, rubbing = run.plan.links.sliders, run.plan.contacts.rubbing
    return int(run.state.gap.size - sliders.size - rubbing.size)


@compiled
def _link_of(j: int, run: FastRun) -> int:
    """The slider, a link, of contact j."""
    return int(run.plan.links.sliders[j - own_contacts(run)])


@compiled
def _slip_force(j: int, run: FastRun) -> float:
    """Force of the slip, on its branch, of the slider of contact j (N)."""
    return pull_per_z(_link_of(j, run), run.series.memory)


@compiled
def margin_at_rest(j: int, force: float, run: FastRun) -> float:
    """How far the force of a contact (N) is from where its rest ends, or what it holds slips.

    Of one with friction all forces are those `observed`.
    """
    if not holds_stick(j, run):
        return force
    if any_rubbing(run):
        i = run.plan.contacts.rubbing[j - own_contacts(run)]
        return run.plan.contacts.friction[i] * run.observed.contact_force[i] - abs(force)
    low, high = ends_of_stick(_slip_force(j, run))
    return min(force - low, high - force)


@compiled_deferred
def set_margin(j: int, end: int, order: int, run: FastRun) -> None:
    """Taylor coefficients of how far from an end of a stick its force is, into `series.d`.

    `end`: 0 of the lower, 1 of the upper.
    """
    force, d = run.series.contact_force[j], run.series.d
    for k in range(order - 1):
        # λ - low, or high - λ.
        d[k] = force[k] if end == 0 else -force[k]
    if any_rubbing(run):
        i = run.plan.contacts.rubbing[j - own_contacts(run)]
        for k in range(order - 1):
            d[k] += run.plan.contacts.friction[i] * run.series.contact_force[i, k]
        return
    low, high = ends_of_stick(_slip_force(j, run))
    d[0] += -low if end == 0 else high


@compiled_noinline
def end_of_slip(order: int, h: float, limit: float, a: int, side: float, run: FastRun) -> float:
    """When the slip of link a to a side ends within h, up to `limit` (s), or inf.

    One that has only just begun goes on with the first coefficient that is not rounding.
    """
    limits, series, c = run.plan.limits, run.series, run.series.c
    still = still_rate(limits.length, limits.time)
    head, tail = series.ends[a, 0], series.ends[a, 1]
    for k in range(order):
        c[k] = side * (k + 1) * distance_coefficient(head, tail, k + 1, series)
    begins = abs(c[0]) <= still
    # A stick ends where forces are within rounding of its end.
    let_go = force_level(run.state.progress[0].clusters, limits, series)
    for k in range(1, order if begins else 1):
        level = 0.0
        for end in (head, tail):
            if end >= 0 and k == 1:
                answer = series.inverse_mass[end]
                answer = series.compliance[end, end] if series.free.shape[0] > 0 else answer
                level += acceleration_level(end, limits, series) + let_go * answer
            elif end >= 0:
                level += (k + 1) * GAP_COEFFICIENT * abs(series.X[end, k + 1])
        if abs(c[k]) > level:
            break
        c[k] = 0.0
    return release_time(c, order, h, limit, still, False, series.work)


@compiled
def holds_slider(a: int, run: FastRun) -> bool:
    """Whether the slider a, a link, sticks, and so does not slip, whatever its ends do."""
    for j in range(own_contacts(run), run.state.gap.size):
        if run.state.resting[j] and _link_of(j, run) == a:
            return True
    return False


@compiled_deferred
def observe_slider_forces(run: FastRun) -> None:
    """Take the forces of the contacts of sliders from those of slips that are `observed`."""
    links, observed = run.plan.links, run.observed
    for j in range(observed.gap.size - links.sliders.size, observed.gap.size):
        a = _link_of(j, run)
        # Friction is what the slip would give less what sticking takes of it: f = σ F - λ.
        observed.force[a] -= observed.contact_force[j]
        observed.base[1] -= links.on_ground[a] * observed.contact_force[j]


@compiled_deferred
def observe_slider_z(run: FastRun) -> None:
    """Put friction over that of a slip into the z of `observed`, for a line of the history."""
    links, observed = run.plan.links, run.observed
    for j in range(observed.gap.size - links.sliders.size, observed.gap.size):
        slip = _slip_force(j, run)
        z = links.z_of_link[_link_of(j, run)]
        observed.z[z] = (slip - observed.contact_force[j]) / abs(slip)


@compiled_deferred
def add_friction(weight: float, run: FastRun) -> None:
    """Add `weight` (s) times the powers of friction that are `observed` (W) to the ledger."""
    contacts, observed, ledger = run.plan.contacts, run.observed, run.state.ledger
    F = contacts.rubbing.size
    for f in range(F):
        i, t = contacts.rubbing[f], contacts.gap.size - F + f
        slips = run.state.branch[run.state.branch.size - F + f]
        if slips != 0:
            rate = difference(observed.v, contacts.left[t], contacts.right[t])
            taken = slips * rate * contacts.friction[i] * observed.contact_force[i]
            ledger[ledger.size - F + f] += weight * taken


@compiled_deferred
def add_stick_shear(order: int, run: FastRun) -> float:
    """What sliders that stick add to the base shear (N), and to its rate in `series.d`."""
    links, series, value = run.plan.links, run.series, 0.0
    first = run.state.gap.size - links.sliders.size
    for i in range(links.sliders.size):
        part = links.on_ground[links.sliders[i]]
        if run.state.resting[first + i] and part != 0.0:
            force = series.contact_force[first + i]
            value -= part * force[0]
            for k in range(order - 2):
                series.d[k] -= part * (k + 1) * force[k + 1]
    return value
