"""Loops between rows, against the law integrated from row to row."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound import BoucWen
from eventpound.quantities.loops import loop_of


@pytest.mark.parametrize("exponent", [1.0, 20.0, 1000.0])
def test_a_loop_between_rows_far_apart_keeps_to_the_strength(exponent):
    law = BoucWen(2.0e6, 3.0e6, 0.01, exponent)
    t = np.linspace(0.0, 2.0, 21)
    x, rate = 0.2 * np.sin(np.pi * t), 0.2 * np.pi * np.cos(np.pi * t)

    def slope(t: float, z: np.ndarray) -> np.ndarray:
        v, size = 0.2 * np.pi * np.cos(np.pi * t), np.minimum(abs(z), 1.0)
        return (v - 0.5 * (abs(v) * np.sign(z) + v) * size**exponent) / 0.01

    z = solve_ivp(slope, (0.0, 2.0), [0.0], "LSODA", t, rtol=1e-8, atol=1e-10, max_step=1e-3).y[0]
    along, force = loop_of(law, t, x, rate, z)
    assert force[::16] == pytest.approx(2.0e6 * x + 3.0e6 * z, abs=10.0)
    assert abs(force - 2.0e6 * along).max() <= 3.0e6 * (1.0 + 1e-12)
