"""Rounding that collects over a run is part of its bounds."""

from decimal import Decimal

from eventpound.accuracy.verify import verify
from tests.accuracy.storeys import DURATION, SCENE, TRUE


def test_a_certificate_at_the_tightest_tolerance_holds_against_113_bits():
    """The fast solver is off by the same 1.4e-13 of scale at rtol 1e-11 to 1e-14."""
    certificate = verify(SCENE, duration=DURATION)
    found = {quantity.quantity: quantity for quantity in certificate.quantities}
    assert certificate.certified
    for name, true in TRUE.items():
        bound = found[name].bound
        assert bound is not None
        assert abs(Decimal(found[name].value) - true) <= bound
        assert found[name].digits >= 11.0
