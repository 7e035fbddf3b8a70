"""One name, one thing: what the yardstick and its reports define."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import eventpound

ROOT = Path(eventpound.__file__).parent


def test_no_two_classes_have_one_name():
    files = [
        *(ROOT / "score").glob("*.py"),
        *(ROOT / "accuracy").glob("*.py"),
        *(ROOT / "problems").glob("*.py"),
    ]
    nodes = (node for file in files for node in ast.walk(ast.parse(file.read_text())))
    found = Counter(node.name for node in nodes if isinstance(node, ast.ClassDef))
    assert len(found) > 30
    assert [name for name, count in found.items() if count > 1] == []
