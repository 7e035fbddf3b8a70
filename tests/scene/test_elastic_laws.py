"""Laws in series against the force balance of their massless nodes, solved numerically."""

import numpy as np
import pytest
from scipy.optimize import brentq

from eventpound.scene import BilinearElastic, Linear, Series
from eventpound.scene.elastic_laws import reduced
from tests.mechanics.dense import spring_force


def _series_force(parts: tuple[Linear | BilinearElastic, ...], x: float) -> float:
    """Force of laws in series: the nodes between them found by a root finder."""
    if len(parts) == 1:
        return spring_force(parts[0], x)

    def unbalance(first: float) -> float:
        return spring_force(parts[0], first) - _series_force(parts[1:], x - first)

    reach = 1.0
    while unbalance(-reach) * unbalance(reach) > 0.0:
        reach *= 4.0
    first = float(brentq(unbalance, -reach, reach, xtol=1e-14, rtol=1e-14))
    return spring_force(parts[0], first)


def _random_part(rng: np.random.Generator, slack: bool) -> Linear | BilinearElastic:
    k = 10.0 ** rng.uniform(-1, 1, 2)
    if slack:
        k[rng.integers(2)] = 0.0
    return BilinearElastic(*k, rng.normal()) if rng.random() < 0.7 else Linear(k.max())


@pytest.mark.parametrize(("count", "slack"), [(1, False), (2, False), (3, False), (2, True)])
def test_parts_in_series(count, slack):
    """Where one of two carries nothing the whole carries nothing."""
    rng = np.random.default_rng(51 if slack else count)
    for _ in range(100 if slack else 40):
        parts = tuple(_random_part(rng, slack) for _ in range(count))
        x = rng.normal(scale=3.0)
        # A node off by 1e-14 (nested once more for three parts) times stiffnesses up to 10.
        assert spring_force(reduced(Series(parts)), x) == pytest.approx(
            _series_force(parts, x), abs=1e-11
        )


def test_published_abutment():
    # A 150 000 kN/m bearing in series with 455 328 kN/m into and 1 751 kN/m away.
    law = reduced(Series((Linear(150e6), BilinearElastic(455.328e6, 1.751e6))))
    assert law.compression == pytest.approx(150e6 * 455.328e6 / 605.328e6, rel=1e-15)
    assert law.extension == pytest.approx(150e6 * 1.751e6 / 151.751e6, rel=1e-15)
    assert law.offset == 0.0


def test_simple_laws_stay_as_they_are():
    law = BilinearElastic(1.0, 2.0, 0.3)
    assert reduced(law) == law
    assert reduced(Linear(4.0)) == BilinearElastic(4.0, 4.0, 0.0)
