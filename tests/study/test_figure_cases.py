"""The studies among the cases: each can be read, is fine enough, and its runs succeed."""

import functools
import tomllib

import numpy as np
import pytest

from eventpound.study.plan import Chunk
from eventpound.study.reading import load_study
from eventpound.study.table import compute
from tests.models import CASES

FOLDER = CASES
NAMES = [
    file.parent.name
    for file in sorted(FOLDER.glob("*/case.toml"))
    if {"study", "figure"} <= tomllib.loads(file.read_text(encoding="utf-8")).keys()
]
OF_THE_PAPER = [name for name in NAMES if name not in ("contact-laws", "skew-map")]


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_it_says_what_it_shows_and_what_the_paper_leaves_open(name):
    comments = [
        line
        for line in (FOLDER / name / "case.toml").read_text(encoding="utf-8").splitlines()
        if line.startswith("#")
    ]
    assert any("From the paper:" in line for line in comments)
    assert any("Our choice" in line for line in comments)


@functools.cache
def loaded(name):
    return load_study(FOLDER / name)


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_its_curves_are_smooth(name):
    """At least 200 points along the horizontal axis."""
    case = loaded(name)
    assert case.figures
    assert case.warnings == ()
    drawn = {x for plan in case.figures for x in plan.x}
    for base in case.study.bases:
        assert max(a.values.size for a in base.axes if a.key in drawn or a.key[:3] == "pi.") >= 200


@pytest.mark.parametrize("name", NAMES)
def test_runs_drawn_at_random_succeed(name):
    study = loaded(name).study
    rng = np.random.default_rng(4)
    for base in rng.choice(len(study.bases), min(3, len(study.bases)), replace=False).tolist():
        size = study.bases[base].size
        low = int(rng.integers(0, max(size - 1, 1)))
        rows = compute(study, Chunk(0, base, low, min(low + 2, size))).decode().splitlines()
        assert all(row.endswith(",True,") for row in rows)
