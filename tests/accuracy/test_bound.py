import numpy as np
import pytest

from eventpound.accuracy.bound import SAFETY, Agreement, Limit, bounds_of, rounding_of_run
from eventpound.accuracy.conditioning import LARGE, SMALL, Conditioning
from eventpound.tolerances import EPS

TRUE = np.array([1.0, -2.0, 0.5])


def _smooth(slope: float = 1.0) -> Conditioning:
    large = np.full(3, slope * LARGE)
    return Conditioning(large, large * SMALL / LARGE, np.zeros(3, np.bool_), np.zeros(1))


def _agreement(errors: list[tuple[float, float]], formulation: str = "ABB") -> Agreement:
    """Routes whose tight and loose errors are these, in every quantity."""
    tight, loose = (np.array([TRUE + e[k] for e in errors]) for k in (0, 1))
    return Agreement(tight, loose, formulation, 0)


def test_bound_holds_the_error_of_a_route_that_converges():
    agreement = _agreement([(1e-12, 1e-11), (3e-11, -2e-10), (-5e-11, 7e-10)])
    bounds = bounds_of(agreement, _smooth(), np.abs(TRUE), displaced=100 * EPS)
    error = np.abs(agreement.values - TRUE)
    assert np.all(error < bounds.bound)
    assert agreement.confirmed == pytest.approx(np.full(3, 2.9e-11), rel=1e-3)
    assert bounds.bound == pytest.approx(np.full(3, SAFETY * 9e-12), rel=0.05)
    assert bounds.limit == [Limit.TOLERANCE] * 3


def test_values_that_agree_by_chance_are_held_by_the_others():
    """The tight and the loose run of the reference coincide in the second quantity."""
    agreement = _agreement([(1e-12, 1e-11), (3e-12, 2e-11), (1e-11, 7e-11)])
    agreement.loose[0, 1] = agreement.tight[0, 1]
    agreement.tight[1, 1] = agreement.tight[0, 1]
    bounds = bounds_of(agreement, _smooth(), np.abs(TRUE), displaced=100 * EPS)
    assert bounds.bound[1] == pytest.approx(bounds.bound[0], rel=0.1)


def test_a_route_that_does_not_agree_widens_the_bound_to_itself():
    agreement = _agreement([(1e-12, 1e-11), (3e-11, -2e-10), (1e-3, 1.001e-3)])
    bounds = bounds_of(agreement, _smooth(1e-3), np.abs(TRUE), displaced=100 * EPS)
    assert bounds.bound == pytest.approx(np.full(3, 2e-3), rel=1e-6)
    assert bounds.limit == [Limit.DISAGREEMENT] * 3


def test_without_another_formulation_there_is_no_bound():
    agreement = _agreement([(1e-12, 1e-11), (3e-12, 2e-11), (1e-11, 7e-11)], "AAA")
    bounds = bounds_of(agreement, _smooth(), np.abs(TRUE), displaced=100 * EPS)
    assert np.all(np.isnan(bounds.bound))
    assert bounds.limit == [Limit.ALONE] * 3


def test_what_rounding_decides_has_no_bound():
    agreement = _agreement([(1e-12, 1e-11), (3e-12, 2e-11), (1e-11, 7e-11)])
    jump = np.array([0.3, 1e-5, 1e-5])
    small = np.array([0.0, SMALL, 10.0**-6.5])
    conditions = Conditioning(jump, small, np.array([False, True, False]), np.zeros(1))
    bounds = bounds_of(agreement, conditions, np.ones(3), displaced=0.0)
    assert bounds.limit == [Limit.JUMP, Limit.LOST, Limit.GRAZE]
    assert np.isnan(bounds.bound[:2]).all()
    # Δ(1e-13) (2^-53/1e-13)^(1/2), twice.
    assert bounds.bound[2] == pytest.approx(2.0 * 10.0**-6.5 * np.sqrt(2.0**-53 / SMALL), rel=0.02)


def test_a_route_without_an_event_leaves_it_to_the_others():
    agreement = _agreement([(1e-12, np.nan), (3e-11, -2e-10), (np.nan, 7e-10)])
    bounds = bounds_of(agreement, _smooth(), np.abs(TRUE), displaced=100 * EPS)
    assert bounds.bound == pytest.approx(np.full(3, SAFETY * 2.9e-11), rel=0.05)


def test_every_rounding_of_the_state_counts_in_full():
    """A sum that grows by the same part rounds the same way for long: no random walk."""
    steps, part = 10_000, 0.1
    total = 0.0
    for _ in range(steps):
        total += part
    error, scale = abs(total - steps * part), np.full(3, steps * part)
    assert error > 5.0 * np.sqrt(steps) * EPS * scale[0]
    assert error < rounding_of_run(_smooth(0.0), scale, steps * EPS)[0]


def test_rounding_grows_with_what_collects_and_amplification():
    one = np.ones(3)
    many, few = (rounding_of_run(_smooth(), one, n * EPS)[0] - 4.0 * EPS for n in (4000, 1000))
    assert many == pytest.approx(4.0 * few)
    steep = rounding_of_run(_smooth(30.0), one, 1000 * EPS)[0]
    assert steep == pytest.approx(EPS * (4.0 + 1000.0 * (1.0 + 30.0)))


def test_what_collects_before_a_graze_grows_as_its_root():
    """Δ(η) = sqrt(η): 450 roundings do what a change of the inputs by 1e-13 does."""
    root = Conditioning(
        np.full(3, np.sqrt(LARGE)), np.full(3, np.sqrt(SMALL)), np.zeros(3, np.bool_), np.zeros(1)
    )
    collected = rounding_of_run(root, np.zeros(3), 450 * EPS)
    assert collected == pytest.approx(np.full(3, np.sqrt(450.0 * EPS)), rel=1e-6)
