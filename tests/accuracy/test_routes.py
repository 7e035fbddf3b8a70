"""The code that certificates say is shared is what both solvers import."""

import ast
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import eventpound
from eventpound.accuracy.routes import (
    LOCATION,
    MULTISTEP,
    SHARED,
    SHARED_AT_POINTS,
    SHARED_BY_METHODS,
    SHARED_WITH_FRICTION,
    SHARED_WITH_LAWS,
    SHARED_WITH_LOADS,
    SHARED_WITH_SLIDERS,
    TAYLOR,
    routes_of,
    shared_code,
)
from eventpound.scene import ContactLaw, Force, Point, Slider, Spring
from tests.reference.problems import load

ROOT = Path(eventpound.__file__).parents[1]


def _file(module: str) -> Path | None:
    path = ROOT.joinpath(*module.split("."))
    candidates = (path.with_suffix(".py"), path / "__init__.py")
    return next((file for file in candidates if file.is_file()), None)


@cache
def _imports(file: Path) -> tuple[str, ...]:
    nodes = (n for n in ast.walk(ast.parse(file.read_text())) if isinstance(n, ast.ImportFrom))
    names = [(n.module, f"{n.module}.{a.name}") for n in nodes if not n.level for a in n.names]
    return tuple(name if _file(name) else str(module) for module, name in names)


@cache
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


NEITHER = {
    # Types, arrays, names and the means by which kernels are compiled and called.
    "mechanics.coordinates",
    "mechanics.descriptor",
    "mechanics.ground_frame",
    "mechanics.pressures",
    "mechanics.reduced",
    "mechanics.reduced_loads",
    "mechanics.supported",
    "contact.event",
    "contact.event_rows",
    "contact.state",
    "solvers.events.dense",
    "solvers.events.modes",
    "solvers.events.recorder",
    "solvers.events.run",
    "solvers.events.step_check",
    "solvers.events.event_run",
}
"""Modules of both of which `fast` takes types, constants, rows of a file or scales only, and
which of many forces of locked contacts are told: no motion depends on them."""


def test_whatever_computes_in_both_is_listed():
    """Each module that both import is in the lists of a certificate or has a reason not to be."""
    both = _closure("eventpound.solvers.fast.solver") & _closure("eventpound.solvers.cvode")
    wanted = {
        module
        for module in both
        if module.startswith(
            ("eventpound.mechanics.", "eventpound.contact.", "eventpound.solvers.events.")
        )
        or module in ("eventpound.solvers.supported", "eventpound.scene.elastic_laws")
        or module in ("eventpound.numerics.lcp", "eventpound.numerics.polynomial")
    }
    listed = {module for module, _, _ in SHARED}
    listed |= {*SHARED_AT_POINTS, *SHARED_WITH_LAWS, *SHARED_WITH_LOADS, *SHARED_WITH_FRICTION}
    listed |= {module for module in SHARED_WITH_SLIDERS if ".contact." in module}
    assert wanted - listed == {f"eventpound.{name}" for name in NEITHER}


def test_what_carries_both_reference_solvers_is_listed():
    """The local series after events is one program for CVODE and IDA, not for `fast`."""
    series = "eventpound.solvers.events.short_series"
    assert series not in _closure("eventpound.solvers.fast.solver")
    for solver in ("cvode", "ida"):
        assert series in _closure(f"eventpound.solvers.{solver}")
    assert series in shared_code(routes_of(scene := load()["A01"].scene), scene)


def test_what_some_scenes_need_is_listed_where_they_do():
    plain = load()["A01"].scene
    contact, body = plain.contacts[0], plain.bodies[0].name
    side = "left" if contact.left == body else "right"
    sliding = Spring("bearing", ("ground", body), Slider(0.1, 1.0))
    pointed = replace(contact, **{side: Point({body: 1.0})})
    alone = {*SHARED_BY_METHODS}
    for scene, more in (
        (replace(plain, contacts=(pointed,)), {*SHARED_AT_POINTS}),
        (
            replace(plain, contacts=(replace(contact, law=ContactLaw("linear", 1e6)),)),
            alone | {*SHARED_WITH_LAWS},
        ),
        (replace(plain, forces=(Force(body, 1.0),)), {*SHARED_WITH_LOADS}),
        (replace(plain, springs=(sliding,)), {*SHARED_WITH_SLIDERS}),
    ):
        known = shared_code(routes_of(plain), plain)
        assert set(shared_code(routes_of(scene), scene)) - set(known) == more


def test_what_the_methods_of_cvode_share_is_what_it_computes_with():
    used = _closure("eventpound.solvers.cvode")
    assert {*SHARED_BY_METHODS, *SHARED_WITH_LAWS, *SHARED_AT_POINTS} <= used


def test_routes_whose_events_sundials_finds_are_told_apart():
    routes = routes_of(scene := load()["A01"].scene)
    found = [route for route in routes if route.finds_events]
    assert [route.solver for route in found] == ["cvode", "ida"]
    said = shared_code(routes, scene)[LOCATION]
    assert all(repr(route.label) in said for route in found)
    others = tuple(route for route in routes if route not in found)
    assert LOCATION not in shared_code(others, scene)
