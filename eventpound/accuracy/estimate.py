"""A quick estimate of the errors of one run: its distance from a finer one.

The finer run is that of the fast solver two decades below the tolerance, so that for any
other solver it is independent of the one it judges. An estimate is no bound: it says
nothing about conditioning, and two runs may agree by chance. `certify` gives bounds.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from eventpound.accuracy.quantities import quantities_of, values_of
from eventpound.accuracy.sequences import match_events
from eventpound.errors import ComputationError
from eventpound.response import Response
from eventpound.simulation import SMALLEST_RTOL
from eventpound.solvers import solver_named

FINER = 100.0
"""Ratio of the tolerances."""
JUDGE = "fast"
"""The solver of the finer run."""


def estimate_errors(response: Response) -> dict[str, Any]:
    """Estimated errors of the peaks and final values of a run.

    Parameters
    ----------
    response : Response
        The run.

    Returns
    -------
    dict
        ``by`` what, ``events_agree``, and ``peaks`` and ``final`` as in the
        summary, with errors in the place of values; ``failed`` with the reason
        instead of these where the finer run failed.
    """
    task, recording = response.task, response.recording
    rtol = max(task.rtol / FINER, SMALLEST_RTOL)
    estimate: dict[str, Any] = {"by": f"{JUDGE} at rtol {rtol:g}"}
    finer = replace(
        task,
        rtol=rtol,
        atol={},
        energy=False,
        settings={},
        output_times=np.empty(0),
        progress=None,
        max_steps=None,
    )
    try:
        other = solver_named(JUDGE).solve(finer)
    except ComputationError as error:
        return estimate | {"failed": str(error)}
    matching = match_events(recording.events, other.events, len(task.scene.contacts))
    estimate["events_agree"] = matching.parting is None
    wanted = [
        quantity
        for quantity in quantities_of(task.scene, recording, task.end - task.start)
        if quantity.row < 0
    ]
    errors = np.abs(
        values_of(task.scene, recording, wanted, {}) - values_of(task.scene, other, wanted, {})
    )
    for quantity, off in zip(wanted, errors, strict=True):
        kind, _, rest = quantity.name.partition(".")
        name, _, key = rest.rpartition(".")
        estimate.setdefault(kind, {}).setdefault(name, {})[key] = float(off)
    return estimate
