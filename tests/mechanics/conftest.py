"""These kernels are parts of others: no run calls them from Python."""

import pytest


@pytest.fixture(autouse=True)
def by_python(interpreted):
    """Nothing is compiled here."""
