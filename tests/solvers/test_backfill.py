"""Soil behind abutments beside a program in SciPy that keeps its deepest point, and by hand."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from eventpound import ComputationError, Response, simulate, simulate_many
from eventpound.motion import Cosine, MavroeidisPapageorgiou, NoMotion
from eventpound.scene import (
    GROUND,
    Backfill,
    Body,
    BoucWen,
    Contact,
    Linear,
    Scene,
    Spring,
    Support,
)
from eventpound.solvers.base import Task
from tests.oracle.laws import Soil
from tests.oracle.line import Answer, solved

SOIL = Backfill("100 MN/m", "5 MN", 0.7, "2 cm")
GROWING = MavroeidisPapageorgiou(6.0, 0.9, gamma=5.0)
DECK = Body("deck", 1.0e6)
HELD = Spring("bearing", (GROUND, "deck"), Linear(2.0e7))
LEFT = Spring("left", (GROUND, "deck"), SOIL)
RIGHT = Spring("right", ("deck", GROUND), replace(SOIL, gap=0.05))
BETWEEN_TWO = Scene((DECK,), (HELD, LEFT, RIGHT), motion=GROWING)
POUNDING = Scene(
    (DECK, Body("span", 6.0e5)),
    (HELD, LEFT, Spring("pier", (GROUND, "span"), Linear(4.0e7)),
     Spring("far", ("span", GROUND), SOIL)),
    contacts=(Contact("joint", "deck", "span", 0.03, 0.6),),
    motion=GROWING,
)  # fmt: skip
# Pushed into soil that is touched, then thrown back by another body while it yields.
THROWN_BACK = Scene(
    (Body("deck", 1.0e6, velocity=-1.0), Body("other", 2.0e6, displacement=-0.05, velocity=0.8)),
    (HELD, replace(LEFT, law=replace(SOIL, gap=0.0))),
    contacts=(Contact("joint", "other", "deck", 0.0, 0.5),),
    motion=NoMotion(),
)
PRESSED_IN = Scene((Body("deck", 1.0e6, displacement=-0.2),), (HELD, LEFT, RIGHT))
SOLVERS = [
    *(
        (solver, {"events": events})
        for solver in ("cvode", "ida")
        for events in ("own", "sundials")
    ),
    ("fast", {}),
]
RTOL = 1e-10
LENGTH = 0.1
"""How far a deck moves (m)."""
# Errors of single steps add up over thousands of them; turns between soils make them grow.
CLOSE = 100.0 * RTOL


@cache
def by_scipy(scene: Scene, end: float) -> Answer:
    return solved(scene, end, LENGTH, 1.0, [piece.end for piece in scene.motion.pieces()])


def answered(scene: Scene, solver: str, settings: dict, end: float) -> tuple[Response, Answer]:
    response = simulate(
        scene, solver=solver, settings=settings, duration=end, rtol=RTOL, energy=True
    )
    return response, by_scipy(scene, end)


def lost_and_stored(soil: Soil, x: float) -> tuple[float, float]:
    """Work lost in a soil and what it can give back (J), by hand from its deepest point."""
    law, y = soil.law, soil.deepest
    Q = law.ultimate_force / law.failure_ratio
    in_all = Q * (y - Q / law.initial_stiffness * math.log1p(y * law.initial_stiffness / Q))
    given_back = [soil.backbone(y), max(law.initial_stiffness * (soil.depth(x) - soil.left), 0.0)]
    back, now = (F**2 / (2.0 * law.initial_stiffness) for F in given_back)
    return in_all - back, now


@pytest.mark.parametrize(("solver", "settings"), SOLVERS)
@pytest.mark.parametrize(
    ("scene", "end", "least"),
    [(BETWEEN_TWO, 8.0, 30), (POUNDING, 6.0, 30), (THROWN_BACK, 2.0, 3), (PRESSED_IN, 3.0, 5)],
    ids=["two abutments", "pounding", "thrown back", "pressed in"],
)
def test_motion_is_that_of_soil_which_remembers_its_deepest_point(
    scene, end, least, solver, settings
):
    response, answer = answered(scene, solver, settings, end)
    found, size = response.recording, np.abs(response.recording.history.u).max()
    assert len(answer.turns) >= least
    np.testing.assert_allclose(found.u, answer.u, rtol=0.0, atol=CLOSE * size)
    impacts = [event.t for event in found.events]
    np.testing.assert_allclose(impacts, answer.impacts, rtol=0.0, atol=CLOSE)
    stored = 0.0
    for spring, soil in zip(
        [s for s in scene.springs if isinstance(s.law, Backfill)], answer.soils, strict=True
    ):
        lost, now = lost_and_stored(soil, float(soil.row @ answer.u))
        name, stored = f"springs.{spring.name}", stored + lost + now
        assert response.quantity(f"{name}.dissipated_energy") == pytest.approx(lost, rel=1e-7)
        gap = response.quantity(f"{name}.residual_gap")
        assert gap == pytest.approx(soil.law.gap + soil.left, rel=1e-8)
        depth = response.quantity(f"{name}.passive_depth")
        assert depth == pytest.approx(soil.deepest, rel=1e-8)
        force = response.quantity(f"{name}.passive_force")
        assert force == pytest.approx(soil.backbone(soil.deepest), rel=1e-8)
    begun = sum(
        lost_and_stored(replace(soil, deepest=depth), 0.0)[0] + soil.backbone(depth) ** 2
        / (2.0 * soil.law.initial_stiffness)
        for soil in answer.soils
        if (depth := soil.depth(float(soil.row @ [b.displacement for b in scene.bodies]))) > 0.0
    )  # fmt: skip
    assert found.energy.hysteretic == pytest.approx(stored - begun, rel=1e-7)


def test_each_of_many_runs_has_the_push_on_its_own_soil():
    gaps, forces = np.array([0.01, 0.03]), np.array([4e6, 6e6])
    names = ["springs.left.passive_force", "springs.left.passive_depth"]
    varied = {"spring.left.gap": gaps, "spring.left.ultimate_force": forces}
    many = simulate_many(BETWEEN_TWO, varied, quantities=names, duration=3.0)
    for i, (gap, force) in enumerate(zip(gaps, forces, strict=True)):
        left = replace(LEFT, law=replace(SOIL, gap=gap, ultimate_force=force))
        history = simulate(replace(BETWEEN_TWO, springs=(HELD, left, RIGHT)), duration=3.0).history
        found = many.table[names].iloc[i]
        # A row stands at each turn.
        assert found.iloc[0] == pytest.approx(-history["force.left"].min(), rel=1e-6)
        assert found.iloc[1] == pytest.approx(-history["u.deck"].min() - gap, rel=1e-6)


@pytest.mark.parametrize("solver", ["cvode", "fast"])
def test_soil_does_not_pull_by_rounding(solver):
    response = simulate(BETWEEN_TWO, solver, 1e-7, duration=3.0)
    for name in ("left", "right"):
        # As of a body at rest: what is never exceeded is attained at the start.
        assert response.quantity(f"springs.{name}.max_force") == 0.0
        assert response.quantity(f"springs.{name}.t_max_force") == 0.0
        peak = response.quantity(f"springs.{name}.passive_force")
        assert response.quantity(f"springs.{name}.min_force") == pytest.approx(-peak, rel=1e-5)


def test_soil_that_a_wider_gap_keeps_from_the_deck_is_not_pushed():
    scene = Scene(
        [Body("deck", 1e5, velocity=-0.1)],
        [
            Spring("pier", (GROUND, "deck"), Linear(1e7)),
            Spring("soil", (GROUND, "deck"), Backfill(2e7, 4e5, 0.7, 0.005, initial_gap=0.02)),
        ],
        motion=NoMotion(),
    )
    response = simulate(scene, duration=1.0)
    # It swings by v sqrt(m/k) to either side, beyond the gap as built.
    assert response.peaks["min"]["deck"] == pytest.approx(-0.01, rel=1e-6)
    names = ("passive_force", "passive_depth")
    assert [response.quantity(f"springs.soil.{name}") for name in names] == [0.0, 0.0]


def test_soil_of_a_run_that_was_stopped_is_where_its_support_is():
    springs = [
        Spring("pier", ("bank", "deck"), Linear(1e7)),
        Spring("soil", ("bank", "deck"), Backfill(2e7, 4e5, 0.7, 0.5)),
    ]
    bank = Support("bank", motion=Cosine(3.0, 0.8))
    scene = Scene([Body("deck", 1e5)], springs, motion=NoMotion(), supports=[bank])
    with pytest.raises(ComputationError, match="limit of 60 steps") as error:
        simulate(scene, "cvode", max_steps=60, output_step=0.05)
    assert error.value.recording is not None
    stopped = Response(Task(scene, 0.0, 4.0, 1e-9), "cvode", error.value.recording)
    assert stopped.recording.t > stopped.recording.history.t[-1]
    # It was not touched.
    assert stopped.quantity("springs.soil.residual_gap") == pytest.approx(0.5, rel=1e-7)


def test_soil_under_a_slow_push_goes_along_its_loop_by_hand():
    # K0 = F_ult = R_f = 1: F = y/(1 + y), 1/2 at y = 1, with a residual gap of 1/2.
    law = Backfill(1.0, 1.0, 1.0)
    z = law.z_at(-1.0)
    assert z == pytest.approx(-0.5)
    assert law.residual_gap(-1.0, z) == pytest.approx(0.5)
    assert law.dissipated(-1.0, z) == pytest.approx(1.0 - math.log(2.0) - 0.125, rel=1e-14)
    assert law.residual_gap(-0.75, z + 0.25) == pytest.approx(0.5)


def test_soil_beside_a_bearing_that_yields_keeps_energy():
    bearing = replace(HELD, law=BoucWen("10 MN/m", "500 kN", "1 cm"))
    scene = replace(BETWEEN_TWO, springs=(bearing, LEFT, RIGHT))
    energy = simulate(scene, duration=8.0, rtol=1e-9, energy=True).energy
    assert abs(energy.closure) < 1e-7
