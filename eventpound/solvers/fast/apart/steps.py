"""Bodies that go apart: each by the steps of a run of its own.

Bodies on springs to the ground have nothing to do with each other but a ground motion, until a
contact closes. So each takes the steps of a single body (`eventpound.solvers.fast.sdof`) with a
clock of its own (`eventpound.solvers.fast.apart.own`): one that passes the knee of its backbone in
short steps keeps no other from long ones. They go in the order of what happens to them
(`eventpound.solvers.fast.apart.together`), under a record from sample to sample
(`eventpound.solvers.fast.apart.windows`).

Where more than two of them may be concerned all bodies are brought to one instant, and
`eventpound.solvers.fast.step` goes on, as everywhere else.
"""

from __future__ import annotations

from eventpound.contact.cascade import is_fleeting
from eventpound.motion.base import Family
from eventpound.motion.forcing import CurrentPiece
from eventpound.numerics.by_address import by_address
from eventpound.solvers.fast.apart.own import START, Window, go, take_own
from eventpound.solvers.fast.apart.together import go_together
from eventpound.solvers.fast.apart.windows import go_by_windows, windows_fit
from eventpound.solvers.fast.compiled import compiled, compiled_deferred
from eventpound.solvers.fast.links import CORE
from eventpound.solvers.fast.run import FastRun
from eventpound.tolerances import OWN_GAP

_SAMPLES = int(Family.SAMPLES)


@compiled
def may_go_apart(piece: CurrentPiece, run: FastRun) -> bool:
    """Whether nothing rests or has a kink, no gap is small, and it pays.

    Under a formula it does once a link has left the core of its backbone: before, no body ends a
    step.
    """
    plan, state = run.plan, run.state
    if run.series.each.body.size == 0 or plan.links.kinked:
        return False
    if state.progress[0].resting > 0 or is_fleeting(0.0, state.now[0], plan.limits.time):
        return False
    for j in range(state.gap.size):
        if not state.gap[j] >= OWN_GAP * plan.limits.length:
            return False
    if piece.family >= _SAMPLES:
        return piece.family == _SAMPLES and windows_fit(piece.coefficients[1], run)
    for h in range(state.part.size):
        if state.part[h] != CORE:
            return True
    return False


@compiled_deferred
def go_apart(budget: int, stop: float, piece: CurrentPiece, run: FastRun) -> None:
    """Steps of each body by itself, to `stop` (s) at most and `budget` in all; then one instant."""
    state, each, now = run.state, run.series.each, run.state.now[0].t
    window = by_address(Window(now, stop, -1, piece))
    for b in range(each.body.size):
        go(b, START, now, window, run)
        each.until[b] = now
    if piece.family == _SAMPLES:
        go_by_windows(budget, stop, piece, run)
    else:
        each.outside[:] = 0.0
        state.progress[0].steps += go_together(budget, window, run)
    for b in range(each.body.size):
        state.progress[0].expansions += each.progress[b].expansions
        take_own(b, run)
