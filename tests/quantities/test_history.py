"""What an accelerometer shows: the change of velocity over its interval."""

import numpy as np
import pytest

from eventpound import Contact, Cosine, InputError, Scene, simulate
from eventpound.motion import Harmonic
from eventpound.motion.scaling import psa_of
from tests.quantities.test_rows import FREE, E


def test_what_a_logger_sees_has_the_floor_spectrum():
    wall = Contact("c", "a", "barrier", gap=0.02, restitution=E)
    motion = Harmonic(3.0, 0.7, cycles=6)
    scene = Scene(FREE.bodies, FREE.springs, contacts=(wall,), motion=motion)
    response = simulate(scene, "fast", duration=4.0)
    assert response.impacts == 6
    interval, periods = 5e-4, np.array([0.2, 0.5, 1.0])
    rows = response.at(np.linspace(0.0, 4.0, 8001), logger=interval)
    assert rows.attrs["units"]["logged.a"] == "m/s^2"
    exact = response.floor_spectrum("a", periods)["PSA"].to_numpy()
    logged, sampled = (
        psa_of(rows[name].to_numpy(), interval, periods, 0.05) for name in ("logged.a", "a.a")
    )
    # An impact is spread over an interval, half of it late: some 2 pi 0.0005/0.2 of the size.
    assert logged == pytest.approx(exact, rel=0.005)
    # Samples without impacts lack most of it.
    assert (sampled < 0.6 * exact).all()


def test_what_a_logger_sees_is_the_change_of_velocity():
    scene = Scene(FREE.bodies, FREE.springs, contacts=FREE.contacts, motion=Cosine(3.0, 0.7))
    response = simulate(scene, "fast", duration=1.0)
    t = np.array([0.0, 0.004, 0.5, 0.02])
    logged = response.at(t, logger="10 ms")["logged.a"].to_numpy()
    early = np.maximum(t - 0.01, 0.0)

    def speed(t: np.ndarray) -> np.ndarray:
        ground = 3.0 * 0.7 / (2.0 * np.pi) * np.sin(2.0 * np.pi * t / 0.7)
        return response.at(t)["v.a"].to_numpy() + ground

    change = speed(t[1:]) - speed(early[1:])
    assert logged[1:] == pytest.approx(change / (t - early)[1:], rel=1e-9)
    # At the start nothing was logged yet.
    assert logged[0] == response.at(0.0)["a.a"].item()
    assert "logged.a" not in response.at(t)
    with pytest.raises(InputError, match="logger: found 0"):
        response.at(t, logger=0.0)
