"""Springs that are loaded one way."""

import numpy as np
import pytest

from eventpound.scene import BoucWen
from eventpound.scene.loaded_straight import Loops


@pytest.mark.parametrize("travel", [-0.5, -0.1, 0.02, 0.3, 3.0])
@pytest.mark.parametrize("z", [0.0, -0.4, 0.9])
def test_springs_loaded_straight(travel, z):
    """With n = 2 and beta = gamma = 1/2, z' = 1 - z^2 once z pulls the way it goes, 1 before."""
    loops = Loops.of([BoucWen(0.0, 1.0, 0.1, 2.0, initial_z=z)])
    way, x = np.sign(travel), abs(travel) / 0.1
    back = max(-way * z, 0.0)
    ahead = way * z if x < back else np.tanh(np.arctanh(max(way * z, 0.0)) + x - back)
    expected = way * (ahead + x if x < back else ahead)
    found = loops.loaded(np.array([travel]))[0]
    assert found == pytest.approx([expected], rel=4e-15, abs=4e-15)
