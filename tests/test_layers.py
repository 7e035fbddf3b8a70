"""Imports point down the list of layers only, and what is quick to start imports nothing heavy."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import eventpound

ROOT = Path(eventpound.__file__).parent
LAYERS = (
    ("cli",),
    ("report",),
    ("study", "problems"),
    ("accuracy",),
    ("results",),
    ("simulation",),
    ("response",),
    ("quantities",),
    ("solvers",),
    ("contact",),
    ("mechanics",),
    ("case",),
    ("scene",),
    ("motion",),
    ("numerics",),
    (*("units", "errors", "tolerances", "basics", "score"),),
)
"""From the top down; those of one line stand side by side."""
HEIGHT = {name: -level for level, names in enumerate(LAYERS) for name in names}
HEAVY = ("numpy", "pandas", "matplotlib", "numba", "scipy", "sksundae", "pint")
MODULES = sorted(ROOT.rglob("*.py"))


@cache
def _parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text())


def _layer(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return parts[0]


def _is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def _package(path: Path) -> list[str]:
    return ["eventpound", *path.relative_to(ROOT).parts[:-1]]


def _imports(tree: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """Every import of a module, those in functions too, those for type checkers not."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif isinstance(node, ast.If) and _is_type_checking(node):
            for other in node.orelse:
                yield from _imports(other)
        else:
            yield from _imports(node)


def _own_targets(node: ast.Import | ast.ImportFrom, package: list[str]) -> Iterator[str]:
    """Full names of what an import takes from this package."""
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    else:
        base = package[: len(package) - node.level + 1] if node.level else []
        module = ".".join([*base, *([node.module] if node.module else [])])
        names = [f"{module}.{alias.name}" for alias in node.names]
    yield from (name for name in names if name.split(".")[0] == "eventpound")


def test_imports_point_down():
    for path in MODULES:
        if path.parent == ROOT and path.name in ("__init__.py", "__main__.py"):
            # The front door and its bell: above every layer.
            continue
        here = _layer(path)
        assert here in HEIGHT, f"{path}: {here} is in no layer"
        for node in _imports(_parsed(path)):
            for name in _own_targets(node, _package(path)):
                there = name.split(".")[1] if "." in name else ""
                assert there in HEIGHT, f"{path}: {name} is no layer"
                assert HEIGHT[there] <= HEIGHT[here], f"{path}: {here} must not import {name}"


def _circle(sources: dict[str, tuple[list[str], ast.AST]]) -> list[str]:
    """Modules that import each other, in functions and for type checkers too; [] for none.

    `sources`: of each module the package it is in, and what it says.
    """
    graph: dict[str, set[str]] = {}
    for name, (package, tree) in sources.items():
        nodes = (n for n in ast.walk(tree) if isinstance(n, ast.Import | ast.ImportFrom))
        targets = {target for node in nodes for target in _own_targets(node, package)}
        # Of what is no module itself, the module that it is taken from.
        graph[name] = {t if t in sources else t.rpartition(".")[0] for t in targets} - {name}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_modules_import_each_other():
    sources = {
        ".".join([*_package(path), path.stem]).removesuffix(".__init__"): (
            _package(path),
            _parsed(path),
        )
        for path in MODULES
    }
    assert _circle(sources) == []


@pytest.mark.parametrize(
    "arguments",
    [["-c", "import eventpound"], ["-m", "eventpound", "--help"]],
    ids=["import", "help"],
)
def test_nothing_heavy_is_imported(arguments):
    run = subprocess.run(
        [sys.executable, "-X", "importtime", *arguments],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT.parent,
    )
    # "import time: self [us] | cumulative | imported package"
    imported = {line.rpartition("|")[2].strip() for line in run.stderr.splitlines()}
    assert "eventpound" in imported
    assert not {name.split(".")[0] for name in imported} & set(HEAVY)
