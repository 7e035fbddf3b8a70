"""Thresholds stand in one module, each with a reason, and each is used."""

import ast
import io
import math
import tokenize
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import eventpound
from eventpound import tolerances

ROOT = Path(eventpound.__file__).parent
ENGINE = ("contact", "mechanics", "numerics", "solvers")
NAMES = sorted(name for name in vars(tolerances) if name.isupper())


def _thresholds(text: str) -> Iterator[tuple[int, str]]:
    """Line and text of each number that is written with an exponent, or is a small power of ten."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.NUMBER and token.string[:2].lower() not in ("0x", "0o"):
            value = abs(complex(token.string.replace("_", "")))
            power = 0.0 < value < 0.005 and math.log10(value).is_integer()
            if "e" in token.string.lower() or power:
                yield token.start[0], token.string


def test_what_counts_as_a_threshold():
    text = "a = 1e-9 * b + 0.001 - 0.5 + 100_000 + 2.5E3 + 0xE1\n"
    assert [found for _, found in _thresholds(text)] == ["1e-9", "0.001", "2.5E3"]


def test_no_other_module_of_the_engine_has_a_threshold():
    found = [
        f"{path.relative_to(ROOT)}:{line}: {number}"
        for folder in ENGINE
        for path in sorted((ROOT / folder).rglob("*.py"))
        for line, number in _thresholds(path.read_text())
    ]
    assert not found, "thresholds belong in eventpound/tolerances.py: " + ", ".join(found)


def test_each_has_a_reason_and_a_use():
    body = ast.parse(Path(tolerances.__file__).read_text()).body
    told = {
        before.targets[0].id
        for before, after in pairwise(body)
        if isinstance(before, ast.Assign)
        and isinstance(before.targets[0], ast.Name)
        and isinstance(after, ast.Expr)
    }
    assert told == set(NAMES)
    used = {
        alias.name
        for path in ROOT.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and node.module == "eventpound.tolerances"
        for alias in node.names
    }
    assert used | {"ATTAINED_ANEW", "EPS"} == set(NAMES)
