"""Python on the pages passes mypy --strict, as somebody would write it who checks types."""

import json
import os
import re
import subprocess
import sys

import pytest

from tests.models import ROOT

DOCS = ROOT / "docs"


def shown() -> dict[str, str]:
    """Python of each page, by a name for a module of it."""
    pages = {page.stem: page.read_text(encoding="utf-8") for page in sorted(DOCS.rglob("*.md"))}
    pages["readme"] = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = {
        name: re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
        for name, text in pages.items()
    }
    for path in sorted((DOCS / "notebooks").glob("*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        blocks[f"notebook-{path.stem}"] = code
    return {name: "\n".join(found) for name, found in blocks.items() if found}


def test_pages_with_python_are_found():
    assert {"readme", "python", "many", "studies", "notebook-bridge"} <= set(shown())


@pytest.mark.pages
def test_what_pages_show_has_the_types_that_it_says(tmp_path):
    for name, text in shown().items():
        (tmp_path / f"{name.replace('-', '_')}_page.py").write_text(text, encoding="utf-8")
    run = subprocess.run(
        [
            sys.executable,
            "-m",
            "mypy",
            "--strict",
            "--config-file",
            str(ROOT / "pyproject.toml"),
            "--cache-dir",
            str(ROOT / ".mypy_cache"),
            *map(str, tmp_path.glob("*.py")),
        ],
        env={**os.environ, "MYPYPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout + run.stderr
