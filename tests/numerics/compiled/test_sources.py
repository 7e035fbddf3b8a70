"""Compiled code is used as long as no source of it has changed, and no longer."""

from __future__ import annotations

from pathlib import Path

import pytest

from eventpound.numerics.compiled import sources
from eventpound.numerics.compiled.sources import source_stamp
from eventpound.solvers.fast import step

MODULES = {
    "solvers/__init__.py": "",
    "solvers/step.py": "from eventpound.mechanics.law import (\n    force,\n)\n",
    "mechanics/law.py": "from eventpound import numbers\nfrom eventpound.mechanics import other\n",
    "mechanics/other.py": "from eventpound.solvers.step import round_about\n",
    "numbers.py": "TWO = 2.0\n",
    "results.py": "from eventpound.solvers.step import advance\n",
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package of another name's place, of which `step` imports all but `results`."""
    for name, text in MODULES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(sources, "PACKAGE", str(tmp_path))
    return tmp_path


def stamp_of(package: Path) -> str:
    sources._text_and_imports.cache_clear()
    source_stamp.cache_clear()
    return source_stamp(str(package / "solvers/step.py"))


def change(package: Path, name: str) -> None:
    (package / name).write_text(MODULES[name] + "# changed\n")


@pytest.mark.parametrize(
    "changed", ["solvers/step.py", "mechanics/law.py", "mechanics/other.py", "numbers.py"]
)
def test_stamp_changes_with_whatever_is_imported(package, changed):
    before = stamp_of(package)
    change(package, changed)
    assert stamp_of(package) != before


def test_stamp_is_the_same_when_others_change(package):
    before = stamp_of(package)
    change(package, "results.py")
    assert stamp_of(package) == before


def test_the_stamp_takes_in_what_is_imported_from_other_folders():
    """Of the package as it is, not of one made for the test."""
    from eventpound.mechanics import impact

    reached = sources._text_and_imports(str(step.__file__))[1]
    assert sources._text_and_imports(str(impact.__file__))[1]
    package = Path(sources.PACKAGE)
    assert (package / "units.py").is_file()
    assert {
        str(package / "contact/cascade.py"),
        str(package / "solvers/fast/compiled.py"),
    } <= reached
    below = sources._text_and_imports(str(package / "solvers/fast/compiled.py"))[1]
    assert str(package / "numerics/compiled/__init__.py") in below
