"""How many modules know the constants of a spring with a memory: what a new law would touch."""

import ast
from pathlib import Path

import eventpound

ROOT = Path(eventpound.__file__).parent
CONSTANTS = {"strength", "yield_displacement", "exponent", "beta", "gamma"}
OTHERS = {
    # Modules in which such a word means something else.
    "accuracy/bound.py",
    "accuracy/conditioning.py",
    "accuracy/work_precision.py",
    "cli/fragility.py",
    "mechanics/series.py",
    "motion/mavroeidis_papageorgiou.py",
    "motion/pulse_fit.py",
    "motion/readers/beside_samples.py",
    "motion/readers/header.py",
    "numerics/polynomial.py",
    "report/study_curves.py",
    "report/suite_plot.py",
    "results/records.py",
    "solvers/events/short_series.py",
    "study/fragility.py",
    "study/suite_statistics.py",
}
# Of the yardstick two, since it stands in modules; scene/at_rest has every law's tangent.
MOST, MOST_IN_SOLVERS = 26, 8
KINDS = {"BOUC_WEN", "BACKFILL", "YIELDING_SOIL", "SLIDER", "DEGRADING", "ITS_ENERGY"}


def _names(path: Path) -> set[str]:
    """Names, arguments, attributes and texts of a module."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        own = [getattr(node, key, None) for key in ("id", "attr", "arg", "name", "value")]
        found |= {name for name in own if isinstance(name, str)}
    return found


def test_few_modules_name_a_constant_of_a_law_with_a_memory():
    naming = {
        path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*.py") if _names(path) & CONSTANTS
    }
    assert naming >= OTHERS
    naming -= OTHERS
    assert len(naming) <= MOST, sorted(naming)
    inside = {name for name in naming if name.startswith(("solvers/", "mechanics/"))}
    assert len(inside) <= MOST_IN_SOLVERS, sorted(inside)


def test_the_fast_solver_tells_no_law_with_a_memory_itself():
    table = {path.name for path in (ROOT / "mechanics").glob("*.py") if _names(path) & KINDS}
    assert {"elements.py", "link_law.py"} <= table
    for path in (ROOT / "solvers" / "fast").rglob("*.py"):
        assert not _names(path) & KINDS, path
