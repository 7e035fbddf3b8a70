"""Pulses are found again: a pure one exactly, one in noise within what noise allows."""

import math

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import GroundMotion, Record
from eventpound.motion.pulse_fit import PULSES, fit_pulse

STEP, LENGTH = 0.01, 20.0
A_P, T_P, START = 2.0, 1.37, 5.0


def sampled(motion: GroundMotion) -> Record:
    return Record(motion.acceleration(np.arange(0.0, LENGTH, STEP)), STEP)


def pulse(kind: str) -> GroundMotion:
    return PULSES[kind](amplitude=A_P, period=T_P, start=START, reverse=True)


@pytest.mark.parametrize("kind", PULSES)
def test_a_pure_pulse_is_found_exactly_in_its_acceleration(kind):
    """The samples are those of the formula, so the least sum of squares is zero.

    Where it is zero the parameters are as exact as the square root of rounding.
    """
    (fit,) = fit_pulse(sampled(pulse(kind)), [kind], on="acceleration")
    assert fit.explained == pytest.approx(1.0, abs=1e-14)
    assert fit.a_p == pytest.approx(A_P, rel=1e-7)
    assert fit.T_p == pytest.approx(T_P, rel=1e-7)
    found = fit.motion
    assert getattr(found, "start") == pytest.approx(START, abs=1e-7 * T_P)  # noqa: B009
    assert getattr(found, "reverse") is True  # noqa: B009


@pytest.mark.parametrize("kind", PULSES)
def test_a_pure_pulse_is_found_in_its_velocity(kind):
    """The velocity of a record is that of straight lines between its samples.

    They miss (omega dt)^2 / 12 of a smooth pulse. A jump is a ramp of one step
    in a record, which moves the pulse by half a step.
    """
    (fit,) = fit_pulse(sampled(pulse(kind)), [kind])
    omega = 2.0 * math.pi / T_P
    tolerance = 2.0 * (omega * STEP) ** 2 / 12.0
    if kind in ("cosine", "type-c"):
        tolerance = 0.5 * omega * STEP
    assert fit.a_p == pytest.approx(A_P, rel=tolerance)
    assert fit.T_p == pytest.approx(T_P, rel=tolerance)


@pytest.mark.parametrize("kind", ["sine", "ricker", "mavroeidis-papageorgiou"])
def test_a_pulse_in_noise(kind):
    """White noise of standard deviation s, known error bars of least squares.

    The sum over n samples of the squared derivatives of the pulse to ln a_p and
    ln T_p is about n a_p^2 / 2 each for n samples within the pulse; four times
    s / sqrt of it, doubled for what the parameters share.
    """
    record = sampled(pulse(kind))
    s = 0.3 * A_P
    noise = np.random.default_rng(1).normal(0.0, s, record.samples.size)
    noisy = Record(record.samples + noise, STEP)
    (fit,) = fit_pulse(noisy, [kind], on="acceleration")
    inside = T_P / STEP
    bound = 8.0 * s / (A_P * math.sqrt(0.5 * inside))
    assert fit.T_p == pytest.approx(T_P, rel=bound)
    assert fit.a_p == pytest.approx(A_P, rel=2.0 * bound)
    square = float(record.samples @ record.samples)
    share = square / (square + s**2 * record.samples.size)
    assert fit.explained == pytest.approx(share, abs=0.1)


def test_the_right_kind_is_the_best():
    for kind in ("cosine", "ricker", "antisymmetric-ricker"):
        others = [name for name in PULSES if name != "mavroeidis-papageorgiou"]
        best, *rest = fit_pulse(sampled(pulse(kind)), others)
        assert best.kind == kind
        assert all(fit.explained <= best.explained for fit in rest)


def test_scale_and_direction_of_the_record_count():
    plain = sampled(pulse("ricker"))
    turned = Record(plain.samples, STEP, scale=3.0, reverse=True, start=-2.0)
    (fit,) = fit_pulse(turned, ["ricker"], on="acceleration")
    assert fit.a_p == pytest.approx(3.0 * A_P, rel=1e-7)
    assert getattr(fit.motion, "reverse") is False  # noqa: B009
    assert getattr(fit.motion, "start") == pytest.approx(START - 2.0, abs=1e-6)  # noqa: B009


def test_what_cannot_be_fitted_is_refused():
    record = sampled(pulse("sine"))
    with pytest.raises(InputError, match="found square; accepted: sine, cosine"):
        fit_pulse(record, ["square"])
    with pytest.raises(InputError, match="too short for a type-c pulse"):
        fit_pulse(Record(np.ones(8), 0.01), ["type-c"])
