"""A run with every kind of event."""

import pytest

from eventpound import simulate
from tests.solvers.scenes import pounding_pair

END = 6.0


@pytest.fixture(scope="module")
def response():
    return simulate(pounding_pair(), duration=END, energy=True)
