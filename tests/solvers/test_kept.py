"""Whether the fast solver is compiled is told without compiling it."""

import pytest

from eventpound.numerics.compiled import store
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.solvers.fast.advance import advance
from eventpound.solvers.fast.sdof.oscillator import oscillate_alone
from eventpound.solvers.fast.solver import kernels_kept

ALONE = Scene(
    (Body("b", 1.0, -0.1),),
    (Spring("s", (GROUND, "b"), BoucWen(1.0, 1.0, 0.05)),),
    contacts=(Contact("wall", "b", BARRIER, 0.5, 0.5),),
)
PAIR = Scene(
    (Body("a", 1.0, -0.1), Body("b", 1.0)),
    (Spring("s", (GROUND, "a"), BoucWen(1.0, 1.0, 0.05)), Spring("t", ("b", GROUND), Linear(2.0))),
    contacts=(Contact("joint", "a", "b", 0.1, 0.5),),
)


@pytest.mark.parametrize("scene", [ALONE, PAIR])
def test_kept_after_a_run(scene, tmp_path, monkeypatch):
    task = Task(scene, 0.0, 1.0, 1e-6)
    solver_named("fast").solve(task)
    assert kernels_kept(task)
    for kernel in (oscillate_alone, advance):
        monkeypatch.setattr(kernel, "overloads", {})
    # As a process finds it that has not run yet: by the files alone.
    assert kernels_kept(task)
    monkeypatch.setattr(store, "folders", lambda file: (tmp_path,))
    assert not kernels_kept(task)
    assert not list(tmp_path.iterdir())
