"""What compiled functions hand to Python is numbers, arrays and plain tuples of them.

To make a named tuple, or any other object of a class written in Python, Numba's wrapper
runs Python. A signal that came while the function ran is answered there, by an exception
that the wrapper does not look for: the process dies.
"""

from typing import Any

import numpy as np
import pytest
from numba.core import types

from eventpound import Record, simulate_many
from eventpound.numerics.compiled.linked import Entry
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import response_of
from tests.solvers.scenes import pounding_pair

SHAKEN = Record(np.sin(np.arange(200) * 0.3), 0.02)


def squeezed() -> Scene:
    """A body without play between two barriers: its contacts are locked."""
    return Scene(
        bodies=(Body("a", 1.0), Body("b", 1.0, 0.0, -0.5)),
        springs=(Spring("s", (GROUND, "b"), Linear(3.0)),),
        contacts=(
            Contact("left", BARRIER, "a", 0.0, 0.0),
            Contact("right", "a", BARRIER, 0.0, 0.0),
        ),
        motion=SHAKEN,
    )


def scenes() -> tuple[Scene, ...]:
    pair = pounding_pair()
    shaken = Scene(pair.bodies, pair.springs, pair.dashpots, pair.contacts, SHAKEN)
    return pair, shaken, squeezed()


def runs_python(kind: Any) -> bool:
    """Whether making an object of this type runs Python."""
    if isinstance(kind, types.BaseTuple):
        return isinstance(kind, types.BaseNamedTuple) or any(map(runs_python, kind.types))
    return not isinstance(kind, types.Number | types.Boolean | types.Array | types.NoneType)


@pytest.fixture
def returned(monkeypatch):
    """What functions return that Python called since, by their names."""
    called: set[Any] = set()
    itself = Entry.__mro__[1].__call__

    def call(entry: Entry, *arguments: Any, **named: Any) -> Any:
        called.add(entry)
        return itself(entry, *arguments, **named)

    monkeypatch.setattr(Entry, "__call__", call, raising=False)
    return lambda: {
        f"{entry.py_func.__module__}.{entry.py_func.__name__}": compiled.signature.return_type
        for entry in called
        for compiled in entry.overloads.values()
    }


@pytest.mark.parametrize("solver", ["cvode", "ida", "fast", "moreau", "penalty"])
def test_no_objects_of_python_classes(solver, returned):
    settings = {"time_step": 1e-3} if solver in ("moreau", "penalty") else None
    for scene in scenes():
        response_of(scene, solver, 1e-6, duration=2.0, energy=True, settings=settings)
    found = returned()
    assert found
    assert not {name: kind for name, kind in found.items() if runs_python(kind)}


def test_none_of_many_runs(returned):
    simulate_many(pounding_pair(), {"body.a.mass": [1.0, 1.1]}, rtol=1e-6, duration=1.0)
    found = returned()
    assert found
    assert not {name: kind for name, kind in found.items() if runs_python(kind)}
