"""A size that is a million times too large or too small is refused or doubted, whatever its key."""

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from eventpound.case.loading import read_case
from eventpound.errors import InputError

DECK, OTHER = {"between": ["ground", "deck"]}, {"between": ["ground", "other"]}
CASE: dict[str, Any] = {
    "excitation": {"kind": "mavroeidis-papageorgiou", "amplitude": 3.0, "period": 0.8,
                   "gamma": 2.0, "phase": 1.0, "start": 0.5},
    "body": [
        {"name": "deck", "mass": 4e5, "initial": {"displacement": 0.01, "velocity": 0.1}},
        {"name": "other", "mass": 8e5},
    ],
    "spring": [
        {**DECK, "name": "piers", "law": "degrading-bouc-wen", "stiffness": 4e6, "strength": 5e5,
         "yield_displacement": 0.02, "exponent": 2.0, "beta": 0.4, "gamma": 0.6, "height": 6.0,
         "strength_degradation": 0.05, "stiffness_degradation": 0.05, "initial_loss": 2.0},
        {**OTHER, "name": "frame", "law": "linear", "stiffness": 2e7},
        {"between": ["pier2", "other"], "name": "stop", "law": "bilinear-elastic",
         "compression": 3e7, "extension": 5e7, "offset": 0.05},
        {**DECK, "name": "soil", "law": "backfill", "initial_stiffness": 2e8,
         "ultimate_force": 2e6, "failure_ratio": 0.8, "gap": 0.02, "initial_gap": 0.03},
        {**DECK, "name": "wall", "law": "backfill", "wall_height": 1.7, "wall_width": 8.0},
        {**OTHER, "name": "bearing", "law": "slider", "friction": 0.05, "normal_force": 4e6,
         "stiffness": 1e6},
    ],
    "dashpot": [{**DECK, "ratio": 0.05, "refers_to": 6.0}],
    "contact": [{"between": ["deck", "other"], "name": "joint", "gap": 0.05,
                 "law": "kelvin-voigt", "stiffness": 1e9, "damping": 0.2}],
    "support": [{"name": "pier2", "delay": 0.1}],
    "force": [{"body": "deck", "kind": "sine", "amplitude": 1e5, "period": 2.0}],
    "run": {"start_time": 0.1, "duration": 20.0, "threshold_speed": 0.01},
}  # fmt: skip


NOTHING = {
    *(("body", 0, "initial", key) for key in ("displacement", "velocity")),
    ("excitation", "phase"),
    ("spring", 0, "stiffness"),
    ("spring", 2, "compression"),
    ("spring", 2, "extension"),
    ("dashpot", 0, "refers_to"),
}
"""What is as good as zero where it is small, and may be zero."""


def places(found: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(found, dict | list):
        items = found.items() if isinstance(found, dict) else enumerate(found)
        for key, value in items:
            yield from places(value, (*path, key))
    elif isinstance(found, float):
        yield path


def warned(path: tuple[Any, ...], times: float) -> list[str]:
    """Warnings of the case with one number of another size; a refusal is one, too."""
    case = copy.deepcopy(CASE)
    at = case
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] *= times
    try:
        return [*read_case(case, Path("case.toml")).warnings]
    except InputError as error:
        return [*error.problems]


def test_the_case_itself_is_usual():
    assert warned(("run", "duration"), 1.0) == []


@pytest.mark.parametrize("times", [1e6, 1e-6])
@pytest.mark.parametrize("path", [*places(CASE)], ids=lambda p: ".".join(map(str, p)))
def test_no_number_is_accepted_without_a_word(path, times):
    assert (warned(path, times) != []) == (times > 1.0 or path not in NOTHING)


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (("spring", 5, "friction"), 6.0, "'bearing': friction = 6; usual is from 0.001 to 1.5"),
        (("spring", 4, "wall_width"), 1e4, "wall_width = 1e+04 m; usual is from 1 to 100 m"),
        (("spring", 0, "strength_degradation"), 500.0, "strength_degradation = 500; usual is"),
        (("dashpot", 0, "ratio"), 5e-4, "[[dashpot]] 1: ratio = 0.0005; usual is from 0.001"),
    ],
)
def test_the_sentence_names_number_range_and_reason(path, value, said):
    at = CASE
    for key in path:
        at = at[key]
    found = warned(path, value / at)
    assert any(said in text for text in found)


def test_a_support_on_which_nothing_stands():
    case = copy.deepcopy(CASE)
    case["support"].append({"name": "pier3", "delay": 0.2})
    (found,) = read_case(case, Path("case.toml")).warnings
    assert found == "case.toml: support 'pier3': nothing stands on it"


@pytest.mark.parametrize("of_mass", [None, ["deck", "other"], "500 t"])
def test_a_normal_force_by_a_weight(of_mass):
    """W is the weight of the body, or of the mass that is named: as of a yield force."""
    case = copy.deepcopy(CASE)
    slider = case["spring"][5] | {"normal_force": "1.5 W"}
    case["spring"][5] = slider | ({} if of_mass is None else {"of_mass": of_mass})
    law: Any = read_case(case, Path("case.toml")).scene.springs[5].law
    mass = {None: 8e5, "500 t": 5e5}.get(of_mass if isinstance(of_mass, str) else None, 8e5)
    mass = 1.2e6 if isinstance(of_mass, list) else mass
    assert law.normal_force == pytest.approx(1.5 * mass * 9.80665, rel=1e-15)


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (("spring", 5, "normal_force"), "500 t", "it has a mass for a force: write kN, or tf"),
        (("spring", 1, "stiffness"), "500 t/m", "it has a mass for a force: write kN, or tf"),
        (("spring", 2, "extension"), -1e6, "a stiffness >= 0 (N/m); P-Delta is weight and hei"),
        (("body", 0, "source"), "drawing\0 B", "accepted: where its numbers are from, no contr"),
        (("title",), "a\x1b[31mbridge", "title: found 'a\\x1b[31mbridge'; accepted: some text, no"),
    ],
)
def test_what_is_refused_is_answered(path, value, said):
    case = copy.deepcopy(CASE)
    at = case
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    with pytest.raises(InputError) as caught:
        read_case(case, Path("case.toml"))
    assert said in str(caught.value)
