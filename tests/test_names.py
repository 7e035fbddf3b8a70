"""One meaning a name: a class or function stands for one thing in the whole package."""

import ast
from collections import defaultdict
from pathlib import Path

import eventpound

ROOT = Path(eventpound.__file__).parent
ALONE = "score/"
"""Travels without the package, so it has words of its own."""


def test_no_two_classes_have_one_name():
    places = defaultdict(list)
    for path in ROOT.rglob("*.py"):
        name = path.relative_to(ROOT).as_posix()
        if not name.startswith(ALONE):
            for node in ast.parse(path.read_text()).body:
                if isinstance(node, ast.ClassDef):
                    places[node.name].append(name)
    assert {name: found for name, found in places.items() if len(found) > 1} == {}


ENGINE = ("solvers", "contact", "mechanics", "numerics", "motion/forcing", "motion/loads")
"""Rooms of compiled kernels, which a new name compiles anew: names that are here twice are left."""
LEFT = {"number", "numbers_of"}
"""Of `eventpound.basics.given` and of one of these rooms; the list shrinks."""


def test_no_two_modules_have_a_public_function_of_one_name():
    places = defaultdict(set)
    for path in ROOT.rglob("*.py"):
        name = path.relative_to(ROOT).as_posix()
        if not name.startswith(ALONE):
            for node in ast.parse(path.read_text()).body:
                if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                    places[node.name].add(name)
    twice = {name: sorted(found) for name, found in places.items() if len(found) > 1}
    assert {n for n, f in twice.items() if not all(m.startswith(ENGINE) for m in f)} == LEFT


MOST_BY_POSITION = 12
"""Arguments that a reader still counts."""


def test_long_calls_name_their_arguments():
    for path in ROOT.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call):
                assert len(node.args) <= MOST_BY_POSITION, f"{path}:{node.lineno}"


SMALL = 100
"""Lines up to which a module is tested with what uses it."""
ONE_TABLE = "motion/readers"
"""Its modules are the rows of one table, which `test_reading` and `test_header` go through."""
WITHOUT = {
    "accuracy": "comparison_tables reference work_precision",
    "case": "case keys record_scaling scene_tables",
    "cli": "arguments folder fragility report score suite_run",
    "motion": "parametric swing",
    "problems": "page",
    "quantities": "listed runs",
    "report": "design_figures design_study design_tables many_appendix "
    "run_appendix study_curves study_figure study_files zoom",
    "results": "records",
    "scene": "ends equilibrium linkage",
    "score": "drawing page",
    "study": "precompile runs",
}
"""Larger modules outside the engine without a test of their name; the list shrinks."""


def test_tests_are_named_after_what_they_test():
    tests, without = Path(__file__).parent, defaultdict(list)
    for path in sorted(ROOT.rglob("*.py")):
        name, room = path.relative_to(ROOT).as_posix(), path.parent.relative_to(ROOT)
        large = len(path.read_text().splitlines()) > SMALL and room.as_posix() != ONE_TABLE
        asked = large and not path.stem.startswith("__") and not name.startswith(ENGINE)
        if asked and not (tests / room / f"test_{path.stem}.py").exists():
            without[room.as_posix().removeprefix(".")].append(path.stem)
    listed = {room: names.split() for room, names in WITHOUT.items()}
    assert listed == without, "a module wants a test of its name, or the list is too long"
