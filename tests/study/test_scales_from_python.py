"""Records that are scaled by much are told to a call in Python, too: once, in one line."""

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from eventpound import (
    Body,
    Case,
    Linear,
    Record,
    Scene,
    Spring,
    Study,
    design_numbers,
    load_case,
    simulate_suite,
)
from tests.study.test_suite import CASE, time_series

READ = 'units = "g"\ntime_step = "0.02 s"\n'
LEVELS = {"excitation.pga": ["0.1 g", "1.5 g", "2 g"]}


def folder(tmp_path: Path, excitation: str) -> Case:
    for name, amplitude in (("a", 0.02), ("b", 0.2), ("c", 0.5)):
        (tmp_path / f"{name}.txt").write_text(time_series(amplitude))
    (tmp_path / "case.toml").write_text(CASE.format(READ + excitation))
    return load_case(tmp_path)


def said(call: Callable[[], object]) -> list[str]:
    """What a call warns of, told at the line of the caller."""
    with warnings.catch_warnings(record=True, action="always") as caught:
        call()
    assert {each.filename for each in caught} <= {__file__}
    return [str(each.message) for each in caught]


@pytest.mark.parametrize("way", ["pga = 12", 'target = [[0.1, "3 g"], [2.0, "3 g"]]'])
def test_a_suite_names_its_records(tmp_path, way):
    between = '\ntarget_periods = ["0.2 s", "1 s"]' if "target" in way else ""
    case = folder(tmp_path, f'suite = "?.txt"\n{way}{between}')
    scale = simulate_suite(
        folder(tmp_path, f'suite = "?.txt"\n{way}{between}\nlargest_scale = 1e9')
    )
    over = scale[scale["scale"] > 4.0]
    assert len(over) == 2
    for call in (lambda: simulate_suite(case), lambda: design_numbers(case)):
        (text,) = said(call)
        assert text.startswith("2 of 3 records are scaled by more than 4 (largest_scale")
        for name, factor in zip(over["record"], over["scale"], strict=True):
            assert f"{name} times {factor:.3g}" in text
        assert "\n" not in text


def test_a_study_of_intensities_says_it_once(tmp_path):
    case = folder(tmp_path, 'suite = "?.txt"\npga = 1')
    study = Study(case, LEVELS, quantities=["peaks.deck.abs_max"])
    for call in (study.run, lambda: design_numbers(study)):
        (text,) = said(call)
        assert text.startswith("6 of 9 runs scale their record by more than 4")


def test_of_one_record_its_file_is_named(tmp_path):
    case = folder(tmp_path, 'file = "b.txt"\npga = 1')
    (text,) = said(Study(case, LEVELS).run)
    assert text.startswith("2 of 3 runs scale their record by more than 4")
    assert "b.txt times " in text


def test_what_is_within_the_limit_is_not_told(tmp_path):
    case = folder(tmp_path, 'suite = "?.txt"\npga = 12\nlargest_scale = 1e4')
    assert said(lambda: simulate_suite(case)) == []
    assert said(lambda: Study(case, LEVELS).run()) == []


def test_a_scene_made_in_python_has_the_usual_limit():
    wave = np.sin(7.0 * np.arange(0.0, 4.0, 0.02))
    deck, spring = Body("deck", 1e6), Spring("pier", ("ground", "deck"), Linear(4e7))
    scene = Scene([deck], [spring], motion=Record(wave, 0.02, scale=9.0))
    (text,) = said(lambda: Study(scene, {"body.deck.mass": [1e6, 2e6]}, duration=1.0).run())
    assert text.startswith("2 of 2 runs scale their record by more than 4 (largest_scale")
    assert text.endswith(": the record times 9")
