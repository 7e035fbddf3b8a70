"""Compiled code is used as long as no source of it has changed, and no longer."""

import io
from pathlib import Path

import pytest

from eventpound.numerics.compiled import sources, store
from eventpound.numerics.compiled.sources import source_stamp
from eventpound.solvers.fast import step
from tests.numerics.compiled.modules import in_a_process, written

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
    sources._module.cache_clear()
    source_stamp.cache_clear()
    return source_stamp(str(package / "solvers/step.py"))


def change(package: Path, name: str, added: str = "NEW = 1\n") -> None:
    (package / name).write_text(MODULES[name] + added)


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


@pytest.mark.parametrize(
    "added", ["# changed\n", "\n\n", '"""What TWO is."""\n', "r'Of two'  # and more"]
)
def test_stamp_is_the_same_whatever_comments_say(package, added):
    before = stamp_of(package)
    change(package, "numbers.py", added)
    assert stamp_of(package) == before


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (b"x = (\n    1,\n    '''a'''\n)\n", b"x = (\n    1,\n    '''b'''\n)\n"),
        (b"if a:\n    b\nc\n", b"if a:\n    b\n    c\n"),
        (b"x = '# a'\n", b"x = '# b'\n"),
        (b"x = 1\ny\n", b"x = 1; y\n"),
        (b"'a'.b\n", b"'c'.b\n"),
    ],
)
def test_whatever_python_reads_is_told_apart(one, other):
    assert sources.code_of(one) != sources.code_of(other)


@pytest.mark.parametrize("content", ["{", "[1]", '{"by": "others", "a": "b"}', '{"a": ', ""])
def test_a_list_that_cannot_be_read_is_made_anew(package, tmp_path, monkeypatch, content):
    monkeypatch.setattr(sources, "folders", lambda _: (tmp_path,))
    sources._listed.cache_clear()
    before = stamp_of(package)
    kept = (tmp_path / "sources.json").read_text()
    (tmp_path / "sources.json").write_text(content)
    sources._listed.cache_clear()
    assert stamp_of(package) == before
    assert (tmp_path / "sources.json").read_text() == kept
    sources._listed.cache_clear()


def test_machine_code_knows_nothing_of_comments(tmp_path):
    """Kept where NUMBA_CACHE_DIR says, and nowhere else."""
    file = written(tmp_path)
    plain = file.read_text()
    told = plain.replace("(x):\n", "(x):\n    '''Of x.\n\n    A number.'''\n    # so\n\n")
    assert told.count("A number") == 3
    contents = []
    for text in (plain, f"# First\n\n{told}"):
        file.write_text(text)
        done = in_a_process(file, "doubled(1.5), powers(1.5)", tmp_path / "kept")
        assert done.stderr == ""
        paths = sorted((tmp_path / "kept").rglob("kernels.*.kernel"))
        assert len(paths) == 2
        for path in paths:
            whole = store._checked(path.read_bytes(), path.name)
            library, *_ = store._Reader(io.BytesIO(whole)).load()
            contents.append((path.name, library))
            path.unlink()
    assert contents[:2] == contents[2:]
    assert not list((tmp_path / "__pycache__").glob("*.kernel"))


def test_the_stamp_takes_in_what_is_imported_from_other_folders():
    """Of the package as it is, not of one made for the test."""
    from eventpound.mechanics import impact

    reached = sources._module(str(step.__file__)).imports
    assert sources._module(str(impact.__file__)).imports
    package = Path(sources.PACKAGE)
    assert (package / "units.py").is_file()
    assert {
        str(package / "contact/cascade.py"),
        str(package / "solvers/fast/compiled.py"),
    } <= reached
    below = sources._module(str(package / "solvers/fast/compiled.py")).imports
    assert str(package / "numerics/compiled/__init__.py") in below
