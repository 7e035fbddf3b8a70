"""The Mavroeidis-Papageorgiou pulse against its published velocity."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from eventpound.errors import InputError
from eventpound.motion import MavroeidisPapageorgiou

PULSES = [
    MavroeidisPapageorgiou(4.0, 0.7),
    MavroeidisPapageorgiou(4.0, 0.7, gamma=1.01, phase=math.pi / 2),
    MavroeidisPapageorgiou(4.0, 0.7, gamma=1.5, phase=1.0, start=0.3),
    MavroeidisPapageorgiou(4.0, 0.7, gamma=6.3, phase=-2.0, reverse=True),
]


@pytest.mark.parametrize("pulse", PULSES)
def test_velocity_is_the_published_formula(pulse):
    t = np.linspace(pulse.start, pulse.end, 301)
    tau = t - pulse.start - pulse.gamma * pulse.period / 2.0
    w = 2.0 * math.pi / pulse.period
    sign = -1.0 if pulse.reverse else 1.0
    envelope = 0.5 * sign * pulse.velocity_amplitude * (1.0 + np.cos(w * tau / pulse.gamma))
    np.testing.assert_allclose(
        pulse.velocity(t), envelope * np.cos(w * tau + pulse.phase), atol=1e-14
    )


@pytest.mark.parametrize("pulse", PULSES)
def test_peak_acceleration_is_the_amplitude_to_rounding(pulse):
    t = np.linspace(pulse.start, pulse.end, 20_001)
    magnitude = np.abs(pulse.acceleration(t))
    i = int(np.argmax(magnitude))
    best = minimize_scalar(
        lambda x: -abs(float(pulse.acceleration(np.array(x)))),
        bounds=(t[i - 1], t[i + 1]),
        method="bounded",
        options={"xatol": 1e-10},
    )
    # A peak is flat: an abscissa within 1e-8 T changes it by rounding only.
    assert -best.fun == pytest.approx(pulse.amplitude, rel=1e-14)


def test_default_pulse_returns_the_ground():
    pulse = PULSES[0]
    assert pulse.displacement(np.array([pulse.end]))[0] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("key", "value"), [("gamma", 1.0), ("gamma", math.nan), ("phase", math.inf)]
)
def test_a_wrong_number_is_named(key, value):
    with pytest.raises(InputError, match=f"mavroeidis-papageorgiou.*{key}"):
        MavroeidisPapageorgiou(1.0, 1.0, **{key: value})
