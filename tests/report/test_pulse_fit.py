"""A pulse over the record that it was fitted to."""

import numpy as np
import pytest

from eventpound import Record, Ricker, load_case
from eventpound.motion.pulse_fit import fit_pulse
from eventpound.motion.synthetic import synthetic_motion
from eventpound.report.pulse_fit import pulse_fit_figure
from tests.models import CASES


def test_pulse_over_the_record():
    t = np.arange(0.0, 8.0, 0.01)
    record = Record(Ricker(2.0, 1.0, start=2.0).acceleration(t), 0.01)
    fits = fit_pulse(record, ["ricker", "sine"])
    figure = pulse_fit_figure(record, fits, "title")
    upper, lower = figure.axes
    drawn = upper.get_lines()[2].get_ydata()
    assert np.abs(drawn).max() * 9.80665 == pytest.approx(2.0, rel=1e-2)
    assert "explains 100 %" in str(upper.get_lines()[2].get_label())
    assert len(lower.get_lines()) == 4


def test_the_added_pulse_is_found_again():
    case = load_case(CASES / "figure-01")
    assert case.figures
    pulse = case.figures[0].added_pulse
    scales = pulse.scales()
    record = synthetic_motion(1, 2).record
    t = record.time_step * np.arange(record.acceleration.size, dtype=np.float64)
    with_pulse = Record(record.acceleration + pulse.acceleration(t), record.time_step)
    (fit,) = fit_pulse(with_pulse, ["mavroeidis-papageorgiou"])
    # The motion under the pulse has a third of its amplitude, at a third of its period.
    assert scales.period == pytest.approx(fit.T_p, rel=0.1)
    assert scales.a_g == pytest.approx(fit.a_p, rel=0.1)
