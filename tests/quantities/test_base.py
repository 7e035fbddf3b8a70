"""Units and sources of the list of quantities."""

import pytest

from eventpound.motion import Cosine
from eventpound.quantities.base import TakenFrom, pi_unit
from eventpound.quantities.listed import LISTED
from eventpound.units import Dimension


def test_units_of_pi_terms_are_products_of_mass_length_and_time():
    scales = Cosine(3.0, 2.0).scales()
    mass, length, time = 5.0, scales.length, 1.0 / scales.omega_g
    expected = {
        Dimension.LENGTH: length,
        Dimension.VELOCITY: length / time,
        Dimension.ACCELERATION: length / time**2,
        Dimension.TIME: time,
        Dimension.FORCE: mass * length / time**2,
        Dimension.IMPULSE: mass * length / time,
        Dimension.ENERGY: mass * length**2 / time**2,
        Dimension.NUMBER: 1.0,
        Dimension.ANGLE: 1.0,
    }
    for dimension, unit in expected.items():
        assert pi_unit(dimension, scales, mass) == pytest.approx(unit, rel=1e-14)
    assert {q.dimension for q in LISTED} <= {*expected, Dimension.ANGULAR_FREQUENCY}


def test_every_source_is_used():
    assert {q.source for q in LISTED} == set(TakenFrom)
