"""Earthquake response of structures that collide, every impact located.

case = eventpound.load_case("cases/bridge-pulse")
response = eventpound.simulate(case)
response.peaks, response.events, response.history
"""

from __future__ import annotations

from typing import Any

# Their list is the stub beside this file.
with open(f"{__file__.removesuffix('c')}i", encoding="utf-8") as _stub:
    _HOME = {words[-1]: words[1] for words in map(str.split, _stub) if words[:1] == ["from"]}
__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used, so that importing the package costs little."""
    from importlib import import_module

    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    """Public names only, whether they were imported by now or not."""
    return sorted([*(name for name in globals() if name.startswith("__")), *_HOME])
