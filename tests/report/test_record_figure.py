"""The figure of a record shows the record: its series, its peaks and its mean period."""

import numpy as np
import pytest

from eventpound.motion import RecordData
from eventpound.motion.intensity import Characteristics
from eventpound.report.record_figure import record_figure
from eventpound.units import STANDARD_GRAVITY
from tests.motion.readers.writers import motion


def characteristics(acceleration: np.ndarray) -> Characteristics:
    data = RecordData(
        acceleration, 0.01, "g", "at2", "x/a.at2", "0" * 64, "Nowhere", "Made up", "090"
    )
    return Characteristics(data)


def test_series_peaks_and_mean_period():
    record = characteristics(motion(2000, 0.01))
    figure = record_figure(record)
    acceleration, velocity, displacement, spectrum = figure.axes
    drawn = acceleration.lines[1].get_ydata()
    np.testing.assert_allclose(drawn, record.data.acceleration / STANDARD_GRAVITY, rtol=1e-15)
    (t_peak,), (peak,) = acceleration.lines[2].get_data()
    assert abs(peak) * STANDARD_GRAVITY == pytest.approx(record.intensity.pga, rel=1e-15)
    assert t_peak == pytest.approx(record.intensity.time_of_pga, rel=1e-15)
    assert spectrum.lines[1].get_xdata()[0] == pytest.approx(1.0 / record.mean_period, rel=1e-15)
    assert [a.get_ylabel() for a in figure.axes] == [
        "acceleration (g)",
        "velocity (cm/s)",
        "displacement (cm)",
        "Fourier amplitude (m/s)",
    ]
    assert f"PGV = {100 * record.intensity.pgv:.3g} cm/s" == velocity.get_title(loc="right")
    assert figure.get_suptitle() == "a.at2\nNowhere, Made up, component 090"
    final = abs(record.record.displacement(np.array([record.record.end]))[0])
    assert bool(displacement.get_title(loc="left")) == bool(final > 0.5 * record.intensity.pgd)


def test_a_drift_is_named():
    figure = record_figure(characteristics(motion(2000, 0.01) + 0.05))
    assert figure.axes[2].get_title(loc="left") == "drifts"
    assert figure.axes[2].get_ylabel() == "displacement (m)"


def test_a_record_without_a_mean_period_is_drawn():
    data = RecordData(np.ones(2), 10.0, "m/s^2", "columns", "a.txt", "0" * 64)
    spectrum = record_figure(Characteristics(data)).axes[-1]
    assert spectrum.get_title(loc="left").startswith("no $T_m$")
