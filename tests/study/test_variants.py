"""Rows of a study: a product of its axes, met at each row's own amplitude and period."""

import numpy as np
import pytest

from eventpound.study.variants import rows_of_base
from tests.study.conftest import ELASTOPLASTIC
from tests.study.test_reading import PAIR


def test_rows_are_a_product_the_last_axis_fastest(make_study):
    study = make_study().study
    assert study.columns == ("excitation.reverse", "pi.delta", "pi.Q")
    assert (study.size, len(study.bases)) == (160, 2)
    rows = rows_of_base(study.bases[1], 39, 42)
    assert rows.base.case.scene.motion.reverse
    assert rows.values["pi.delta"].tolist() == [0.1, 0.5, 0.5]
    assert rows.values["pi.Q"] == pytest.approx([1.6, 0.1, 0.1 + 1.5 / 39], rel=1e-15)
    # Unit scales: Q = Pi_Q m a_g and delta = Pi_delta L_e with all of them 1.
    assert rows.numbers["spring.0.strength"] == pytest.approx(rows.values["pi.Q"], rel=1e-15)
    assert rows.numbers["contact.0-barrier.gap"] == pytest.approx([0.1, 0.5, 0.5], rel=1e-15)
    assert rows.lengths == pytest.approx(6 * 2 * np.pi, rel=1e-15)


def test_terms_are_met_at_the_amplitude_and_period_of_their_row(make_study):
    text = (
        ELASTOPLASTIC
        + """
[[study.axis]]
key = "excitation.amplitude"
values = ["0.2 g", 1.0]
zip = "motion"
[[study.axis]]
key = "excitation.period"
values = ["50 ms", 2]
zip = "motion"
"""
    )
    study = make_study(text).study
    assert study.size == 320
    rows = rows_of_base(study.bases[0], 0, 2)
    a_g, omega_g = np.array([0.2 * 9.80665, 1.0]), 2 * np.pi / np.array([0.05, 2.0])
    assert rows.numbers["excitation.period"].tolist() == [0.05, 2.0]
    assert rows.numbers["spring.0.strength"] == pytest.approx(0.1 * a_g, rel=1e-14)
    expected = 0.2 * a_g / omega_g**2
    assert rows.numbers["spring.0.yield_displacement"] == pytest.approx(expected, rel=1e-14)
    assert rows.lengths == pytest.approx([0.3, 12.0], rel=1e-14)


def test_a_case_in_dimensions_has_axes_of_numbers_and_terms(make_study):
    text = (
        PAIR
        + """
[study]
[[study.axis]]
key = "contact.joint.gap"
values = ["1 mm", "2 cm"]
[[study.axis]]
key = "pi.omega_s.i"
values = [0.5, 2.0]
[[study.axis]]
key = "pi.Q"
from = 0.1
to = 1.0
count = 3
spacing = "logarithmic"
"""
    )
    study = make_study(text).study
    assert study.quantities == ("pi_um", "amplification", "impacts", "resting_time")
    rows = rows_of_base(study.bases[0], 0, 12)
    assert rows.numbers["contact.joint.gap"].tolist() == [0.001] * 6 + [0.02] * 6
    own = study.bases[0].case.scene.springs[0].law.stiffness
    expected = own / np.tile(np.repeat([0.5, 2.0], 3), 2) ** 2
    assert rows.numbers["spring.r.stiffness"] == pytest.approx(expected, rel=1e-14)
    strength = np.tile([0.1, 0.1**0.5, 1.0], 4) * 500e3 * 0.4 * 9.80665
    assert rows.numbers["spring.l.strength"] == pytest.approx(strength, rel=1e-14)
    # Neither stiffness nor yield displacement of the one looked at is touched.
    assert {k for k in rows.numbers if k.startswith("spring.l")} == {"spring.l.strength"}
