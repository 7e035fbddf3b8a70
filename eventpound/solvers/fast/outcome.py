"""How runs end, and when they give up."""

from __future__ import annotations

from eventpound.solvers.events.impacts import ENDLESS, NO_FORCES, NO_IMPACT

FINISHED, GOING_ON, NOT_FINITE, PENETRATION, STUCK, NO_STEP, DRIFT = 0, 10, 12, 13, 14, 15, 16
"""How a call of `advance` ends, beside the ends of settling."""
MESSAGES = {
    FINISHED: "reached the end of the run",
    NO_IMPACT: "an impact problem has no solution",
    NO_FORCES: "the forces of resting contacts could not be found",
    ENDLESS: "impacts in one instant do not end",
    NOT_FINITE: "the motion is no longer finite",
    PENETRATION: "a contact penetrates and no impact was found; try a smaller rtol",
    DRIFT: "a gap no longer agrees with the displacements of its bodies; try another rtol",
    STUCK: "events follow each other without an end",
    NO_STEP: "no step is short enough for the equations of motion; try a larger rtol",
}
"""What each end of a run means."""
CASCADE_OVER = 1e-6
"""Part of T without impacts after which a cascade has ended."""
MOST_STALLS = 100
"""Events in a row without progress of time after which a run gives up."""
MOST_HALVINGS = 60
"""Times a step is shortened before a run gives up."""
