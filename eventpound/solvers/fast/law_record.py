"""What contacts with a law leave in the record of the Taylor stepper."""

from __future__ import annotations

from eventpound.mechanics.contact_elements import SMOOTH_CODES
from eventpound.motion.forcing import ground_acceleration
from eventpound.solvers.events import noise
from eventpound.solvers.events.cascade import T
from eventpound.solvers.events.law_contacts import CLOSED, DRAG, add_share, turn
from eventpound.solvers.fast.compiled import compiled_deferred
from eventpound.solvers.fast.elongation import gap_of
from eventpound.solvers.fast.evaluate import look_apart
from eventpound.solvers.fast.law_kinks import keep_side
from eventpound.solvers.fast.ledger import NODES, WEIGHTS
from eventpound.solvers.fast.length import defect_error
from eventpound.solvers.fast.run import Piece, Run


@compiled_deferred
def turn_laws(run: Run) -> None:
    """Begin and end times in contact where the branches of elements have changed."""
    plan, state = run.plan, run.state
    laws, links = plan.laws, plan.links
    for p in range(laws.contact.size):
        a, j = links.plain + p, laws.contact[p]
        closed = state.branch[a] < 0
        gap, rate = gap_of(j, plan.contacts, state.u, state.v)
        length = plan.limits.length
        turn(p, closed, gap, rate, length, laws, state.clock, state.count, run.record.events)
        smooth = closed and int(links.law.exponent[a]) >= SMOOTH_CODES
        links.law.damping[a] = laws.touch[DRAG, p] if smooth else 0.0
        if closed:
            keep_side(p, run)


@compiled_deferred
def law_defect(tau: float, order: int, piece: Piece, run: Run) -> float:
    """Error of a step of length tau (s), in units of its tolerance, as its middle tells.

    The end does not tell where a contact closes at the start and parts at the end: there is no
    force at either. Of a step from a closing the defect grows like τ^(1/4) at worst, and leaves
    all of itself, not a part. 0 where no element is closed whose force is no line; `seen` is
    overwritten.
    """
    family, coefficients, samples = piece.family, piece.coefficients, piece.samples
    plan, state, links = run.plan, run.state, run.plan.links
    some, bent = False, False
    for p in range(plan.laws.contact.size):
        a = links.plain + p
        if state.branch[a] < 0 and int(links.law.exponent[a]) < SMOOTH_CODES:
            some = True
            depth = links.offset[a] - run.series.x[a]
            bent = bent or depth <= noise.LENGTH * plan.limits.length
    if not some:
        return 0.0
    worst = 0.0
    for part in (0.5, 1.0):
        t = state.clock[T] + part * tau
        ground = ground_acceleration(family, coefficients, samples, t)
        look_apart(part * tau, order, ground, run)
        worst = max(worst, defect_error(part * tau, order, ground, run))
        if not bent:
            break
    return order * worst if bent else worst


@compiled_deferred
def gather_laws(tau: float, order: int, piece: Piece, run: Run) -> bool:
    """Add what the closed elements do in a step of length tau (s); whether there are any.

    Then `seen` is overwritten.
    """
    family, coefficients, samples = piece.family, piece.coefficients, piece.samples
    laws, seen = run.plan.laws, run.seen
    closed = False
    for p in range(laws.contact.size):
        closed = closed or laws.touch[CLOSED, p] != 0.0
    if not closed:
        return False
    for i in range(NODES.size):
        at = 0.5 * tau * (1.0 + NODES[i])
        t = run.state.clock[T] + at
        look_apart(at, order, ground_acceleration(family, coefficients, samples, t), run)
        for p in range(laws.contact.size):
            j = laws.contact[p]
            weight = 0.5 * tau * WEIGHTS[i]
            add_share(p, weight, seen.contact_force[j], seen.gap_rate[j], laws)
    return True
