"""Elastic spring laws reduced to two stiffnesses and an offset.

Every elastic law of a scene is ``F = k_c (x - o)`` for ``x < o`` and
``k_e (x - o)`` above. Laws in series carry the same force and add their
elongations; since each of them changes stiffness at zero force only, the
whole is again of that form with ``o = Σ o_i``, ``1/k = Σ 1/k_i`` on each side
(so the whole is slack on a side where one part is).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.spring import BilinearElastic, BoucWen, Hysteretic, Law, Linear, Slider


class ElasticLaws(NamedTuple):
    """Laws as arrays, one entry a law: the fields of `BilinearElastic`."""

    compression: Floats
    extension: Floats
    offset: Floats

    def one(self, i: int) -> ElasticLaws:
        """Law i, for many elongations."""
        return ElasticLaws(*(column[i] for column in self))

    def first(self, count: int) -> ElasticLaws:
        """The first laws, so many of them."""
        return ElasticLaws(*(column[:count] for column in self))

    def on_side(self, side: Ints) -> tuple[Floats, Floats]:
        """K (N/m) and f (N) of ``F = k x + f`` below the kinks (negative) or above them."""
        stiffness = np.where(side < 0, self.compression, self.extension)
        return stiffness, -stiffness * self.offset


def as_arrays(laws: Iterable[Law | Hysteretic]) -> ElasticLaws:
    """Laws as arrays, as `reduced`."""
    columns = np.array([*map(_constants, laws)], float)
    return ElasticLaws(*columns.reshape(-1, 3).T.copy())


def reduced(law: Law | Hysteretic) -> BilinearElastic:
    """The law as two stiffnesses and an offset; of one with a memory what is elastic.

    Parameters
    ----------
    law : Law
        Any law.

    Returns
    -------
    BilinearElastic
        The same force for every elongation.
    """
    return BilinearElastic(*_constants(law))


def _constants(law: Law | Hysteretic) -> tuple[float, float, float]:
    """Stiffnesses below and above the offset (N/m), and the offset (m)."""
    if isinstance(law, Linear | BoucWen | Slider):
        return law.stiffness, law.stiffness, 0.0
    if isinstance(law, Hysteretic):
        return 0.0, 0.0, law.offset
    if isinstance(law, BilinearElastic):
        return law.compression, law.extension, law.offset
    compression, extension, offset = zip(*map(_constants, law.parts), strict=True)
    return _in_series(compression), _in_series(extension), sum(offset)


def elastic_force(law: BilinearElastic | ElasticLaws, x: Floats) -> tuple[Floats, Floats]:
    """Force of a law and its stiffness at elongations (N, N/m), each of the shape of `x` (m).

    Of several laws `x` holds an elongation each, perhaps of many instants: shape (..., L).
    """
    stiffness = np.where(x < law.offset, law.compression, law.extension)
    return stiffness * (x - law.offset), stiffness


def _in_series(stiffnesses: Sequence[float]) -> float:
    if min(stiffnesses) == 0.0:
        return 0.0
    return 1.0 / sum(1.0 / k for k in stiffnesses)
