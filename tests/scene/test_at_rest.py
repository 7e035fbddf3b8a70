"""Springs at rest: periods against SciPy's eigenvalues, tangents against finite differences."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from eventpound import InputError, load_case, modal_damping, rayleigh, simulate_suite
from eventpound.case import read_case
from eventpound.case.defaults import default_duration
from eventpound.scene import (
    BARRIER,
    GROUND,
    Backfill,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Force,
    Linear,
    Scene,
    Series,
    Slider,
    Spring,
)
from eventpound.scene.at_rest import at_rest, springs_at_rest, stiffness_of
from eventpound.scene.modes import modes_of
from eventpound.scene.periods import longest_period, period_called
from eventpound.scene.spring import Law
from eventpound.scene.statics import in_equilibrium
from tests.equilibria.oracle import hysteresis, linkage, sides
from tests.equilibria.scenes import Drawn
from tests.models import CASES
from tests.study.test_suite import time_series

M, K, CABLE = 5e5, 2e7, 6e7
SLACK, TAUT = 2.0 * math.pi * math.sqrt(M / K), 2.0 * math.pi * math.sqrt(M / (K + CABLE))


def deck(law: Law, u: float = 0.0, force: float = 0.0) -> Scene:
    """A deck on a linear pier, with another spring."""
    springs = Spring("pier", (GROUND, "deck"), Linear(K)), Spring("other", (GROUND, "deck"), law)
    forces = (Force("deck", force),) if force else ()
    return Scene((Body("deck", M, u),), springs, forces=forces)


def cable(slack: float) -> BilinearElastic:
    return BilinearElastic(0.0, CABLE, slack)


def beside(law: Law, u: float = 0.0, force: float = 0.0) -> float:
    """What counts of a law beside the pier (N/m), from the longest period."""
    period = longest_period(deck(law, u, force))
    assert period is not None
    return float(M * (2.0 * math.pi / period) ** 2 - K)


def test_a_cable_counts_where_it_is_taut_at_rest():
    assert pytest.approx(0.993, abs=5e-4) == SLACK
    for slack in (5.0, 0.02, 1e-6):
        assert longest_period(deck(cable(slack))) == pytest.approx(SLACK, rel=1e-12)
        assert longest_period(deck(cable(-slack))) == pytest.approx(TAUT, rel=1e-12)


@pytest.mark.parametrize("law", [cable(0.02), Backfill(CABLE, 1e6, 0.8, gap=0.02)])
def test_where_the_run_starts_in_equilibrium_its_side_counts(law):
    way = -1.0 if isinstance(law, Backfill) else 1.0
    scene = deck(law, force=way * 1e6)
    assert longest_period(scene) == pytest.approx(SLACK, rel=1e-12)
    standing = in_equilibrium(scene)
    assert abs(standing.bodies[0].displacement) > 0.02
    assert longest_period(standing) == pytest.approx(TAUT, rel=1e-9)
    assert modes_of(standing, ["deck"]).period == pytest.approx([TAUT], rel=1e-9)


def test_displaced_bodies_that_nothing_holds_there_are_not_at_rest():
    """A deck drawn back by 50 mm swings about where it is slack; one that is held does not."""
    assert beside(cable(0.02), u=0.05) == pytest.approx(0.0, abs=1e-5 * K)
    held = 0.05 * K + (0.05 - 0.02) * CABLE
    assert beside(cable(0.02), 0.05, held) == pytest.approx(CABLE, rel=1e-9)
    assert beside(cable(0.02), 0.05, 1.01 * held) == pytest.approx(0.0, abs=1e-5 * K)
    wall = Contact("wall", BARRIER, "deck", -0.05, 0.5)
    for way, counts in ((-1.0, CABLE), (1.0, 0.0)):
        scene = replace(deck(cable(0.02), 0.05, held + way * 1e5), contacts=(wall,))
        period = SLACK if counts == 0.0 else TAUT
        assert longest_period(scene) == pytest.approx(period, rel=1e-9)
    slider = Spring("slider", (GROUND, "deck"), Slider(0.1, 1e7))
    for friction, period in ((0.99e6, TAUT), (1.01e6, SLACK)):
        scene = deck(cable(0.02), 0.05, held + friction)
        scene = replace(scene, springs=(*scene.springs, slider))
        assert longest_period(scene) == pytest.approx(period, rel=1e-9)


def test_at_a_kink_the_smaller_counts_whatever_rounding_says():
    law, force = BilinearElastic(K, CABLE, 0.3), 0.3 * K
    (u,) = (body.displacement for body in in_equilibrium(deck(law, force=force)).bodies)
    assert u == pytest.approx(0.3, rel=1e-9)
    for place in (u, np.nextafter(0.3, 0.0), 0.3, np.nextafter(0.3, 1.0), 0.3 + 1e-11):
        scene = deck(law, float(place), force)
        assert springs_at_rest(scene)["at_kink"] == ["other"]
        assert longest_period(scene) == pytest.approx(2 * math.pi * math.sqrt(M / 2 / K), rel=1e-9)
    for place in (0.299, 0.301):
        k = K if place < 0.3 else CABLE
        scene = deck(law, place, place * K + k * (place - 0.3))
        assert springs_at_rest(scene)["at_kink"] == []
        assert beside(law, place, place * K + k * (place - 0.3)) == pytest.approx(k, rel=1e-9)


def test_offsets_in_series_that_cancel_but_for_rounding_are_a_kink():
    offsets = (0.3, -0.1, -0.2)
    assert sum(offsets) != 0.0
    for order in (offsets, offsets[::-1]):
        law = Series(tuple(BilinearElastic(3.0 * K, 6.0 * K, each) for each in order))
        assert springs_at_rest(deck(law))["at_kink"] == ["other"]
        assert beside(law) == pytest.approx(K, rel=1e-12)


def test_a_spring_that_has_yielded_counts_as_it_unloads():
    standing = in_equilibrium(deck(BoucWen(1e6, 5e5, 0.01), force=2e6))
    told = springs_at_rest(standing)
    assert told == {"counts": ["pier", "other"], "not": [], "at_kink": [], "at_yield": ["other"]}
    assert longest_period(standing) == pytest.approx(2 * math.pi * math.sqrt(M / (K + 51e6)))


def tangent_forces(scene: Scene, u: np.ndarray) -> np.ndarray:
    """Forces of springs (S,) when bodies move from rest to u; none of the package's laws."""
    at = linkage(scene)
    rest = np.array([body.displacement for body in scene.bodies])
    x, x_0 = at.x + at.B @ u, at.x + at.B @ rest
    found = []
    for spring, here, before in zip(scene.springs, x, x_0, strict=True):
        law = spring.law
        if isinstance(law, BoucWen):
            z = hysteresis(law, here - before)
            found.append(law.stiffness * here + law.strength * z)
        else:
            assert isinstance(law, Linear | BilinearElastic | Series)
            below, above, offset = sides(law)
            found.append((below if here < offset else above) * (here - offset))
    return np.array(found)


@pytest.mark.parametrize(
    "seeds", [range(25), pytest.param(range(25, 100), marks=pytest.mark.sweep)]
)
def test_random_scenes_in_equilibrium_have_the_tangents_of_their_forces(seeds):
    step, compared = 1e-7, 0
    for seed in seeds:
        try:
            scene = in_equilibrium(Drawn(seed).scene())
        except InputError:
            continue
        told, resting = springs_at_rest(scene), at_rest(scene)
        u = np.array([body.displacement for body in scene.bodies])
        B = linkage(scene).B
        for i, spring in enumerate(scene.springs):
            if spring.name in told["at_kink"]:
                continue
            # Along its elongation, the way in which its loop unloads.
            law, along = spring.law, B[i] / np.abs(B[i]).sum()
            way = -1.0 if isinstance(law, BoucWen) and law.initial_z > 0.0 else 1.0
            at, near, far = (tangent_forces(scene, u + way * j * step * along)[i] for j in range(3))
            slope = (4.0 * near - 3.0 * at - far) / (2.0 * way * step * (B[i] @ along))
            k = stiffness_of(resting.springs[i])
            # Differences of forces that are known to 1e-13.
            error = 1e-12 * (abs(near) + getattr(law, "strength", 0.0)) / step
            assert slope == pytest.approx(k, rel=1e-5, abs=error + 1e-9), (seed, spring)
            compared += 1
    assert compared > 2 * len(seeds)


@pytest.mark.parametrize("seeds", [range(10), pytest.param(range(10, 30), marks=pytest.mark.sweep)])
def test_modes_of_random_scenes_at_rest_are_those_of_scipy(seeds):
    for seed in seeds:
        try:
            scene = in_equilibrium(Drawn(seed).scene())
        except InputError:
            continue
        B, names = linkage(scene).B, [body.name for body in scene.bodies]
        k = np.array([stiffness_of(spring) for spring in at_rest(scene).springs])
        mass = np.array([body.mass for body in scene.bodies])
        squares = eigh((B.T * k) @ B, np.diag(mass), eigvals_only=True)
        stiff = squares > 1e-11 * squares[-1]
        found = modes_of(scene, names).period
        order = np.sqrt(squares[-1] / squares[stiff])
        expected = 2.0 * np.pi / np.sqrt(squares[stiff])
        error = np.abs(found[np.isfinite(found)][::-1][: stiff.sum()] / expected[::-1] - 1.0)
        assert (error <= 1e-13 * order[::-1] ** 2).all()


def test_what_is_slack_joins_no_bodies():
    bodies = Body("a", 1.0), Body("b", 1.0)
    springs = (
        Spring("1", (GROUND, "a"), Linear(4.0)),
        Spring("2", (GROUND, "b"), Linear(1.0)),
        Spring("anchor", (GROUND, "b"), cable(0.1)),
        Spring("link", ("a", "b"), cable(0.1)),
    )
    scene = Scene(bodies, springs)
    assert period_called(scene, "T1 of a") == pytest.approx(math.pi, rel=1e-12)
    hanging = Scene(bodies, (springs[0], springs[2], Spring("3", ("a", "b"), Linear(2.0))))
    squares = eigh([[6.0, -2.0], [-2.0, 2.0]], eigvals_only=True)
    slowest = 2.0 * math.pi / math.sqrt(squares[0])
    assert period_called(hanging, "T1 of a") == pytest.approx(slowest, rel=1e-12)
    with pytest.raises(InputError, match="springs that resist at rest join"):
        modal_damping(bodies, springs, 0.05)


def test_every_kind_of_damping_is_of_the_same_stiffness():
    for slack, k in ((0.02, K), (-0.02, K + CABLE)):
        scene, omega = deck(cable(slack)), math.sqrt(k / M)
        critical = 2.0 * M * omega
        for made in (
            modal_damping(scene.bodies, scene.springs, 0.05),
            rayleigh(scene.bodies, scene.springs, 0.05, periods=(2 * math.pi / omega, 0.1)),
        ):
            total = sum(dashpot.coefficient for dashpot in made)
            assert total == pytest.approx(0.05 * critical, rel=1e-12)


def document(slack: float, **run: object) -> dict[str, Any]:
    return {
        "excitation": {"kind": "none"},
        "body": [{"name": "deck", "mass": M}],
        "spring": [
            {"between": ["ground", "deck"], "name": "pier", "law": "linear", "stiffness": K},
            {"between": ["ground", "deck"], "name": "cable", "law": "bilinear-elastic",
             "compression": 0.0, "extension": CABLE, "offset": slack},
        ],
        "dashpot": [{"between": ["ground", "deck"], "ratio": 0.05}],
        "force": [{"body": "deck", "value": 2e6}],
        "run": {"duration": 0.5, **run},
    }  # fmt: skip


@pytest.mark.parametrize(("slack", "push", "period"), [(0.02, 0.0, SLACK), (0.02, 2e6, TAUT)])
def test_a_record_is_scaled_and_a_run_ends_by_the_period_at_rest(tmp_path, slack, push, period):
    (tmp_path / "a.txt").write_text(time_series(0.2))
    given = document(slack, start="equilibrium")
    record = {"kind": "record", "file": "a.txt", "units": "g", "time_step": 0.02}
    given["excitation"] = record | {"psa": "0.4 g", "psa_period": "T1"}
    given["force"] = [{"body": "deck", "value": push}]
    del given["run"]["duration"]
    case = read_case(given, tmp_path / "case.toml")
    motion = case.scene.motion
    assert motion.psa_period == pytest.approx(period, rel=1e-8)
    assert case.run.duration == pytest.approx(motion.end + 5.0 * period, rel=1e-8)
    assert default_duration(case.scene, 0.0) == case.run.duration
    del record["file"]
    given["excitation"] = record | {"suite": "?.txt", "psa": "0.4 g", "psa_period": "T1"}
    table = simulate_suite(read_case(given, tmp_path / "case.toml"), intensities=True)
    assert table["Sa_T1"].to_numpy() / 9.80665 == pytest.approx([0.4], rel=1e-8)


def test_a_shipped_restrainer_counts_as_it_hangs():
    case = load_case(CASES / "restrained-decks")
    told = springs_at_rest(case.scene)
    for spring, still in zip(case.scene.springs, at_rest(case.scene).springs, strict=True):
        assert (spring.name in told["counts"]) is (stiffness_of(still) > 0.0)
    assert told["not"]
