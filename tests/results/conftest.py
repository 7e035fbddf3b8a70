"""Responses made by hand: what results need of a run, without a solver."""

import numpy as np
import pytest

from eventpound.motion.base import Family, Piece, Scales
from eventpound.motion.free import NoMotion
from eventpound.response import Response
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
    Series,
    Spring,
)
from eventpound.solvers.base import (
    Energy,
    Event,
    EventKind,
    Extremes,
    History,
    Recording,
    Task,
    Work,
)

# Numbers whose shortest decimal forms need all 17 digits, and awkward ones.
AWKWARD = [0.1 + 0.2, 1 / 3, -0.0, 5e-324, 1.7976931348623157e308, -(2.0**-1074), 1e22, 123456789.1]


class Samples(NoMotion):
    """A record: 0.5, -1, 0.25 m/s^2 at 0, 0.1, 0.2 s; a jump at each of its ends."""

    kind = "record"
    values = np.array([0.5, -1.0, 0.25])

    def pieces(self):
        inf = float("inf")
        return [
            Piece(-inf, 0.0, Family.ZERO),
            Piece(0.0, 0.2, Family.SAMPLES, np.array([0.0, 0.1]), self.values),
            Piece(0.2, inf, Family.ZERO),
        ]

    def scales(self):
        return Scales(1.0, 20.0)


def _bridge(motion=None):
    """Two decks, a link, an abutment in series and two contacts."""
    return Scene(
        bodies=(Body("deck1", 1.3e6, 0.001, -0.2), Body("deck2", 3.2e6)),
        springs=(
            Spring("frame1", (GROUND, "deck1"), BoucWen(1.1e7, 3.4e6, 0.0155, initial_z=0.1)),
            Spring("link", ("deck1", "deck2"), Linear(1.05e6)),
            Spring(
                "abutment",
                ("deck2", GROUND),
                Series((Linear(1.5e8), BilinearElastic(4.5e8, 1.75e6))),
            ),
        ),
        dashpots=(Dashpot((GROUND, "deck1"), 1.7e6), Dashpot(("deck1", "deck2"), 1e5)),
        contacts=(
            Contact("joint", "deck1", "deck2", 0.0127, 0.7),
            Contact("stop", "deck2", BARRIER, 0.02, 0.5),
        ),
        motion=Samples() if motion is None else motion,
    )


def _extremes(*pairs):
    """Extremes from (max, t_max, min, t_min) rows."""
    columns = np.array(pairs, dtype=float).T
    return Extremes(columns[0], columns[1], columns[2], columns[3])


def _random_history(scene, n, seed=0):
    """A history of arbitrary doubles, the awkward ones among them."""
    rng = np.random.default_rng(seed)
    bodies, springs, contacts = len(scene.bodies), len(scene.springs), len(scene.contacts)
    hysteretic = sum(isinstance(s.law, BoucWen) for s in scene.springs)

    def table(columns):
        values = rng.standard_normal((n, columns)) * 10.0 ** rng.integers(-12, 12, (n, columns))
        values.flat[: min(values.size, len(AWKWARD))] = AWKWARD[: values.size]
        return values

    t = np.sort(rng.uniform(0, 12, n))
    wide = [table(k) for k in (bodies, bodies, bodies, hysteretic, springs, contacts, contacts)]
    return History(t, rng.standard_normal(n), *wide)


EVENTS = (
    Event(0.1, EventKind.IMPACT, 0, 0, -0.3, 0.21, 1000.0 / 3.0, 55.5),
    Event(0.1, EventKind.IMPACT, 0, 1, -0.1, 0.05, 20.0),
    Event(0.5, EventKind.ACCUMULATION, 1, 0, -1e-5, 0.0, 0.25, 1e-9, 40),
    Event(0.5, EventKind.REST, 2, 0),
    Event(0.75, EventKind.DETACHMENT, 3, 0),
)


def _response(success=True, energy=False, scene=None, events=EVENTS, n=50):
    """A run of the bridge with invented numbers."""
    scene = _bridge() if scene is None else scene
    return Response(
        Task(scene, 0.0, 12.0, 1e-9, {"z": 1e-8}, np.linspace(0, 12, n), settings={"order": 3}),
        "cvode",
        Recording(
            success=success,
            message="reached the end" if success else "stopped",
            t=12.0,
            u=np.array([0.003, 0.1 + 0.2]),
            v=np.array([-1 / 3, 0.0]),
            z=np.array([0.7]),
            history=_random_history(scene, n),
            events=events,
            displacement=_extremes((0.05, 1.0, -0.06, 2.0), (0.02, 3.0, -0.02, 2.5)),
            elongation=_extremes(
                (0.05, 1.0, -0.062, 2.0), (0.01, 0.4, -0.02, 0.3), (0.02, 2.5, -0.02, 3.0)
            ),
            acceleration=_extremes((3.0, 1.1, -2.0, 1.0), (4.0, 1.2, -5.0, 1.3)),
            base_shear=_extremes((4e6, 0.7, -3e6, 0.8)),
            smallest_gap=np.array([1e-4, 2e-3]),
            resting_time=np.array([0.25, 0.0]),
            max_force=np.array([9e5, 7e5]),
            unique_forces=np.array([True, False]),
            work=Work(100, 5, 60, 4, 0.125),
            energy=Energy(1.0, 2.0, 0.5, 0.5, 1.0, 0.5, 0.5, 1e-12) if energy else None,
            largest_gap=np.array([0.05, 0.03]),
        ),
    )


@pytest.fixture
def make_run():
    """Builder of invented responses."""
    return _response


@pytest.fixture
def run():
    """A finished run of the bridge, invented."""
    return _response()


@pytest.fixture
def bridge():
    """Builder of the scene, by its ground motion."""
    return _bridge
