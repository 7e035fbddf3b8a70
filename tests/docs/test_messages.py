"""The messages that docs/messages.md explains are those of the package."""

import ast
import re

from tests.models import ROOT


def pieces() -> str:
    """Every constant text of the package, formatted values between them left out."""
    found = [
        str(node.value)
        for file in (ROOT / "eventpound").rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    return "\n".join(found)


def test_they_are_said():
    page = (ROOT / "docs" / "messages.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)
    told = [said for row in rows for said in re.findall(r"`([^`]+)`", row)]
    assert len(told) >= 20
    said_somewhere = pieces()
    parts = [part.strip() for said in told for part in said.split("…")]
    assert [part for part in parts if part not in said_somewhere] == []
