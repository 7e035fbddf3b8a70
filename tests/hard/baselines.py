"""What the fixed-step baselines make of a hard scene, beside what the others agree on."""

import math
from dataclasses import dataclass

from eventpound.accuracy.quantities import FINAL, PEAKS, errors_of, truth_of
from eventpound.errors import ComputationError, InputError
from eventpound.response import Response
from eventpound.simulation import response_of
from eventpound.solvers.base import Recording
from tests.hard.catalogue import Hard

BASELINES = ("moreau", "penalty")
MOST_STEPS = 3_000_000
"""Of one run: a pulse of a millionth of the structure's period asks for 100 000 000."""


@dataclass(frozen=True)
class Baseline:
    """One baseline's part.

    Parameters
    ----------
    error : float
        Largest error of a peak or a final value in parts of the body's own motion;
        NaN where there is none to state.
    missed, extra : int
        Impacts.
    refusal : str
        What it said instead, or where it stopped.
    """

    error: float = math.nan
    missed: int = 0
    extra: int = 0
    refusal: str = ""

    @property
    def text(self) -> str:
        """In a cell of a table."""
        if "limit of" in self.refusal:
            return f"takes more than {MOST_STEPS:.0e} steps"
        if self.refusal:
            return self.refusal.split(";")[0]
        impacts = [f"{n} {word}" for n, word in ((self.missed, "missed"), (self.extra, "extra"))]
        return ", ".join([f"{self.error:.0e}", *(x for x in impacts if not x.startswith("0 "))])


def baseline(hard: Hard, solver: str, agreed: Response | None) -> Baseline:
    """Run a scene with the steps that the solver chooses by itself."""
    try:
        found = response_of(hard.case, solver=solver, settings={}, max_steps=MOST_STEPS)
    except (ComputationError, InputError) as error:
        return Baseline(refusal=str(error))
    if agreed is None:
        return Baseline(refusal="ends, where there is no answer")
    return _against(agreed, found.recording)


def _against(agreed: Response, found: Recording) -> Baseline:
    """Errors of a run."""
    truth = truth_of(agreed.task, agreed.recording)
    errors = errors_of(agreed.scene, found, truth, None)
    worst = max(errors.largest(PEAKS), errors.largest(FINAL))
    return Baseline(worst, errors.impacts.missed, errors.impacts.extra)
