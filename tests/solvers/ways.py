"""The same task by other ways into SUNDIALS."""

from dataclasses import replace

import pytest

from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.sundials import library

WAYS = ("wrapped", "sundials")
"""Through scikit-sundae's own interface, and with the library's root finder."""


def directly_and_by(
    way: str, task: Task, solver: str, monkeypatch: pytest.MonkeyPatch
) -> tuple[Recording, Recording]:
    """What a solver makes of a task directly, and by one of `WAYS`; the events are the same."""
    direct = solver_named(solver).solve(task)
    if way == "wrapped":
        monkeypatch.setattr(library, "library", lambda: None)
        monkeypatch.setattr(library, "ida_library", lambda: None)
    else:
        task = replace(task, settings={"events": "sundials"})
    other = solver_named(solver).solve(task)
    assert [(e.kind, e.contact) for e in other.events] == [
        (e.kind, e.contact) for e in direct.events
    ]
    return direct, other
