"""How a chunk of steps ends."""

from __future__ import annotations

DONE, NO_ROOM, NOT_CONVERGED, NOT_SOLVED = range(4)
"""All steps taken; too little room for the events of the next; Newton's iteration or the
complementarity problem of the next fails."""

MESSAGES = {
    DONE: "reached the end of the run in steps of at most {step:.6g} s",
    NOT_CONVERGED: "Newton's iteration of a step of {step:.6g} s does not converge; "
    "try a smaller time_step",
    NOT_SOLVED: "the complementarity problem of a step of {step:.6g} s is not solved; "
    "try a smaller time_step",
}
