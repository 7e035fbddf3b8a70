"""Every solver, for every test that runs a whole scene."""

import pytest


@pytest.fixture(params=["cvode", "fast", "ida"])
def solver(request):
    """Name of a solver."""
    return str(request.param)
