"""Lines of the history at instants at which something happens."""

import numpy as np
import pytest

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
from eventpound.simulation import response_of
from eventpound.solvers.events.recorder import history_of, row_width

# A record that begins with a jump to 1 m/s².
JUMP = Record(np.cos(0.3 * np.arange(200)), 0.02)


def _meeting(gap: float = 0.0) -> Scene:
    """Two bodies that meet; one yields, the other is on the soft side of a kinked spring."""
    return Scene(
        (Body("a", 1.0, 0.0, 0.5), Body("b", 2.0, 0.01)),
        (
            Spring("s", (GROUND, "a"), BoucWen(9.0, 2.0, 0.01, initial_z=0.25)),
            Spring("q", ("b", GROUND), BilinearElastic(7.0, 3.0)),
        ),
        (Dashpot((GROUND, "a"), 0.3),),
        (Contact("joint", "a", "b", gap - 0.01, 0.5),),
        JUMP,
    )


def test_an_impact_at_the_start_has_the_state_before_it(solver):
    response = response_of(_meeting(), solver, 1e-8, duration=1.0, output_step=0.02)
    history = response.recording.history
    assert history.t[:3].tolist() == [0.0, 0.0, 0.02]
    assert history.v[0].tolist() == [0.5, 0.0]
    # v_b - v_a = ε 0.5, momentum kept.
    assert history.v[1] == pytest.approx([0.0, 0.25], abs=1e-15)
    assert history.u[0] == pytest.approx([0.0, 0.01], abs=0.0)
    assert history.z[0].tolist() == [0.25]
    # Pushed into by 0.01 m: the stiffness of compression.
    assert history.force[0] == pytest.approx([0.25 * 2.0, -0.07], rel=1e-12)
    # The dashpot takes part in what accelerates.
    assert history.a[0] == pytest.approx([-0.5 - 0.15, -0.07 / 2.0], rel=1e-12)
    assert history.ground[0] == history.ground[1] == 1.0
    assert history.gap[0].tolist() == [0.0]
    assert np.all(np.diff(history.t[1:]) > 0.0)


def test_the_start_has_one_line_where_nothing_happens(solver):
    response = response_of(_meeting(10.0), solver, 1e-8, duration=1.0, output_step=0.02)
    history = response.recording.history
    assert not response.recording.events
    assert history.t[:3].tolist() == [0.0, 0.02, 0.04]


def test_an_output_time_at_an_event_has_no_line_of_its_own(solver):
    # A free body that meets the wall at t = 1.
    scene = Scene(
        (Body("a", 1.0, 0.0, 1.0),),
        (Spring("s", (GROUND, "a"), Linear(0.0)),),
        contacts=(Contact("wall", "a", BARRIER, 1.0, 0.5),),
    )
    history = response_of(scene, solver, 1e-8, duration=2.0, output_step=0.5).recording.history
    rows = np.column_stack((history.t, history.u, history.v))
    assert not (rows[1:] == rows[:-1]).all(axis=1).any()
    near = np.abs(history.t - 1.0) < 1e-9
    assert sorted(np.unique(np.round(history.v[near, 0], 9))) == [-0.5, 1.0]


def _with_each_line_once(lines: list[list[float]]) -> list[list[float]]:
    """Two lines of an instant, one of the first, beside those that differ from the line before."""
    kept: list[list[float]] = []
    for t in sorted({line[0] for line in lines}):
        instant = [line for line in lines if line[0] == t]
        fewest = 1 if t == lines[0][0] else 2
        row = 1
        while row < len(instant) and len(instant) > fewest:
            if instant[row] == instant[row - 1]:
                del instant[row]
            else:
                row += 1
        kept += instant
    return kept


@pytest.mark.parametrize("bodies", [1, 40])
@pytest.mark.parametrize("seed", range(40))
def test_lines_that_are_said_again_are_left_out(seed, bodies):
    model = assemble(Scene(tuple(Body(f"b{i}", 1.0) for i in range(bodies))))
    dice = np.random.default_rng(seed)
    rows = np.zeros((dice.integers(0, 25), row_width(model)))
    rows[:, 0] = np.sort(dice.integers(0, 6, rows.shape[0]))
    rows[:, dice.integers(1, rows.shape[1])] = dice.integers(0, 2, rows.shape[0])
    history = history_of(rows, np.ones(0, bool), model)
    parts = history.t, history.ground, history.u, history.v, history.a
    assert np.column_stack(parts).tolist() == _with_each_line_once(rows.tolist())
