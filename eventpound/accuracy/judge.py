"""Whose run tells the errors of another, at which tolerance, and how that is said.

A run by a program of its own is independent of the run that it judges. One by the same program
sees what the tolerance does, but nothing that the program itself does wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from eventpound.response import Response
from eventpound.simulation import SMALLEST_RTOL
from eventpound.solvers import knows_scene, solver_named
from eventpound.solvers.base import Task

FINER, DECADE = 100.0, 10.0
"""Ratio of the tolerances of a run and of its judge, and the least one."""
INDEPENDENT = "fast"
"""The judge that shares least with the others: a program of its own."""
KEEPING = ("cvode", "ida", INDEPENDENT)
"""Solvers that keep a tolerance, so that another one tells how far they are off."""


def judge_of(response: Response, *, asked: bool) -> str | None:
    """The solver whose run tells the errors of another.

    =======================================  ======================  ==========================
    run by                                   not asked               asked for
    =======================================  ======================  ==========================
    ``cvode``, ``ida``                       ``fast``, if compiled,  ``fast``, compiled for it
                                             else itself
    ``cvode``, where ``fast`` does not take  itself                  itself
    the scene
    ``fast``                                 itself                  itself
    others                                   nobody                  ``fast``, else ``cvode``
    =======================================  ======================  ==========================

    Parameters
    ----------
    response : Response
        The run.
    asked : bool
        Whether an estimate is wanted whatever it costs.
    """
    solver = response.solver
    if solver not in KEEPING and not asked:
        return None
    from eventpound.solvers.fast.solver import kernels_kept

    able = knows_scene(solver_named(INDEPENDENT), response.scene)
    if able and (asked or kernels_kept(task_of_judge(response, INDEPENDENT))):
        return INDEPENDENT
    return solver if solver in KEEPING else KEEPING[0]


def rtol_of_judge(rtol: float, judge: str, *, itself: bool) -> float:
    """Tolerance of the run that tells the errors of one at `rtol`.

    Parameters
    ----------
    rtol : float
        Of the run.
    judge : str
        The solver of the other run.
    itself : bool
        Whether the same solver runs again. The same run again would find no error; so where no
        smaller tolerance makes it finer, it takes a larger one and finds its errors.
    """
    finest: float = getattr(solver_named(judge), "finest_rtol", SMALLEST_RTOL)
    if itself and rtol < DECADE * finest:
        return DECADE * rtol
    return max(rtol / FINER, finest)


def task_of_judge(response: Response, judge: str) -> Task:
    """The run by which another is judged."""
    task, itself = response.task, judge == response.solver
    return replace(
        task,
        rtol=rtol_of_judge(task.rtol, judge, itself=itself),
        atol={},
        energy=False,
        settings=task.settings if itself else {},
        output_times=np.empty(0),
        progress=None,
    )


def error_words(estimate: Mapping[str, Any]) -> str:
    """What an estimate comes to, in a line."""
    if "failed" in estimate:
        return f"not known: {estimate['by']} failed"
    if "largest" not in estimate:
        return f"not known: {estimate['missing']}"
    part, quantity = estimate["largest"]["part"], estimate["largest"]["quantity"]
    most = f"{part:.1e} of the largest value of its kind at most ({quantity})"
    return f"{most if part > 0.0 else 'no difference found'}, estimated by {estimate['by']}"
