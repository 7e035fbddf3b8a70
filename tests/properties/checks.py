"""What must hold of every recording, computed anew from its history and events.

A rule yields one line for each way in which it is broken. Sizes that rounding and
tolerances leave are in parts of the scene's scales or of the largest value at hand.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eventpound.contact.cascade import TIRED
from eventpound.mechanics.link_law import STRENGTH
from eventpound.mechanics.model import Model, assemble
from eventpound.scene import GROUND, Scene
from eventpound.solvers.base import Event, EventKind, Recording
from eventpound.solvers.events.scales import SceneScales, scene_scales
from eventpound.tolerances import LISTED_SPEED

ROUNDING = 1e-11
"""Of sums of a few terms."""
UNLISTED = 1e-7
"""Part of the largest speed that impacts too slow to be listed may add up to."""
ERRORS = 1e3
"""Units of rtol within which integrated quantities must fulfil an identity."""
COLLAPSED = 3
"""Impacts of a contact in one instant after which they may end in a plastic one."""
IMPACTS = (EventKind.IMPACT, EventKind.ACCUMULATION)


@dataclass(frozen=True)
class Case:
    """A recording with what its rules refer to."""

    scene: Scene
    model: Model
    scales: SceneScales
    rtol: float
    recording: Recording

    @cached_property
    def length(self) -> float:
        """Largest length (m)."""
        return max(
            self.scales.length,
            float(np.max(np.abs(self.recording.history.u), initial=0.0)),
            float(np.max(np.abs(self.model.gap), initial=0.0)),
        )

    @cached_property
    def speed(self) -> float:
        """Largest speed (m/s)."""
        return max(self.scales.speed, float(np.max(np.abs(self.recording.history.v), initial=0.0)))

    @cached_property
    def unfelt(self) -> float:
        """Part of the largest speed below which an impact may be taken as plastic."""
        return 2.0 * LISTED_SPEED * max(1.0, len(self.recording.events) / TIRED)

    @cached_property
    def force(self) -> float:
        """Largest force (N)."""
        return max(
            self.scales.force, float(np.max(np.abs(self.recording.history.force), initial=0.0))
        )


def violations(scene: Scene, start: float, end: float, rtol: float, of: Recording) -> list[str]:
    """Every rule that a recording breaks, as lines ``rule: how``."""
    model = assemble(scene)
    case = Case(scene, model, scene_scales(scene, model, end - start), rtol, of)
    rules = (no_penetration, no_pull, complementarity, newton, bounded_z, impacts, ledger, peaks)
    return [f"{rule.__name__}: {line}" for rule in rules for line in rule(case)]


def no_penetration(case: Case) -> Iterator[str]:
    """``g >= 0`` in every row of the history, and of the smallest gaps."""
    # Every impact rounds once more.
    rounding = ROUNDING + np.finfo(float).eps * len(case.recording.events)
    noise = rounding * case.length
    history = case.recording.history
    gaps = np.array([case.model.gaps(u) for u in history.u]).reshape(history.gap.shape)
    for what, value in (("rows", gaps), ("smallest", case.recording.smallest_gap)):
        if np.min(value, initial=0.0) < -noise:
            yield f"gap {np.min(value):.3e} ({what})"
    if np.max(np.abs(gaps - history.gap), initial=0.0) > noise:
        yield f"gaps and displacements differ by {np.max(np.abs(gaps - history.gap)):.3e}"


def no_pull(case: Case) -> Iterator[str]:
    """``λ >= 0``, where the forces are not unique, too."""
    noise = ERRORS * case.rtol * case.force
    forces = case.recording.history.contact_force
    if np.min(forces, initial=0.0) < -noise:
        yield f"contact force {np.min(forces):.3e} of {case.force:.1e}"


def complementarity(case: Case) -> Iterator[str]:
    """A contact that carries a force has gap zero and no gap acceleration."""
    history, model = case.recording.history, case.model
    carries = history.contact_force != 0.0
    if carries.any() and np.any(history.gap[carries] != 0.0):
        yield f"force at a gap of {np.max(np.abs(history.gap[carries])):.3e}"
    ground = np.column_stack((history.a, history.ground))
    accelerations = ground[:, model.right] - ground[:, model.left]
    apart = np.max(np.abs(accelerations[carries]), initial=0.0)
    largest = max(case.scales.acceleration, float(np.max(np.abs(history.a), initial=0.0)))
    if apart > ERRORS * case.rtol * largest:
        yield f"gap acceleration {apart:.3e} of a pressed contact"


def newton(case: Case) -> Iterator[str]:
    """``m a = Σ forces`` on every body in every row, with F by the spring's law."""
    history, model = case.recording.history, case.model
    noise = ERRORS * case.rtol * case.force
    laws = _spring_forces(case)
    wrong = np.max(np.abs(laws - history.force), initial=0.0)
    if wrong > noise:
        yield f"spring forces differ from their laws by {wrong:.3e} of {case.force:.1e}"
    balance = history.a * model.mass
    index = {body.name: i for i, body in enumerate(case.scene.bodies)}
    links = [(s.between, history.force[:, i]) for i, s in enumerate(case.scene.springs)]
    for d in case.scene.dashpots:
        rates = [0.0 if end == GROUND else history.v[:, index[end]] for end in d.between]
        links.append((d.between, d.coefficient * (rates[1] - rates[0]) + np.zeros(history.t.size)))
    for (first, second), force in links:
        if first != GROUND:
            balance[:, index[first]] -= force
        if second != GROUND:
            balance[:, index[second]] += force
    for j in range(model.contacts):
        if model.left[j] >= 0:
            balance[:, model.left[j]] += history.contact_force[:, j]
        if model.right[j] >= 0:
            balance[:, model.right[j]] -= history.contact_force[:, j]
    if np.max(np.abs(balance), initial=0.0) > noise:
        body = int(np.argmax(np.max(np.abs(balance), axis=0)))
        yield f"body {body}: m a - Σ F = {np.max(np.abs(balance)):.3e} of {case.force:.1e}"


def _spring_forces(case: Case) -> np.ndarray:
    """``F = k (x - o) + Q z`` of every spring in every row."""
    history, model = case.recording.history, case.model
    forces = np.empty(history.force.shape)
    z_of = {int(link): h for h, link in enumerate(model.hysteretic)}
    for i in range(model.springs):
        law = model.elastic.one(i)
        x = np.array([model.elongations(u)[i] for u in history.u]) - law.offset
        forces[:, i] = np.where(x < 0.0, law.compression, law.extension) * x
        if i in z_of:
            forces[:, i] += model.law.memory[i, STRENGTH] * history.z[:, z_of[i]]
    return forces


def bounded_z(case: Case) -> Iterator[str]:
    """``|z| <= (β + γ)^(-1/n)``."""
    beyond = np.max(np.abs(case.recording.history.z) / case.scales.z_bound, initial=0.0) - 1.0
    if beyond > 10.0 * case.rtol:
        yield f"|z| beyond its bound by {beyond:.3e}"


def impacts(case: Case) -> Iterator[str]:
    """Newton's law contact by contact, momentum and energy instant by instant."""
    events = [e for e in case.recording.events if e.kind in IMPACTS]
    part = ROUNDING if len(case.recording.events) < TIRED else case.unfelt
    counted = [e.count for e in events if e.kind is EventKind.ACCUMULATION]
    if counted:
        # The sum of an accumulation stands at the time of its last impact. Two bodies meet with
        # up to twice the speed of the faster, and an impact changes it by up to twice that.
        part = max(part, UNLISTED, 4.0 * LISTED_SPEED * max(counted))
    approach = _approach(events)
    met: Counter[tuple[float, int]] = Counter()
    for e in events:
        # The third time in one instant may be the limit of infinitely many.
        met[e.t, e.contact] += 1
        if met[e.t, e.contact] < COLLAPSED or e.gap_velocity_after != 0.0:
            yield from _law(case, e, approach[e.group])
    instants: dict[float, list[Event]] = {}
    for e in events:
        instants.setdefault(e.t, []).append(e)
    for t, now in instants.items():
        yield from _instant(case, t, now, part)


def _approach(events: Iterable[Event]) -> dict[int, float]:
    """Fastest closing speed of each group (m/s)."""
    fastest: dict[int, float] = {}
    for e in events:
        fastest[e.group] = max(fastest.get(e.group, 0.0), -e.gap_velocity_before)
    return fastest


def _law(case: Case, e: Event, approach: float) -> Iterator[str]:
    """``Λ > 0`` only where ``γ⁺ = -ε γ⁻``."""
    if e.impulse < 0.0:
        yield f"t = {e.t!r}: impulse {e.impulse:.3e}"
    if e.kind is not EventKind.IMPACT:
        return
    restitution = case.model.restitution[e.contact]
    left = e.gap_velocity_after + restitution * e.gap_velocity_before
    if abs(left) > ROUNDING * approach and approach > case.unfelt * case.speed:
        yield (
            f"t = {e.t!r}: contact {e.contact} leaves with {e.gap_velocity_after:.6e} "
            f"after {e.gap_velocity_before:.6e} and ε = {restitution}"
        )


def _instant(case: Case, t: float, now: list[Event], part: float) -> Iterator[str]:
    """``M Δv = W Λ``, ``ΔT = -Σ lost`` and ``γ⁺ + ε γ⁻ >= 0`` at one time."""
    history, model = case.recording.history, case.model
    first = int(np.searchsorted(history.t, t, "left"))
    last = int(np.searchsorted(history.t, t, "right")) - 1
    if first > last:
        yield f"t = {t!r}: an impact without rows in the history"
        return
    before = model.v0 if t == history.t[0] else history.v[first]
    after = history.v[last]
    impulse = np.zeros(model.contacts)
    for e in now:
        impulse[e.contact] += e.impulse
    change = np.zeros(model.bodies + 1)
    np.add.at(change, model.right, impulse)
    np.add.at(change, model.left, -impulse)
    wrong = np.max(np.abs(model.mass * (after - before) - change[:-1]) / model.mass)
    if wrong > part * case.speed:
        yield f"t = {t!r}: momentum differs by {wrong:.3e} m/s of {case.speed:.1e}"
    lost = 0.5 * float(model.mass @ (before**2 - after**2))
    said = sum(e.energy_lost for e in now)
    if abs(lost - said) > part * float(model.mass.sum()) * case.speed**2:
        yield f"t = {t!r}: energy lost {said:.6e}, kinetic energy changes by {lost:.6e}"
    if len({e.group for e in now}) == 1:
        closed = (history.gap[last] == 0.0) | (impulse > 0.0)
        rate = model.rates(before)
        opening = model.rates(after) + model.restitution * rate
        bad = closed & (rate <= part * case.speed) & (opening < -part * case.speed)
        if bad.any():
            j = int(np.argmin(np.where(bad, opening, 0.0)))
            yield f"t = {t!r}: contact {j}: γ⁺ + ε γ⁻ = {opening[j]:.3e}"


def ledger(case: Case) -> Iterator[str]:
    """The energy ledger closes, and its terms are those of the final state and the events."""
    energy, recording = case.recording.energy, case.recording
    if energy is None:
        return
    if not abs(energy.closure) <= ERRORS * case.rtol:
        yield f"fails to close by {energy.closure:.3e}"
    kinetic = 0.5 * float(case.model.mass @ recording.v**2)
    lost = sum(e.energy_lost for e in recording.events)
    for what, said, is_ in (("kinetic", energy.kinetic, kinetic), ("impact", energy.impact, lost)):
        if abs(said - is_) > ROUNDING * max(case.scales.energy, abs(is_)):
            yield f"{what} energy {said:.6e} instead of {is_:.6e}"
    if energy.viscous < -case.rtol * case.scales.energy or energy.impact < 0.0:
        yield f"viscous {energy.viscous:.3e}, impact {energy.impact:.3e}"


def peaks(case: Case) -> Iterator[str]:
    """No row of the history lies outside the extremes; times do not decrease.

    No time passes in the state before an impact at the start, and no extreme has it.
    """
    recording, history = case.recording, case.recording.history
    if np.any(np.diff(history.t) < 0.0):
        yield "the times of the history decrease"
    begun = int(np.flatnonzero(history.t == history.t[0])[-1]) if history.t.size else 0
    for what, values, extremes, scale in (
        ("displacement", history.u[begun:], recording.displacement, case.length),
        (
            "acceleration",
            history.a[begun:],
            recording.acceleration,
            case.force / case.model.mass.min(),
        ),
    ):
        over = max(
            float(np.max(values - extremes.maximum, initial=0.0)),
            float(np.max(extremes.minimum - values, initial=0.0)),
        )
        if over > ERRORS * case.rtol * scale:
            yield f"{what} beyond its extreme by {over:.3e} of {scale:.1e}"
