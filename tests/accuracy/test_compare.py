"""The rigid law that a contact element stands for."""

from dataclasses import replace

import pytest

from eventpound.accuracy.compare import meant_restitution, restitution_of, rigid
from eventpound.scene import Contact, ContactLaw
from eventpound.scene.contact_law import BY_WORD, Element, damping_constant
from tests.solvers.laws.test_scenes import pair


@pytest.mark.parametrize("restitution", [0.0, 0.01, 0.3, 0.6, 0.99, 1.0])
@pytest.mark.parametrize("word", [e.word for e in Element if e.damped])
def test_formulas_are_inverted(word, restitution):
    element = BY_WORD[word]
    if element is Element.JANKOWSKI and restitution == 0.0:
        return
    constant = damping_constant(element, restitution)
    # Rounding of e², which 1 - e² leaves, is 1e-16/(2e) of a small e.
    assert restitution_of(element, constant) == pytest.approx(restitution, rel=1e-12, abs=2e-14)


def test_more_damping_than_any_restitution_asks_for():
    assert restitution_of(Element.KELVIN_VOIGT, 1.7) == 0.0
    assert restitution_of(Element.HERTZ_DAMP, 0.8) == 0.0
    assert 0.0 < restitution_of(Element.JANKOWSKI, 1e6) < 1e-6


def test_what_a_contact_means():
    def meant(restitution: float | None, law: ContactLaw | None) -> float:
        return meant_restitution(Contact("c", "a", "b", 0.1, restitution, law))

    assert meant(0.4, None) == 0.4
    assert meant(0.4, ContactLaw("hertz-damp", 1e5)) == 0.4
    assert meant(None, ContactLaw("hertz", 1e5)) == 1.0
    assert meant(None, ContactLaw("linear", 1e5)) == 1.0
    # a = 3 (1 - e²)/4.
    assert meant(None, ContactLaw("hertz-damp", 1e5, 0.48)) == pytest.approx(0.6)


def test_newton_contacts_stay():
    scene = pair("jankowski")
    scene = replace(
        scene, contacts=(scene.contacts[0], replace(scene.contacts[1], law=None, restitution=0.9))
    )
    assert [(c.law, c.restitution) for c in rigid(scene).contacts] == [(None, 0.5), (None, 0.9)]
    assert [c.restitution for c in rigid(scene, 0.2).contacts] == [0.2, 0.9]
