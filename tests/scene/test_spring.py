"""What of a law counts at rest."""

import pytest

from eventpound.scene import (
    Backfill,
    BilinearElastic,
    BoucWen,
    DegradingBoucWen,
    Linear,
    Series,
    Slider,
)
from eventpound.scene.at_rest import at_rest, stiffness_of
from tests.scene.test_at_rest import K, beside, deck

WORN = DegradingBoucWen(1e6, 5e5, 0.05, 2.0, initial_loss=3.0, stiffness_degradation=0.5)


@pytest.mark.parametrize(
    ("law", "counts"),
    [
        (Linear(3e6), 3e6),
        (BilinearElastic(4e6, 9e6, 0.1), 4e6),
        (BilinearElastic(4e6, 9e6, -0.1), 9e6),
        (BilinearElastic(4e6, 9e6), 4e6),
        (BilinearElastic(4e6, 0.0), 0.0),
        (Series((Linear(3e6), BilinearElastic(0.0, 6e6, -0.1))), 2e6),
        (Series((Linear(3e6), BilinearElastic(0.0, 6e6, 0.1))), 0.0),
        (BoucWen(1e6, 5e5, 0.05), 11e6),
        # gamma - beta = 0.6 of |z|^n = 0.25 stiffens what unloads.
        (BoucWen(1e6, 5e5, 0.05, 2.0, 0.2, 0.8, 0.5), 1e6 + 1e7 * 1.15),
        (BoucWen(1e6, 5e5, 0.05, 2.0, 0.2, 0.8, -0.5), 1e6 + 1e7 * 1.15),
        (WORN, 1e6 + 1e7 / 2.5),
        (Backfill(4e6, 1e6, 0.8), 0.0),
        (Backfill(4e6, 1e6, 0.8, 0.03), 0.0),
        (Slider(0.05, 1e7, 5e6), 5e6),
    ],
)
def test_what_counts_of_a_law(law, counts):
    assert beside(law) == pytest.approx(counts, rel=1e-12, abs=1e-7 * K)
    (_, spring) = at_rest(deck(law)).springs
    assert stiffness_of(spring) == pytest.approx(counts, rel=1e-14)
    yielded = law.stiffness if isinstance(law, BoucWen) else counts
    assert stiffness_of(spring, yielded=True) == pytest.approx(yielded, rel=1e-14)
    assert at_rest(at_rest(deck(law))) == at_rest(deck(law))
