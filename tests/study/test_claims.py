"""What the founding paper says of its spectra, where it can be asserted of any parameters."""

import math

import numpy as np
import pytest

from eventpound import Cosine, simulate_many
from eventpound.scene.pi_structure import Kind, PiStructure
from eventpound.simulation import response_of
from eventpound.study.reading import load_study
from tests.benchmarks.figure_agreement import CASES, LIMIT, difference
from tests.study.test_figure_cases import NAMES

PERIOD = 2.0 * math.pi
TERMS = {"uy": 0.2, "Q": 0.4, "delta": 0.5, "epsilon": 0.7}


def peak(kind, terms):
    scene = PiStructure(kind, ("0", "barrier")).scene(Cosine(1.0, PERIOD), terms)
    run = response_of(scene, "fast", 1e-12, duration=6 * PERIOD)
    return float(run.peaks.loc["0", "abs_max"])


def test_elastoplastic_is_the_limit_of_bilinear():
    """Π_um differs in proportion to the stiffness after yield, Π_ωs squared (section 4)."""
    limit = peak(Kind.ELASTOPLASTIC, TERMS)
    frequencies = np.array([1e-2, 1e-3, 1e-4])
    apart = [abs(peak(Kind.BILINEAR, TERMS | {"omega_s": w}) - limit) for w in frequencies]
    # The next term is Π_ωs^4: at 1e-2 a share 1e-4 of the first, times a moderate number.
    assert apart / frequencies**2 == pytest.approx([apart[1] / 1e-6] * 3, rel=1e-2)


def test_a_symmetric_triplet_has_no_direction():
    """Its centre moves the other way under the reversed pulse, as far (figures 8 and 9)."""
    terms = TERMS | {"omega_s": 0.8, "omega_s.i": 0.5}
    structure = PiStructure(Kind.BILINEAR, ("1", "0", "2"))
    peaks = []
    for reverse in (False, True):
        scene = structure.scene(Cosine(1.0, PERIOD, reverse), terms)
        peaks.append(float(response_of(scene, "fast", 1e-10).peaks.loc["0", "abs_max"]))
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-12)


def test_a_gap_beyond_the_free_peak_does_not_matter():
    structure = PiStructure(Kind.ELASTOPLASTIC, ("0", "barrier"))
    scene = structure.scene(Cosine(1.0, PERIOD), TERMS)
    free = peak(Kind.ELASTOPLASTIC, TERMS | {"delta": 1e3})
    many = simulate_many(scene, {"contact.0-barrier.gap": [free * 1.001, 100.0]}, rtol=1e-12)
    assert many.impacts.sum() == 0.0
    assert many.displacement.maximum[0] == many.displacement.maximum[1]


@pytest.mark.parametrize(
    "seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.sweep) for seed in range(2, 12))]
)
def test_points_of_the_figures_agree_with_cvode(seed):
    rng = np.random.default_rng(seed)
    study = load_study(CASES / str(rng.choice(NAMES))).study
    apart, which = difference(study, int(rng.integers(study.size)))
    assert apart <= LIMIT, which
