"""Published PGA, T_m, Arias intensity, PGV and duration of the same digital files."""

import pytest

from tests.motion.published import Published, published_with_slammer
from tests.motion.readers.real_records import FOLDER


def _all() -> list[Published]:
    return published_with_slammer() if FOLDER.is_dir() else []


@pytest.mark.skipif(not FOLDER.is_dir(), reason=f"there are no real records in {FOLDER}")
@pytest.mark.parametrize("published", _all(), ids=lambda published: published.name)
def test_published_numbers_are_met_to_their_print(published):
    for name, ours, printed, decimals, conventions in published.pairs():
        allowed = 0.5 * 10.0**-decimals * (1.0 + 1e-6) + conventions
        assert abs(ours - float(printed)) <= allowed, name
