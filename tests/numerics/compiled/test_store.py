"""Kept kernels: damaged, out of date, in folders that cannot be written, made at once."""

import random
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from numba.core.registry import CPUDispatcher

from eventpound.numerics import compiled
from eventpound.numerics.compiled import sources, store
from tests.numerics.compiled.modules import imported, in_a_process, written


@pytest.fixture(autouse=True)
def says_anew():
    store.say_once.cache_clear()
    store.folders.cache_clear()
    yield
    store.folders.cache_clear()


@pytest.fixture
def kept(tmp_path):
    """A module of which one kernel is kept, and the kernel's file."""
    file = written(tmp_path)
    assert imported(file).doubled(1.5) == 3.0
    (path,) = (tmp_path / "__pycache__").glob("kernels.doubled-*.kernel")
    return file, path


def hits(module) -> int:
    return sum(module.doubled.stats.cache_hits.values())


def damages(content: bytes):
    """Contents of a damaged file: none, cut short, with one bit flipped, or of something else."""
    chance = random.Random(7)
    yield b""
    yield b"\0" * len(content)
    yield content + b"more"
    yield b"not a kernel at all, but a page of text"
    yield content[: chance.randrange(1, len(content))]
    for _ in range(3):
        place = chance.randrange(len(content))
        flipped = bytes([content[place] ^ 1 << chance.randrange(8)])
        yield content[:place] + flipped + content[place + 1 :]


def test_a_damaged_kernel_is_made_again(kept, capsys):
    file, path = kept
    content = path.read_bytes()
    for damaged in damages(content):
        path.write_bytes(damaged)
        store.say_once.cache_clear()
        module = imported(file)
        assert module.doubled(1.5) == 3.0
        assert hits(module) == 0
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert f"a kept kernel is damaged and is compiled again: {path.name}" in said
        healed = imported(file)
        assert healed.doubled(1.5) == 3.0
        assert hits(healed) == 1
        assert capsys.readouterr().err == ""


def test_the_kernel_of_another_function_is_not_taken(kept, tmp_path):
    """Its name is what tells what a file holds; nothing inside has to agree with another file."""
    file, path = kept
    imported(file).powers(2.0)
    (other,) = (tmp_path / "__pycache__").glob("kernels.powers-*.kernel")
    path.write_bytes(other.read_bytes())
    assert imported(file).doubled(1.5) == 3.0


def test_what_is_out_of_date_is_taken_away(kept):
    file, path = kept
    file.write_text(file.read_text().replace("2.0 * x", "4.0 * x"))
    store.source_stamp.cache_clear()
    sources._module.cache_clear()
    assert imported(file).doubled(1.5) == 6.0
    assert not path.exists()
    assert len(list(path.parent.glob("kernels.doubled-*"))) == 1


def test_a_kernel_that_takes_another_is_never_out_of_date(tmp_path, monkeypatch):
    """In Numba's own way one is told by where it lies, which another may do in the next process."""
    monkeypatch.setattr(compiled, "PLAIN", True)
    monkeypatch.setattr(CPUDispatcher, "__repr__", lambda self: "one of them, at the same address")
    files = [tmp_path / f"{name}.py" for name in ("taken", "takes")]
    files[1].write_text(
        "from eventpound.numerics.compiled import kernel\n\n\n"
        "@kernel\ndef applied(rule, x):\n    return rule(x)\n"
    )
    for factor in (2.0, 4.0):
        files[0].write_text(
            "from eventpound.numerics.compiled import kernel\n\n\n"
            f"@kernel\ndef rule(x):\n    return {factor} * x\n"
        )
        sources._module.cache_clear()
        sources.source_stamp.cache_clear()
        taken, takes = (imported(file, file.stem) for file in files)
        assert takes.applied(taken.rule, 1.5) == factor * 1.5


def test_kernels_beside_sources_that_cannot_be_written_are_used(kept, monkeypatch, tmp_path):
    file, path = kept
    monkeypatch.setattr(store, "write_whole", refuse_to_write)
    before = path.stat().st_mtime_ns
    module = imported(file)
    assert module.doubled(1.5) == 3.0
    assert hits(module) == 1
    assert path.stat().st_mtime_ns == before


def refuse_to_write(path: Path, content: bytes) -> None:
    raise OSError(28, "No space left on device")


@pytest.mark.skipif(compiled.PLAIN, reason="Numba loads in its own way here")
def test_a_new_process_loads_what_is_kept_and_nothing_to_compile_with(tmp_path):
    """Functions of Numba's runtime, secrets of hashes and errors are there all the same."""
    file = written(tmp_path)
    asked = (
        "print((powers(2.0).tolist(), hashed(3) - hash('word'), doubled(1.5)), "
        "'numba.np.linalg' in sys.modules), refused(4)"
    )
    made, kept = (in_a_process(file, asked) for _ in range(2))
    assert made.stdout == "([2.0, 4.0, 8.0, 2.0], 3, 3.0) True\n"
    assert kept.stdout == made.stdout.replace("True", "False")
    assert made.stderr == kept.stderr
    assert "more than three" in kept.stderr


def test_a_full_disk_costs_a_warning(tmp_path, monkeypatch, capsys):
    module = imported(written(tmp_path))
    monkeypatch.setattr(store, "write_whole", refuse_to_write)
    assert module.doubled(1.5) == 3.0
    assert module.powers(2.0)[2] == 8.0
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "warning: kernels cannot be kept" in said
    assert "No space left on device" in said


def test_a_folder_that_cannot_be_written_leaves_it_to_the_users(tmp_path, monkeypatch):
    file = written(tmp_path)
    users = tmp_path / "users"
    monkeypatch.setattr(store, "folders", lambda _: (tmp_path / "kernels.py", users))
    assert imported(file).doubled(1.5) == 3.0
    (made,) = users.glob("kernels.doubled-*.kernel")
    module = imported(file)
    assert module.doubled(1.5) == 3.0
    assert hits(module) == 1
    assert made.exists()


def test_processes_that_compile_at_once(tmp_path):
    file = written(tmp_path)
    with ThreadPoolExecutor(2) as pool:
        made = list(pool.map(lambda _: in_a_process(file, "doubled(1.5)"), range(2)))
    assert [(done.stdout, done.stderr) for done in made] == [("3.0\n", "")] * 2
    assert len(list((tmp_path / "__pycache__").glob("kernels.doubled-*.kernel"))) == 1
    assert not list((tmp_path / "__pycache__").glob(".kernel-*"))


def test_a_process_that_is_killed_leaves_no_half_kernel(kept):
    """A file is written beside its place and moved there whole."""
    file, path = kept
    path.unlink()
    ends = "setattr(__import__('os'), 'replace', lambda *_: __import__('os')._exit(9))"
    assert in_a_process(file, f"[{ends}, doubled(1.5)]").returncode == 9
    assert not path.exists()
    assert imported(file).doubled(1.5) == 3.0
