"""Columns of Π-terms are scenes one by one."""

import numpy as np
import pytest

from eventpound.scene.parameters import number_places, with_values
from eventpound.scene.pi_columns import numbers_with_terms, scale_columns
from eventpound.scene.pi_terms import pi_terms
from tests.scene.test_pi_structure import MOTION, TRIPLET


def test_columns_are_scenes_one_by_one():
    """Whole columns of terms and amplitudes give the numbers that each row gives alone."""
    given_terms = {"omega_s": 0.5, "uy": 0.1, "Q": 0.3, "omega_s.i": 2.0, "delta": 1.0}
    given_terms["epsilon"] = 0.5
    scene = TRIPLET.scene(MOTION, given_terms)
    rng = np.random.default_rng(1)
    columns = {"excitation.amplitude": rng.uniform(0.1, 10.0, 5)}
    terms = {"omega_s": rng.uniform(0.1, 3.0, 5), "Q.1": rng.uniform(0.1, 3.0, 5), "m.2": 2.0}
    numbers = numbers_with_terms(scene, terms, columns)
    places = number_places(scene)
    scales = scale_columns(scene, columns)
    for i in range(5):
        row = {k: float(np.broadcast_to(v, 5)[i]) for k, v in (columns | numbers).items()}
        found = pi_terms(with_values(scene, {places[k]: v for k, v in row.items()}))
        assert found["omega_s"] == pytest.approx(terms["omega_s"][i], rel=1e-13)
        assert found["Q.1"] == pytest.approx(terms["Q.1"][i], rel=1e-13)
        assert found["m.2"] == pytest.approx(2.0, rel=1e-13)
        assert found["omega_s.2"] == pytest.approx(2.0, rel=1e-13)
        assert np.broadcast_to(scales.a_g, 5)[i] == columns["excitation.amplitude"][i]
