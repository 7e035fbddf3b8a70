"""What a certificate says of its routes, and how many digits it prints."""

from dataclasses import replace

import pytest

from eventpound.accuracy import routes
from eventpound.accuracy.certificate import certificate_text, significant
from eventpound.accuracy.verify import verify
from eventpound.scene import BARRIER, Body, Contact, ContactLaw, Scene
from tests.accuracy.test_verify import _by, _wall


def test_who_carried_the_motion_is_said():
    """SUNDIALS between events, the local series right after them."""
    certificate = verify(_wall(0.5), duration=4.0)
    shares = {r.label: r.sundials for r in certificate.solver_routes}
    assert shares.pop("fast") is None
    assert all(0.5 < share < 1.0 for share in shares.values())
    assert "% of the time by CVODE" in certificate_text(certificate)


def test_routes_that_sundials_never_carried_are_one():
    """A free body flies to a wall and back: the local series after its start is all there is."""
    free = Scene((Body("b", 1.0, -1.0, 1.0),), (), (), (Contact("wall", "b", BARRIER, 0.5, 0.5),))
    certificate = verify(free, duration=4.0)
    assert [r.sundials for r in certificate.solver_routes] == [None, 0.0, 0.0, 0.0]
    assert len({r.formulation for r in certificate.solver_routes}) == 2
    assert "0 % of the time by IDA, 100 % by series after events" in certificate_text(certificate)
    # Rounding alone moves it.
    assert certificate.certified
    assert len(_by(routes.REFERENCE, certificate)) == len(certificate.quantities)


def test_where_cvode_alone_is_left_its_methods_confirm_each_other():
    """And the certificate says that no other program does, and which are left out."""
    contact = Contact("wall", "b", BARRIER, 0.5, 0.5, ContactLaw("hertz-damp", 1e3))
    certificate = verify(replace(_wall(0.5), contacts=(contact,)), duration=4.0)
    assert certificate.certified
    assert {r.solver for r in certificate.solver_routes} == {"cvode"}
    assert {r.formulation for r in certificate.solver_routes} == set(routes.BY_METHOD.values())
    (said,) = [w for w in certificate.warnings if w.startswith("left out: fast and ida,")]
    assert "what they share no other program confirms" in said
    assert set(routes.SHARED_BY_METHODS) < set(certificate.shared_code)
    assert f"warning     {said}" in certificate_text(certificate)


@pytest.mark.parametrize(
    ("value", "bound", "text"),
    [(0.123456789, 2e-5, "0.12346"), (12.5, 3.0, "12"), (0.5, None, "0.5"), (0.0, 1e-3, "0.000")],
)
def test_values_are_printed_as_far_as_they_hold(value, bound, text):
    assert significant(value, bound) == text
