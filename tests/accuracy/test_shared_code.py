"""The code that certificates say is shared is what both solvers import."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import eventpound
from eventpound.accuracy.routes import (
    LOCATION,
    MULTISTEP,
    SHARED,
    SHARED_AT_POINTS,
    TAYLOR,
    routes_of,
    shared_code,
)
from tests.reference.problems import load

ROOT = Path(eventpound.__file__).parents[1]


def _file(module: str) -> Path | None:
    path = ROOT.joinpath(*module.split("."))
    candidates = (path.with_suffix(".py"), path / "__init__.py")
    return next((file for file in candidates if file.is_file()), None)


def _imports(file: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for alias in node.names:
                name = f"{node.module}.{alias.name}"
                yield name if _file(name) else node.module


def _closure(module: str) -> set[str]:
    """Every module that a module imports, directly or not."""
    seen: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        file = _file(name)
        if name not in seen and file is not None:
            seen.add(name)
            waiting += _imports(file)
    return seen


@pytest.mark.parametrize(
    ("solver", "formulation"),
    [("eventpound.solvers.fast.solver", TAYLOR), ("eventpound.solvers.cvode", MULTISTEP)],
)
def test_what_is_listed_is_used(solver, formulation):
    used = _closure(solver)
    for module, _, formulations in SHARED:
        assert _file(module) is not None
        if formulation in formulations:
            assert module in used


def test_what_computes_in_both_is_listed():
    """The laws and the numerics of contacts."""
    both = _closure("eventpound.solvers.fast.solver") & _closure("eventpound.solvers.cvode")
    listed = {module for module, _, _ in SHARED}
    for module in ("impact", "contact_problem", "clusters", "model"):
        assert f"eventpound.mechanics.{module}" in both & listed
    assert "eventpound.scene.elastic_laws" in both & listed
    for module in ("lcp", "polynomial"):
        assert f"eventpound.numerics.{module}" in both & listed


def test_what_computes_contacts_at_points_is_listed_where_some_are():
    """The routes that take them."""
    both = _closure("eventpound.solvers.ida") & _closure("eventpound.solvers.cvode")
    assert set(SHARED_AT_POINTS) <= both
    routes = routes_of(load()["A01"].scene)
    more = shared_code(routes, at_points=True).keys() - shared_code(routes).keys()
    assert more == set(SHARED_AT_POINTS)


def test_a_route_whose_events_sundials_finds_is_told_apart():
    routes = routes_of(load()["A01"].scene)
    found = [route for route in routes if route.finds_events]
    assert [route.solver for route in found] == ["cvode"]
    assert repr(found[0].label) in shared_code(routes)[LOCATION]
    assert "root finder" not in shared_code(tuple(r for r in routes if r not in found))[LOCATION]
