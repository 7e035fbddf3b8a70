"""Six parameters of a bilinear hysteretic spring from any three independent ones."""

from itertools import combinations

import pytest

from eventpound.errors import InputError
from eventpound.scene.bouc_wen_parameters import Parameter, bouc_wen_parameters

# By hand: K_0 = 100, alpha = 0.05, u_y = 0.03: K_s = 5, F_y = 3, Q = 2.85.
EXACT = {
    Parameter.INITIAL_STIFFNESS: 100.0,
    Parameter.STIFFNESS: 5.0,
    Parameter.STRENGTH: 2.85,
    Parameter.YIELD_FORCE: 3.0,
    Parameter.YIELD_DISPLACEMENT: 0.03,
    Parameter.HARDENING: 0.05,
}
DEPENDENT = {
    frozenset({Parameter.INITIAL_STIFFNESS, Parameter.STIFFNESS, Parameter.HARDENING}): {
        Parameter.STRENGTH,
        Parameter.YIELD_FORCE,
        Parameter.YIELD_DISPLACEMENT,
    },
    frozenset({Parameter.INITIAL_STIFFNESS, Parameter.YIELD_FORCE, Parameter.YIELD_DISPLACEMENT}): {
        Parameter.STIFFNESS,
        Parameter.STRENGTH,
        Parameter.HARDENING,
    },
    frozenset({Parameter.STRENGTH, Parameter.YIELD_FORCE, Parameter.HARDENING}): {
        Parameter.INITIAL_STIFFNESS,
        Parameter.STIFFNESS,
        Parameter.YIELD_DISPLACEMENT,
    },
}
GIVEN = [c for n in (3, 4, 5, 6) for c in combinations(Parameter, n)]


@pytest.mark.parametrize("given", GIVEN, ids=", ".join)
def test_every_combination(given):
    values = {p: EXACT[p] for p in given}
    if frozenset(given) in DEPENDENT:
        with pytest.raises(InputError, match="add one of") as caught:
            bouc_wen_parameters(values)
        _, _, named = str(caught.value).partition("add one of ")
        assert set(named.split(", ")) == DEPENDENT[frozenset(given)]
        return
    found = bouc_wen_parameters(values)
    for parameter, exact in EXACT.items():
        value = found[parameter]
        if parameter in given:
            assert value == exact
        # alpha = 1 - Q/F_y loses 1/alpha = 20 in relative accuracy, and K_0 = K_s/alpha with it.
        assert value == pytest.approx(exact, rel=100 * 2.2e-16)


@pytest.mark.parametrize("given", list(combinations(Parameter, 2)), ids=", ".join)
def test_two_are_too_few(given):
    with pytest.raises(InputError, match="three independent ones"):
        bouc_wen_parameters({p: EXACT[p] for p in given})


@pytest.mark.parametrize("parameter", list(Parameter))
def test_values_given_twice_must_agree(parameter):
    with pytest.raises(InputError, match="disagree"):
        bouc_wen_parameters({**EXACT, parameter: EXACT[parameter] * (1.0 + 1e-6)})
    found = bouc_wen_parameters({**EXACT, parameter: EXACT[parameter] * (1.0 + 1e-11)})
    assert found[Parameter.STIFFNESS] == pytest.approx(5.0, rel=1e-10)


def test_elastoplastic_with_zeros_that_say_the_same():
    zeros = {Parameter.STIFFNESS: 0.0, Parameter.HARDENING: 0.0, Parameter.STRENGTH: 2.0}
    with pytest.raises(InputError, match="add one of initial_stiffness, yield_displacement"):
        bouc_wen_parameters(zeros)
    found = bouc_wen_parameters({**zeros, Parameter.YIELD_DISPLACEMENT: 0.5})
    assert found[Parameter.INITIAL_STIFFNESS] == 4.0
    assert found[Parameter.YIELD_FORCE] == 2.0


def test_elastic_spring_written_as_hysteretic():
    found = bouc_wen_parameters(
        {Parameter.STIFFNESS: 3.0, Parameter.STRENGTH: 0.0, Parameter.YIELD_DISPLACEMENT: 0.1}
    )
    assert found[Parameter.HARDENING] == 1.0
    assert found[Parameter.INITIAL_STIFFNESS] == 3.0


def test_softening_is_refused():
    with pytest.raises(InputError, match="stiffness = -20 N/m"):
        bouc_wen_parameters(
            {
                Parameter.INITIAL_STIFFNESS: 10.0,
                Parameter.STRENGTH: 3.0,
                Parameter.YIELD_DISPLACEMENT: 0.1,
            }
        )


def test_rounding_does_not_make_a_plastic_spring_soften():
    # 0.1 * 3 rounds up to 0.30000000000000004, so that Q/F_y may lie a rounding beyond 1.
    found = bouc_wen_parameters(
        {
            Parameter.INITIAL_STIFFNESS: 3.0,
            Parameter.STRENGTH: 0.1 * 3.0 * (1.0 + 4e-16),
            Parameter.YIELD_DISPLACEMENT: 0.1,
        }
    )
    assert found[Parameter.STIFFNESS] == 0.0
    assert found[Parameter.HARDENING] == 0.0


def test_ranges_are_reported_together():
    with pytest.raises(InputError) as caught:
        bouc_wen_parameters(
            {
                Parameter.STIFFNESS: -1.0,
                Parameter.STRENGTH: -1.0,
                Parameter.YIELD_DISPLACEMENT: 0.0,
                Parameter.HARDENING: 1.5,
            }
        )
    assert len(caught.value.problems) == 4
