"""Frames by their matrices: against the matrices, SciPy's integration with contacts, refusals."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from eventpound import Cosine, InputError, frame, simulate
from eventpound.quantities.lookup import names_of
from eventpound.scene import BARRIER, Body, Contact, Linear, Point, Scene, Slider, Spring
from eventpound.scene.modes import modes_of
from eventpound.scene.periods import joined

N, MASS, PEAK, PERIOD = 5, 2e5, 4.0, 0.9
PULSE = Cosine(amplitude=PEAK, period=PERIOD)


def condensed(floors: int = N, held: bool = True) -> np.ndarray:
    """K of a portal of bending columns, rotations condensed; a floor more at the foot if not held.

    One column line of flexural rigidity EI in storeys of height h, turned at each floor by a
    beam of the rotational stiffness r: its couplings reach over all floors, with either sign.
    """
    EI, h, r = 4e8, 3.2, 2.5e8
    nodes = floors + 1
    K = np.zeros((2 * nodes, 2 * nodes))
    element = (EI / h**3) * np.array(
        [
            [12.0, 6.0 * h, -12.0, 6.0 * h],
            [6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h],
            [-12.0, -6.0 * h, 12.0, -6.0 * h],
            [6.0 * h, 2.0 * h * h, -6.0 * h, 4.0 * h * h],
        ]
    )
    for low, high in pairwise(range(nodes)):
        at = np.array([low, nodes + low, high, nodes + high])
        K[np.ix_(at, at)] += element
    K[np.arange(nodes, 2 * nodes), np.arange(nodes, 2 * nodes)] += r
    first = 1 if held else 0
    kept = np.arange(first, nodes)
    turned = np.arange(nodes + first, 2 * nodes)
    K_cm = K[np.ix_(kept, turned)]
    rest = K_cm @ np.linalg.solve(K[np.ix_(turned, turned)], K_cm.T)
    return np.asarray(K[np.ix_(kept, kept)] - rest)


K = condensed()
C = 0.3 * MASS * np.eye(N) + 0.004 * K


def test_the_frame_has_couplings_of_either_sign():
    parts = frame("T", K, [MASS] * N)
    signs = {np.sign(spring.law.stiffness) for spring in parts.springs}
    assert signs == {-1.0, 1.0}
    assert [body.name for body in parts.bodies] == ["T1", "T2", "T3", "T4", "T5"]


def test_its_springs_and_dashpots_are_the_matrices():
    parts = frame("T", K, np.diag([MASS] * N), C)
    names = [body.name for body in parts.bodies]
    of_springs = joined(names, [(s.direction, s.law.stiffness) for s in parts.springs])
    assert of_springs == pytest.approx(K, rel=1e-12, abs=1e-14 * K.max())
    of_dashpots = joined(names, [(d.direction, d.coefficient) for d in parts.dashpots])
    assert of_dashpots == pytest.approx(C, rel=1e-12, abs=1e-14 * C.max())
    squares = eigh(K, MASS * np.eye(N), eigvals_only=True)
    period = modes_of(Scene(parts.bodies, parts.springs), names).period
    assert period == pytest.approx(2.0 * np.pi / np.sqrt(squares), rel=1e-11)


def test_what_nothing_holds_stays_so():
    parts = frame("T", condensed(held=False), [MASS] * (N + 1))
    assert all("ground" not in spring.between for spring in parts.springs)


GAP, RESTITUTION = 0.02, 0.6


def by_scipy(
    accelerated: Callable[[np.ndarray], np.ndarray], W: np.ndarray, mass: np.ndarray, end: float
) -> tuple[np.ndarray, int]:
    """Displacements at the end, and number of impacts, under the pulse: SciPy with Newton's law.

    accelerated: M^-1 of the forces at a state (2 N,). W (N,): of the one contact, of gap `GAP`.
    """
    n = mass.size

    def rate(t: float, y: np.ndarray, shaken: bool) -> np.ndarray:
        a = PEAK * math.cos(2.0 * math.pi / PERIOD * t) if shaken else 0.0
        return np.append(y[n:], accelerated(y) - a)

    def closes(t: float, y: np.ndarray, shaken: bool) -> float:
        return float(GAP + W @ y[:n])

    closes.terminal, closes.direction = True, -1.0
    y, t, impacts = np.zeros(2 * n), 0.0, 0
    while t < end:
        shaken = t < PERIOD
        until = PERIOD if shaken else end
        done = solve_ivp(
            rate, (t, until), y, "DOP853", events=closes, args=(shaken,), rtol=1e-13, atol=1e-15
        )
        t, y = float(done.t[-1]), done.y[:, -1]
        if done.status == 1:
            impacts += 1
            y[n:] -= W / mass * (1.0 + RESTITUTION) * (W @ y[n:]) / (W @ (W / mass))
    return y[:n], impacts


BESIDE = Body("B", 3e5), Spring("storey-B", ("ground", "B"), Linear(6e7))


FLOOR, COLUMN = {"T5": 1.0}, {"T4": 0.3, "T5": 0.7}


@pytest.mark.parametrize(
    ("solver", "struck", "end"),
    [*((s, FLOOR, 2.5) for s in ("cvode", "ida", "fast")), ("cvode", COLUMN, 2.0)],
)
def test_a_frame_that_strikes_a_building_moves_as_by_scipy(solver, struck, end):
    """At a floor, or with a column between two."""
    parts, (body, spring) = frame("T", K, [MASS] * N, C), BESIDE
    scene = Scene(
        (*parts.bodies, body),
        (*parts.springs, spring),
        parts.dashpots,
        (Contact("joint", "T5" if struck is FLOOR else Point(struck), "B", GAP, RESTITUTION),),
        PULSE,
    )
    mass = np.append([MASS] * N, 3e5)
    whole_K, whole_C = np.zeros((2, N + 1, N + 1))
    whole_K[:N, :N], whole_C[:N, :N], whole_K[N, N] = K, C, 6e7
    W = np.array([-struck.get(f"T{i + 1}", 0.0) for i in range(N)] + [1.0])

    def accelerated(y: np.ndarray) -> np.ndarray:
        return np.asarray(-(whole_K @ y[: N + 1] + whole_C @ y[N + 1 :]) / mass)

    u, impacts = by_scipy(accelerated, W, mass, end)
    response = simulate(scene, solver, rtol=1e-11, duration=end)
    assert len(response.events) == impacts > 1
    assert response.recording.u == pytest.approx(u, abs=1e-9 * np.abs(u).max())


def test_storeys_of_a_frame_drift_as_by_scipy():
    # The second and the third floor are not coupled: their storey is measured all the same.
    bent = K + 2.0 * abs(K[1, 2]) * np.eye(N)
    bent[1, 2] = bent[2, 1] = 0.0
    levels, heights = [3.0, 7.0, 10.0, 13.0, 17.0], np.array([3.0, 4.0, 3.0, 3.0, 4.0])
    parts = frame("T", bent, [MASS] * N, C, levels=levels)
    stiffness = {spring.name: spring.law for spring in parts.springs}
    assert stiffness["T2-T3"] == Linear(0.0)
    scene = Scene(parts.bodies, parts.springs, parts.dashpots, motion=PULSE)
    response = simulate(scene, rtol=1e-11, duration=2.0)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        a = PEAK * math.cos(2.0 * math.pi / PERIOD * t) if t < PERIOD else 0.0
        return np.append(y[N:], -(bent @ y[:N] + C @ y[N:]) / MASS - a)

    drifts, y = [], np.zeros(2 * N)
    for start, end in ((0.0, PERIOD), (PERIOD, 2.0)):
        done = solve_ivp(rate, (start, end), y, "DOP853", rtol=1e-12, atol=1e-14, dense_output=True)
        drifts.append(done.sol(np.linspace(start, np.nextafter(end, 0.0), 20_001))[:N])
        y = done.y[:, -1]
    u = np.hstack(drifts)
    largest = np.abs(np.diff(u, axis=0, prepend=0.0)).max(axis=1) / heights
    found = [
        response.quantity(f"springs.{name}.drift_ratio")
        for name in ("ground-T1", "T1-T2", "T2-T3", "T3-T4", "T4-T5")
    ]
    assert found == pytest.approx(largest, rel=1e-6)
    assert response.quantity("structures.T.storey_drift_ratio") == max(found)
    roof = np.abs(u[-1]).max()
    assert response.quantity("structures.T.roof_drift") == pytest.approx(roof, rel=1e-6)
    # A coupling between other floors is no storey, and none has a force of its own.
    told = {name for name in names_of(scene) if name.startswith("springs.")}
    assert not {name for name in told if "T1-T3" in name or "force" in name}


@pytest.mark.parametrize(("solver", "order"), [("moreau", 1.0), ("penalty", 2.0)])
def test_steppers_come_to_it(solver, order):
    # Without contact: errors of two steps, of which the second is half as long.
    parts = frame("T", K, [MASS] * N, C)
    scene = Scene(parts.bodies, parts.springs, parts.dashpots, motion=PULSE)
    exact = simulate(scene, "fast", rtol=1e-12, duration=2.0).recording.u
    errors = [
        np.abs(
            simulate(scene, solver, duration=2.0, settings={"time_step": h}).recording.u - exact
        ).max()
        for h in (2e-3, 1e-3)
    ]
    assert errors[1] < errors[0] / 2.0 ** (order - 0.2)
    assert errors[1] < 0.01 * np.abs(exact).max()


def test_a_frame_stands_on_bearings_under_a_slab():
    parts = frame("T", K, [MASS] * N, C, on="slab")
    weight = 9.81 * (N * MASS + 3e5)
    slider = Spring("bearing", ("ground", "slab"), Slider.pendulum(0.05, weight, 2.0))
    scene = Scene(
        (Body("slab", 3e5), *parts.bodies),
        (slider, *parts.springs),
        parts.dashpots,
        (Contact("moat", "slab", BARRIER, 0.05, 0.4),),
        PULSE,
    )
    # The slab is between: what the frame puts on it is what its links to the ground were.
    names = [body.name for body in scene.bodies]
    links = [(s.direction, s.law.stiffness) for s in parts.springs]
    whole = joined(names, links)
    assert whole[1:, 1:] == pytest.approx(K, rel=1e-12, abs=1e-14 * K.max())
    assert np.abs(whole.sum(axis=0)).max() < 1e-12 * K.max()
    fast, cvode = (
        simulate(scene, solver, rtol=1e-11, duration=3.0) for solver in ("fast", "cvode")
    )
    size = np.abs(cvode.recording.u).max()
    assert len(fast.events) == len(cvode.events) > 0
    assert fast.recording.u == pytest.approx(cvode.recording.u, abs=1e-8 * size)


def test_tables_and_histories_leave_couplings_out():
    parts, (body, spring) = frame("T", K, [MASS] * N), BESIDE
    # The couplings stand first, so that places of springs are not their numbers in tables.
    scene = Scene((*parts.bodies, body), (*parts.springs, spring), motion=PULSE)
    response = simulate(scene, "fast", duration=1.0)
    assert [name for name in response.history if name.startswith("force.")] == ["force.storey-B"]
    springs = {name.split(".")[1] for name in names_of(scene) if name.startswith("springs.")}
    assert springs == {"storey-B"}
    force = response.history["force.storey-B"].to_numpy()
    assert force == pytest.approx(6e7 * response.history["u.B"].to_numpy(), rel=1e-12)
    largest = response.summary["springs.storey-B.max_force"]
    assert largest == pytest.approx(6e7 * response.peaks.loc["B", "max"], rel=1e-12)
    assert response.quantity("structures.T.max_base_shear") is not None


def changed(i: int, j: int, by: float) -> np.ndarray:
    other = K.copy()
    other[i, j] += by
    return other


def bent(part: float) -> np.ndarray:
    """K less a part of what its softest motion resists: that of which the message tells."""
    squares, shapes = np.linalg.eigh(K)
    return np.asarray(K - part * squares[0] * np.outer(shapes[:, 0], shapes[:, 0]))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"stiffness": changed(0, 2, 2e-9 * K.max())}, "accepted: a matrix that is symmetric"),
        ({"stiffness": bent(1.01)}, "stiffness: found a matrix that is not positive semidefinite"),
        ({"stiffness": -K}, "accepted: a diagonal that is not negative"),
        ({"stiffness": K[:4]}, "stiffness: found an array \\(4, 5\\); accepted: \\(4, 4\\)"),
        ({"stiffness": "K.csv"}, "stiffness: found no array of numbers"),
        ({"stiffness": changed(1, 1, math.nan)}, "stiffness: found a number at \\(2, 2\\) that"),
        ({"mass": MASS * (np.eye(N) + 0.1)}, "between T1 and T2; accepted: lumped masses"),
        ({"mass": [MASS, MASS, 0.0, MASS, MASS]}, "found 0 kg at T3; accepted: positive masses"),
        ({"mass": [MASS] * 4}, "mass: found an array \\(4,\\); accepted: \\(5,\\) or \\(5, 5\\)"),
        ({"damping": -0.1 * C + 0.2 * np.diag(C.diagonal())}, "damping: found a matrix that is"),
        ({"names": ["a", "b"]}, "names: found 2 for 5 rows of stiffness"),
        ({"names": ["a"] * N}, "names: found 1 for 5 rows"),
        ({"levels": [3.0, 2.0, 4.0, 5.0, 6.0]}, "levels: found 3, 2, 4, 5, 6; accepted: 5 heights"),
        ({"levels": [3.0]}, "levels: found 3; accepted: 5 heights above"),
    ],
    ids=lambda given: ",".join(given) if isinstance(given, dict) else "",
)
def test_what_is_no_frame_is_refused(arguments, said):
    with pytest.raises(InputError, match=said):
        frame("T", **({"stiffness": K, "mass": [MASS] * N} | arguments))


def test_the_motion_that_gives_way_is_told():
    shape = np.linalg.eigh(bent(1.01))[1][:, 0]
    with pytest.raises(InputError) as caught:
        frame("T", bent(1.01), [MASS] * N)
    told = str(caught.value).partition("gives way as ")[2].partition(";")[0].split(", ")
    parts = {name: float(part) for name, part in (each.split() for each in told)}
    shape = shape / shape[np.argmax(np.abs(shape))]
    for i, part in enumerate(shape, 1):
        assert parts.get(f"T{i}", 0.0) == pytest.approx(part, abs=0.1)
    frame("T", bent(0.99), [MASS] * N)


def test_rounded_numbers_are_symmetric_and_taken():
    rounded = np.array([[float(f"{k:.10g}") for k in row] for row in K])
    assert replace(frame("T", rounded, [MASS] * N).bodies[0], mass=1.0).mass == 1.0
