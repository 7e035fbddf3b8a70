"""Where the checkout is, for tests of every room."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
CASES = ROOT / "cases"
DOCS = ROOT / "docs"
