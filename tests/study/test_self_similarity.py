"""Self-similarity: Π_um depends on Π-terms alone, whatever a_g and ω_g (sections 3 to 5)."""

import math

import numpy as np
import pytest

from eventpound.motion import Cosine, Ricker, Sine
from eventpound.scene.pi_structure import Kind, PiStructure
from eventpound.simulation import response_of

ROWS = {
    Kind.ELASTIC: ("0", "barrier"),
    Kind.ELASTOPLASTIC: ("barrier", "0"),
    Kind.BILINEAR: ("1", "0", "2"),
}
MOTIONS = (Sine, Cosine, Ricker)
PERIODS = 6


def random_terms(structure, rng):
    terms = {"delta": rng.uniform(0.05, 1.0), "epsilon": rng.uniform(0.3, 0.9)}
    terms |= {key: rng.uniform(0.1, 1.5) for key in structure.kind.needed}
    if len(structure.oscillators) > 1:
        terms |= {key: rng.uniform(0.4, 2.0) for key in ("m.1", "omega_s.1", "omega_s.2", "Q.2")}
    return terms


@pytest.mark.parametrize("seed", range(6))
def test_ten_motions_one_response(seed):
    rng = np.random.default_rng(seed)
    kind = tuple(ROWS)[seed % 3]
    structure = PiStructure(kind, ROWS[kind])
    terms, motion = random_terms(structure, rng), MOTIONS[seed % len(MOTIONS)]
    found = []
    for a_g, omega_g in 10.0 ** rng.uniform(-2.0, 2.0, (10, 2)):
        period = 2.0 * math.pi / omega_g
        scene = structure.scene(motion(float(a_g), period), terms, float(rng.uniform(0.1, 1e6)))
        run = response_of(scene, "fast", 1e-10, duration=PERIODS * period)
        found.append(float(run.peaks.loc["0", "abs_max"]) / scene.motion.scales().length)
    assert max(found) - min(found) <= 1e-9 * max(found)
