"""Exact steps of several bodies from sample to sample: matrices, motion, rows and pauses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from eventpound.mechanics.model import assemble
from eventpound.motion.record import Record
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.fast import solver as fast
from eventpound.solvers.fast.sampled.exact import KEPT, blank_tables, table_of

END = 12.0
STEP = 0.02


def record() -> Record:
    t = STEP * np.arange(501)
    return Record(np.sin(2.3 * t) * np.sin(7.1 * t + 1.0) * np.exp(-(((t - 4.0) / 3.0) ** 2)), STEP)


def bridge(yields: bool, gap: float, damping: float = 0.3) -> Scene:
    """Two segments on springs, joined by a cable, one with a stop that acts when pushed into."""
    laws = (
        (BoucWen(4.0, 1.2, 0.1, 20.0), BoucWen(3.0, 1.5, 0.2, 20.0, 0.7, 0.3))
        if yields
        else (Linear(16.0), Linear(10.5))
    )
    springs = (
        Spring("left", (GROUND, "a"), laws[0]),
        Spring("right", (GROUND, "b"), laws[1]),
        Spring("cable", ("a", "b"), Linear(0.8)),
        Spring("stop", ("b", GROUND), BilinearElastic(9.0, 0.4, 0.02)),
    )
    dashpots = (Dashpot((GROUND, "a"), damping), Dashpot(("a", "b"), 0.5 * damping))
    contacts = (Contact("joint", "a", "b", gap, 0.7), Contact("end", "b", BARRIER, 0.4, 0.5))
    bodies = (Body("a", 1.0), Body("b", 2.2, 0.01, 0.05))
    return Scene(bodies, springs, dashpots if damping else (), contacts, record())


BRIDGES = {
    "linear": bridge(False, 2.0),
    "linear, undamped": bridge(False, 2.0, 0.0),
    "linear, pounding": bridge(False, 0.02),
    "yielding": bridge(True, 2.0),
    "yielding, undamped": bridge(True, 2.0, 0.0),
    "yielding, pounding": bridge(True, 0.03),
}


def solved(scene: Scene, rows: int) -> Recording:
    times = np.linspace(0.0, END, rows)
    return solver_named("fast").solve(Task(scene, 0.0, END, 1e-8, output_times=times))


@pytest.mark.usefixtures("interpreted")
@pytest.mark.parametrize("dt", [1e-9, 0.005, 0.02, 0.08])
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_tables_are_those_of_the_matrix_exponential(dt: float, damping: float) -> None:
    # Without damping every other term of the series is zero.
    scene = bridge(False, 2.0, damping)
    model = assemble(scene)
    tangents = model.elastic.extension
    tables = blank_tables(model.bodies, model.links)
    i = table_of(dt, tangents, model.link_ends, model.law.damping, model.mass, tables)
    # u'' = a, a' = -K v - C a - s: the vector (u, v, a, s) is carried by one exponential.
    n, directions = model.bodies, np.zeros((model.links, model.bodies))
    for link, (first, second) in enumerate(model.link_ends):
        for body, sign in ((first, -1.0), (second, 1.0)):
            if body >= 0:
                directions[link, body] = sign
    K, C = (
        (directions.T * constants) @ directions / model.mass[:, None]
        for constants in (tangents, model.law.damping)
    )
    whole, one = np.zeros((3 * n + 1, 3 * n + 1)), np.eye(n)
    whole[:n, n : 2 * n] = whole[n : 2 * n, 2 * n : 3 * n] = one
    whole[2 * n : 3 * n, n : 2 * n], whole[2 * n : 3 * n, 2 * n : 3 * n] = -K, -C
    whole[2 * n : 3 * n, -1] = -1.0
    step = expm(dt * whole)
    for found, rows, columns, scale in (
        (tables.of_v[i], slice(0, n), slice(n, 2 * n), dt),
        (tables.of_a[i], slice(0, n), slice(2 * n, 3 * n), dt**2),
        (tables.of_slope[i], slice(0, n), -1, dt**3),
        (tables.rate_of_v[i], slice(n, 2 * n), slice(n, 2 * n), 1.0),
        (tables.rate_of_a[i], slice(n, 2 * n), slice(2 * n, 3 * n), dt),
        (tables.rate_of_slope[i], slice(n, 2 * n), -1, dt**2),
    ):
        np.testing.assert_allclose(found, step[rows, columns], rtol=0.0, atol=1e-14 * scale)


@pytest.mark.usefixtures("interpreted")
def test_a_table_is_made_once_and_the_oldest_makes_room() -> None:
    model = assemble(bridge(False, 2.0))
    tables = blank_tables(model.bodies, model.links)
    constants = model.link_ends, model.law.damping, model.mass

    def number(k: int) -> int:
        return int(table_of(STEP, np.full(model.links, float(k)), *constants, tables))

    made = [number(k) for k in range(KEPT)]
    assert sorted(made) == list(range(KEPT))
    assert [number(k) for k in range(KEPT)] == made
    assert number(KEPT) == made[0]
    assert number(1) == made[1]


@pytest.mark.parametrize("name", BRIDGES)
def test_rows_and_pauses_change_nothing(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    few = solved(BRIDGES[name], rows=2)
    many = solved(BRIDGES[name], rows=1777)
    monkeypatch.setattr(fast, "BUDGET", 3)
    paused = solved(BRIDGES[name], rows=2)
    for other in (many, paused):
        assert other.work.steps == few.work.steps
        for which in ("u", "v", "z", "smallest_gap"):
            np.testing.assert_array_equal(getattr(other, which), getattr(few, which))
        np.testing.assert_array_equal(other.displacement.maximum, few.displacement.maximum)
        np.testing.assert_array_equal(other.base_shear.minimum, few.base_shear.minimum)
