"""OpenSeesPy on the same scene, where it is installed: the field's usual tool."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec

PACKAGE = "openseespy"


@cache
def installed() -> bool:
    """Whether OpenSeesPy is there, without importing it."""
    return find_spec(PACKAGE) is not None
