"""Every solver, for every test that runs a whole scene."""

from __future__ import annotations

import pytest


@pytest.fixture(params=["cvode", "fast", "ida"])
def solver(request: pytest.FixtureRequest) -> str:
    """Name of a solver."""
    return str(request.param)
