"""Series of z where time cannot be eliminated: of laws that are more than Bouc-Wen's.

The table of laws (`eventpound.mechanics.elements`) tells the Taylor coefficients of z' one by one,
as those of the motion become known, and which constants a law has on its present branch. To
everyone else such a z stands still in a step (`Hysteresis.followed`): here it, and the forces, get
what it changes by. Where the formula of its rate changes a step ends
(`eventpound.solvers.fast.locate`).

What a step of length h leaves is judged by the last two terms of z, and at its end by the defect
of z', which leaves h/p of itself in z.
"""

from __future__ import annotations

from eventpound.contact.kinks import still_rate
from eventpound.mechanics.elements import (
    branch_within,
    memory_on_branches,
    number_beside,
    pull_per_z,
    z_coefficient,
    z_rate,
)
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.compiled import kernel
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.links import add_pull, elongation
from eventpound.solvers.fast.run import LOCAL_SHARE, FastRun
from eventpound.solvers.fast.search import distance_coefficient, motion
from eventpound.tolerances import LENGTH


@compiled
def follows(run: FastRun) -> bool:
    """Whether a z has a series of its own."""
    return bool(run.plan.hysteresis.followed.size > 0)


@compiled_deferred
def find_branches(run: FastRun) -> None:
    """Branches that z or x' alone decides, as a run begins."""
    plan, state, series = run.plan, run.state, run.series
    links, memory, noise = plan.links, plan.links.law.memory, LENGTH * plan.limits.length
    for h in plan.hysteresis.followed:
        a, z = plan.hysteresis.link[h], state.xi_r[h]
        # With that its z is `xi_r` itself.
        state.sigma[h] = 1.0
        x, x_rate = series.x[a], series.x_rate[a]
        state.branch[a] = branch_within(a, memory, links.offset[a], x, x_rate, z, noise)


@compiled_deferred
def put_on_branches(run: FastRun) -> None:
    """Give links the constants of their present branches."""
    _put_on_branches(run.plan.links.law.memory, run.state.branch, run.series.memory)


@kernel.but(fused=True)
def _put_on_branches(own: Floats, branch: Ints, out: Floats) -> None:
    found = memory_on_branches(own, branch)
    for a in range(branch.size):
        copy_numbers(found[a], out[a])


@compiled_noinline
def begin_followed(run: FastRun) -> None:
    """Make ready what `follow` needs, before stiffnesses are read; every link's start is known."""
    plan, state, series = run.plan, run.state, run.series
    links, limits, of = plan.links, plan.limits, run.series.followed
    of.defect[0] = 0.0
    for i in range(of.sigma.size):
        h = plan.hysteresis.followed[i]
        a = plan.hysteresis.link[h]
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        # Everyone else takes it to be in its core, with Q/u_y in the stiffness; here z has a
        # series.
        series.stiffness[a] = k
        error = limits.atol_z[h] + limits.rtol * abs(series.z[h, 0])
        of.sigma[i], of.weight[i] = 0.0, 1.0 / (LOCAL_SHARE * error)


@compiled_deferred
def follow(k: int, run: FastRun) -> None:
    """Add coefficient k of the forces of memories to links and clusters; k + 1 of every z follows.

    Those of displacements are known up to k + 1.
    """
    plan, series, limits = run.plan, run.series, run.plan.limits
    memory, of, noise = series.memory, series.followed, still_rate(limits.length, limits.time)
    for i in range(of.sigma.size):
        h = plan.hysteresis.followed[i]
        a = plan.hysteresis.link[h]
        first, second = series.ends[a, 0], series.ends[a, 1]
        if first == second:
            continue
        z, x_rate = series.z[h], series.speed[h]
        if k > 0:
            # The force at the start has all of it.
            force = pull_per_z(a, memory) * z[k]
            series.F[a, k] += force
            if first >= 0:
                series.force[first] += force
            if second >= 0:
                series.force[second] -= force
        x_rate[k] = (k + 1) * distance_coefficient(first, second, k + 1, series)
        # z' asks for the sign of x' just after the start: its first coefficient beyond rounding has
        # it.
        level = noise if k == 0 else noise / limits.time if k == 1 else 0.0
        if of.sigma[i] == 0.0 and abs(x_rate[k]) > level:
            of.sigma[i] = 1.0 if x_rate[k] > 0.0 else -1.0
        beside = series.z[plan.links.z_of_link[number_beside(a, memory)]]
        rate = z_coefficient(a, k, memory, x_rate, z, beside, series.power[h], of.sigma[i])
        z[k + 1] = rate / (k + 1)


@compiled_deferred
def last_of_followed(order: int, power: float, over: float, run: FastRun) -> float:
    """The last two terms of z in units of their tolerance; `power` is h^(order-1), `over` 1/h."""
    plan, series, worst = run.plan, run.series, 0.0
    of = series.followed
    for i in range(of.sigma.size):
        h = plan.hysteresis.followed[i]
        a, z = plan.hysteresis.link[h], series.z[h]
        if series.ends[a, 0] != series.ends[a, 1]:
            last = power * max(abs(z[order - 1]), over * abs(z[order - 2]))
            worst = max(worst, last * of.weight[i])
    return worst


@compiled_deferred
def observe_followed(tau: float, order: int, run: FastRun) -> None:
    """Add to what is `observed` what z have changed by after tau (s); how well they hold there."""
    plan, series, observed = run.plan, run.series, run.observed
    links, of = plan.links, run.series.followed
    for i in range(of.sigma.size):
        h = plan.hysteresis.followed[i]
        a = plan.hysteresis.link[h]
        if series.ends[a, 0] == series.ends[a, 1]:
            continue
        change, _, _ = motion(tau, order - 1, series.z[h])
        observed.z[h] += change
        force = pull_per_z(a, series.memory) * change
        observed.force[a] += force
        add_pull(a, force, links, observed)
    of.defect[0] = 0.0
    # After all z have moved, since the rate of one may ask for another.
    for i in range(of.sigma.size):
        of.defect[0] = max(of.defect[0], _defect(i, tau, order, run))


@compiled_noinline
def _defect(i: int, tau: float, order: int, run: FastRun) -> float:
    """What the defect of z' after tau (s) leaves in z, in units of its tolerance."""
    plan, series, observed, of = run.plan, run.series, run.observed, run.series.followed
    h = plan.hysteresis.followed[i]
    a = plan.hysteresis.link[h]
    if series.ends[a, 0] == series.ends[a, 1]:
        return 0.0
    _, x_rate = elongation(plan.links.ends[a, 0], plan.links.ends[a, 1], observed.u, observed.v)
    beside = observed.z[plan.links.z_of_link[number_beside(a, series.memory)]]
    _, slope, _ = motion(tau, order - 1, series.z[h])
    rate = z_rate(a, series.memory, x_rate, of.sigma[i], observed.z[h], beside)
    return abs(rate - slope) * tau / order * of.weight[i]


@compiled_deferred
def keep_followed(ended: bool, run: FastRun) -> None:
    """Make z at the end of a step the present ones; exactly zero where one `ended` it there."""
    for h in run.plan.hysteresis.followed:
        at_zero = ended and run.located.crossed[h]
        run.state.xi_r[h] = 0.0 if at_zero else run.observed.z[h]
        run.located.crossed[h] = False
