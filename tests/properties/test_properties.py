"""Properties on random scenes: a sample with fixed seeds, and that violations are seen.

The long run is a command: ``python -m tests.properties 2000 0 fast``.
"""

import pytest

from tests.properties.invariance import examine

MENDED = (15, 77, 1118, 1780, 2119, 2189)
"""Cascades with ε = 0, bodies without play, an elastic contact pressed shut."""
FADING = (300045, 301073, 341098, 345069, 6003787, 6004098)
"""Contacts pressed, or let go, by the tail of a pulse and no more."""
ON_KINK = (200200, 300306, 301081, 321219, 310223, 359223, 358881)
"""Links on their kinks in cascades, at rest and at the start, contacts that hardly press."""
COLLAPSED = (301027,)
"""A body caught at intervals whose squares are no numbers."""
FAINT = (507283, 505354, 508550, 509957)
"""Bodies that part with next to no force, bounce with less than rounding, or all but part."""
SOON_OVER = (861659, 871449)
"""Cascades in which a body comes to rest for less than 1e-12 T, time and again."""
JUST_REACHED = (3005451,)
"""A gap whose two roots all but meet."""
LET_GO = (6009567,)
"""A chain of which two contacts are released at once and one of them closes again."""
SEEDS = (
    *(*MENDED, *FADING, *ON_KINK, *COLLAPSED, *FAINT, *SOON_OVER, *JUST_REACHED, *LET_GO),
    *range(20, 32),
)
SLOW = (*SOON_OVER, *FAINT[-1:], 321219)
"""They take more than a second."""
SAMPLE = [
    pytest.param("fast", seed, marks=[pytest.mark.sweep] if seed in SLOW else []) for seed in SEEDS
]
SAMPLE += [(solver, seed) for solver in ("cvode", "ida") for seed in (1, 301081, 310223)]
BROKEN = ("VIOLATION", "ComputationError")


@pytest.mark.parametrize(("solver", "seed"), SAMPLE)
def test_random_scenes(solver, seed):
    found = examine(seed, solver)
    assert [f for f in found if f.word in BROKEN] == []
    assert len({f.property for f in found}) == 9
