"""Kernels that an installation came with: used where they fit, and each reason why not."""

import json
import platform
from pathlib import Path

import llvmlite.binding as llvm
import pytest
from numba import config

from eventpound.numerics.compiled import PLAIN, shipped, sources, store
from tests.numerics.compiled.modules import imported, in_a_process, written
from tests.numerics.compiled.test_store import hits

pytestmark = pytest.mark.skipif(PLAIN, reason="Numba compiles in its own way here")


def forget() -> None:
    """What a new process would not know."""
    remembered = (shipped.made, shipped.misfit, store.say_once, store.folders)
    for each in (*remembered, sources.source_stamp, sources._module):
        each.cache_clear()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with a module, and the kernel that another process made of it."""
    folder = tmp_path_factory.mktemp("made")
    processor = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    done = in_a_process(written(folder), "doubled(1.5)", folder / "kept", **processor)
    assert done.stdout == "3.0\n"
    return folder


@pytest.fixture
def module(made, tmp_path, monkeypatch):
    """The file of a module whose kernels the installation came with."""
    file = written(tmp_path)
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "kernels")
    monkeypatch.setattr(shipped, "CLASSES", {"generic": ()})
    assert shipped.ship(made / "kept", "generic") == 1
    forget()
    yield file
    forget()


def kept_beside(file: Path) -> list[Path]:
    return list((file.parent / "__pycache__").glob("*.kernel"))


def test_they_are_used_where_they_fit(module, capsys):
    found = imported(module)
    assert found.doubled(1.5) == 3.0
    assert hits(found) == 1
    assert kept_beside(module) == []
    assert capsys.readouterr().err == ""


def test_what_is_not_among_them_is_compiled_without_a_word(module, capsys):
    found = imported(module)
    assert found.powers(2.0)[2] == 8.0
    assert len(kept_beside(module)) == 1
    assert capsys.readouterr().err == ""


def listed(**changed: object) -> None:
    """Change the list of what they were made by."""
    path = shipped.FOLDER / "made.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | changed))


def refused(file: Path, reason: str, capsys: pytest.CaptureFixture[str], answer: float) -> None:
    """They are not used, which is said once; what is compiled is kept, and used then."""
    forget()
    found = imported(file)
    assert found.doubled(1.5) == answer
    assert found.powers(2.0)[2] == 8.0
    assert hits(found) == 0
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert reason in said
    forget()
    again = imported(file)
    assert again.doubled(1.5) == answer
    assert hits(again) == 1
    assert capsys.readouterr().err == ""


def test_changed_sources_refuse_them(module, capsys):
    module.write_text(module.read_text().replace("2.0 * x", "14.0 * x"))
    refused(module, "sources were changed", capsys, 21.0)


def test_other_versions_refuse_them(module, capsys, monkeypatch):
    monkeypatch.setattr(shipped, "VERSIONS", "cpython-311 numba 0.99.0 llvm 0.99.0")
    refused(module, "here is cpython-311 numba 0.99.0 llvm 0.99.0", capsys, 3.0)


def test_a_processor_without_a_feature_refuses_them(module, capsys):
    listed(features=["a-feature-of-the-future"])
    refused(module, "the processor lacks a-feature-of-the-future", capsys, 3.0)


def test_a_processor_that_numba_is_told_refuses_them(module, capsys, monkeypatch):
    monkeypatch.setattr(config, "CPU_NAME", "generic")
    refused(module, "NUMBA_CPU_NAME or NUMBA_CPU_FEATURES is set", capsys, 3.0)


def test_a_list_that_cannot_be_read_refuses_them(module, capsys):
    (shipped.FOLDER / "made.json").write_text("{")
    refused(module, "a list that cannot be read", capsys, 3.0)


def test_a_damaged_one_is_refused_and_left(module, capsys):
    (path,) = shipped.FOLDER.glob("*.kernel")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    refused(module, f"damaged and is compiled again: {path.name}", capsys, 3.0)
    assert path.read_bytes() == content


@pytest.mark.skipif(platform.machine() != "x86_64", reason="classes of x86-64")
def test_what_a_class_must_have_is_called_as_llvm_does():
    known = set(llvm.get_host_cpu_features())
    for features in shipped.CLASSES.values():
        assert set(features) <= known
