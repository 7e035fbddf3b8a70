"""Names that lead elsewhere, files that are none or do not end, patterns, suites cut short."""

import csv
import json
import os
import resource
import shutil
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import eventpound.basics.input_files
import eventpound.results.files
import eventpound.study.engine
import eventpound.study.suite
from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.results import write_together
from eventpound.simulation import ReadyScene
from eventpound.study.table import read_suite
from tests.cli.test_hostile import DECK, ENDLESS
from tests.motion.readers.writers import at2, motion

STUDY = """\
[excitation]
kind = "sine"
[pi]
structure = "elastic"
epsilon = 0.7
periods = 4
delta = 0.5
[study]
[[study.axis]]
key = "pi.omega_s"
values = [0.5, 1.0, 2.0]
[figure]
name = "{figure}"
x = "pi.omega_s"
y = "pi_um"
pages = "{pages}"
[intensity]
name = "{intensity}"
measure = "pi.omega_s"
demand = "pi_um"
records = "run"
"""
SUITE = '[excitation]\nkind = "record"\n{read}\n' + DECK
OF_RECORD = SUITE.format(read='file = "records/0.AT2"')
OUTSIDE = ["../evil", "/../../evil", "/tmp/evil", "a/b", "..", ".hidden", "a\\u0000b", "a\\nb", " "]


def files_below(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("key", ["figure", "intensity"])
@pytest.mark.parametrize("name", [*OUTSIDE, "x" * 300])
def test_figures_stay_in_their_directory(name, key, tmp_path, capsys):
    """The name of a figure was the name of a file, wherever that was."""
    folder = tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    names = {"figure": "study", "intensity": "intensity", "pages": "pi.omega_s"} | {key: name}
    (folder / "case.toml").write_text(STUDY.format(**names))
    assert main(["study", str(folder)]) == 2
    assert f"[{key}]: name: found" in capsys.readouterr().err
    assert files_below(tmp_path) == {"a/b/case.toml"}


@pytest.mark.parametrize("name", ["../a", "/tmp/a", "a/b", "..", "a\0b", ""])
def test_no_set_leaves_its_directory(name, tmp_path):
    with pytest.raises(InputError, match="is no name of a file in this directory"):
        write_together(tmp_path / "results", {"sound": b"1", name: b"2"})
    assert files_below(tmp_path) == set()


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("../../etc/passwd", "-..-etc-passwd"),
        ("a b\tc\0d\x1b[31m", "a-b-c-d-31m"),
        ("RSN1_EL+CENTRO.AT2", "RSN1_EL+CENTRO.AT2"),
        ("é" * 300, "é" * 100),
        ("...", ""),
    ],
)
def test_plain_names(text, plain):
    assert eventpound.results.files.plain_name(text) == plain


def test_a_component_that_is_a_path(tmp_path):
    """The component is part of the name of a record's figure."""
    rows = ["t EW/../../../evil N\x00S"]
    rows += [f"{0.1 * i:.1f} {(-1) ** i * 0.1:.2f} {0.02 * (i % 3):.2f}" for i in range(60)]
    record = tmp_path / "in" / "r.txt"
    record.parent.mkdir()
    record.write_text("\n".join(rows))
    out = tmp_path / "deep" / "out"
    ended = main(["records", str(record), "--units", "g", "--out", str(out)])
    assert ended in (0, 2)
    assert all(name.startswith(("in/", "deep/out/")) for name in files_below(tmp_path))


@pytest.mark.parametrize(
    "dollars",
    [
        *("x $\\\\undefined{ $ y", "$$", 5000 * "d"),
        *(pytest.param(name, marks=pytest.mark.sweep) for name in ("a $b", "$", "$x^2$", "50 $_$")),
    ],
)
def test_odd_names_are_drawn(dollars, tmp_path):
    """What matplotlib takes for a formula and cannot read, or has no room for."""
    text = ENDLESS.format(duration=1, avoiding_gap="false")
    for word in ("longer than anybody waits", '"deck"', '"piers"', '"joint"'):
        text = text.replace(word, word[: word.startswith('"')] + dollars + word[-1:].strip("s"))
    (tmp_path / "case.toml").write_text(text)
    assert main(["run", str(tmp_path)]) == 0
    assert (tmp_path / "results" / "displacements.png").stat().st_size > 10_000


@pytest.mark.parametrize("command", ["records", "check", "run", "study", "verify"])
@pytest.mark.parametrize("place", ["/dev/zero", "pipe"])
def test_devices_and_pipes(place, command, tmp_path, capsys):
    """They have no end."""
    if place == "pipe":
        os.mkfifo(tmp_path / "pipe")
        place = str(tmp_path / "pipe")
    assert main([command, place]) == 2
    assert "a device or a pipe" in capsys.readouterr().err


def test_a_list_that_is_a_device(tmp_path, capsys):
    (tmp_path / "list.csv").symlink_to("/dev/zero")
    assert main(["records", str(tmp_path), "--list", str(tmp_path / "list.csv")]) == 2
    assert "a device or a pipe" in capsys.readouterr().err


def test_files_without_end(tmp_path, capsys):
    """A file with holes, of more gigabytes than there is memory."""
    for name in ("case.toml", "record.txt"):
        with (tmp_path / name).open("wb") as file:
            file.truncate(2**40)
    assert main(["check", str(tmp_path)]) == 2
    assert main(["records", str(tmp_path / "record.txt")]) == 2
    assert capsys.readouterr().err.count("is larger than") == 2


def suite(folder: Path, pattern: str, records: int = 3) -> Path:
    (folder / "records").mkdir()
    for number in range(records):
        text = at2(motion(60, 0.1, seed=number), 0.1).text
        (folder / "records" / f"{number}.AT2").write_text(text)
    (folder / "case.toml").write_text(SUITE.format(read=f'suite = "{pattern}"'))
    return folder / "results"


@pytest.mark.parametrize("pattern", ["/**/*", "/**", "/**/*.AT2", "../" * 40 + "**/*", "//**/*"])
@pytest.mark.parametrize("command", ["check", "run"])
def test_a_pattern_of_the_whole_disk(command, pattern, tmp_path, capsys):
    results = suite(tmp_path, pattern)
    assert main([command, str(tmp_path)]) == 2
    assert "goes through the whole disk" in capsys.readouterr().err
    assert not results.exists()


def test_a_pattern_of_too_many_files(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(eventpound.basics.input_files, "MOST_MATCHES", 2)
    suite(tmp_path, "records/*")
    assert main(["run", str(tmp_path)]) == 2
    assert "matches more than 2 files" in capsys.readouterr().err


@pytest.mark.parametrize("key", ["seed", "first", "count"])
def test_synthetic_motions_without_number(key, tmp_path, capsys):
    text = SUITE.format(read=f"synthetic = {{ {key} = 9223372036854775808 }}")
    (tmp_path / "case.toml").write_text(text)
    assert main(["check", str(tmp_path)]) == 2
    assert "a whole number from 1 to" in capsys.readouterr().err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_suite_that_is_stopped_keeps_its_rows(number, tmp_path, monkeypatch, capsys, undrawn):
    results = suite(tmp_path, "records/*", records=8)
    run = ReadyScene.run
    begun = []

    def third_stops(*words: object, **options: object) -> object:
        begun.append(words)
        if len(begun) == 3:
            os.kill(os.getpid(), number)
        return run(*words, **options)

    monkeypatch.setattr(ReadyScene, "run", third_stops)
    assert main(["run", str(tmp_path), "--solver", "cvode"]) == 130
    monkeypatch.undo()
    table, manifest = read_suite(results)
    assert 2 <= len(table) < 8
    assert manifest["complete"] is False
    assert (manifest["records"], manifest["records_of_suite"]) == (len(table), 8)
    assert (table["failed"] == "").all()
    err = capsys.readouterr().err
    assert f"{len(table)} of 8 records" in err
    assert main(["plot", str(tmp_path)]) == 0
    assert f"{len(table)} of 8 records" in capsys.readouterr().err
    # It goes on, and the rows are those of the whole suite.
    again: list[object] = []

    def counted(*words: object, **options: object) -> object:
        again.append(words)
        return run(*words, **options)

    monkeypatch.setattr(ReadyScene, "run", counted)
    assert main(["run", str(tmp_path), "--solver", "cvode"]) == 0
    assert len(again) == 8 - len(table)
    whole, manifest = read_suite(results)
    assert manifest["complete"] is True
    peaks = "peaks.deck.abs_max"
    assert table[peaks].tolist() == whole[peaks].iloc[: len(table)].tolist()


def test_a_suite_that_is_stopped_at_once_writes_nothing(tmp_path, monkeypatch, capsys):
    results = suite(tmp_path, "records/*")

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(eventpound.study.engine, "compute", stop)
    assert main(["run", str(tmp_path)]) == 130
    assert files_below(results) == set()
    assert "0 of 3 records were done" in capsys.readouterr().err


NOBODY = 65534


@contextmanager
def as_nobody() -> Iterator[None]:
    """Root may do anything; nobody only what is open to all."""
    os.setegid(NOBODY)
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)
        os.setegid(0)


@pytest.fixture
def open_folder():
    """A folder with a case that anybody may enter and read, which those of pytest are not."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        suite(folder, "records/*")
        (folder / "case.toml").write_text(OF_RECORD)
        yield folder


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may become nobody")
@pytest.mark.parametrize(
    ("closed", "mode", "words"),
    [
        ("results", 0o755, "results: cannot be written to: Permission denied"),
        ("results", 0o000, "results: cannot be written to: Permission denied"),
        (".", 0o755, "results: cannot be written to: Permission denied"),
        ("case.toml", 0o600, "case.toml: cannot be read: Permission denied"),
        ("records/0.AT2", 0o600, "0.AT2: the record cannot be read (Permission denied)"),
        ("records", 0o600, "Permission denied"),
    ],
)
def test_without_permission(closed, mode, words, open_folder, capsys):
    run = ["run", str(open_folder), "--no-figures"]
    # What is imported and compiled when it is needed is so before.
    assert main([*run, "--out", str(open_folder / "other")]) == 0
    capsys.readouterr()
    if closed == "results":
        (open_folder / "results").mkdir()
    (open_folder / closed).chmod(mode)
    with as_nobody():
        ended = main(run)
    assert ended == 2
    assert words in capsys.readouterr().err
    assert files_below(open_folder / "results") == set()


def test_a_record_of_a_suite_that_vanishes(tmp_path, monkeypatch):
    """It is a row that says so; the others are run."""
    results = suite(tmp_path, "records/*")
    begin = eventpound.study.suite.suite_plan

    def then_gone(*words: object, **options: object) -> object:
        found = begin(*words, **options)
        (tmp_path / "records" / "1.AT2").unlink()
        return found

    monkeypatch.setattr(eventpound.study.suite, "suite_plan", then_gone)
    assert main(["run", str(tmp_path), "--no-figures"]) == 0
    with (results / "suite.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [bool(row["failed"]) for row in rows] == [False, True, False]
    assert "cannot be read" in rows[1]["failed"]
    assert json.loads((results / "suite.json").read_text())["complete"] is True


@contextmanager
def disk_of(size: int) -> Iterator[None]:
    """A limit on the size of files stands for the end of the disk."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


@pytest.mark.parametrize("command", ["run", "records", "compare", "export", "synthetic"])
def test_full_disk_of_other_commands(command, tmp_path, capsys, undrawn):
    """One message, and no part of a set."""
    suite(tmp_path, "records/*")
    before = files_below(tmp_path)
    out = tmp_path / "out"
    words = {
        "run": ["run", str(tmp_path), "--no-figures", "--out", str(out)],
        "records": ["records", str(tmp_path / "records"), "--out", str(out)],
        "compare": ["compare", str(tmp_path), "--out", str(out), "--rtol", "1e-4"],
        "export": ["run", str(tmp_path), "--export", str(out)],
        "synthetic": ["records", "synthetic", str(out), "--count", "2"],
    }[command]
    if command in ("compare", "export"):
        (tmp_path / "case.toml").write_text(OF_RECORD)
    with disk_of(300):
        assert main(words) == 2
    assert "File too large" in capsys.readouterr().err
    assert files_below(tmp_path) == before


def test_full_disk_of_a_study(tmp_path, capsys):
    """It can be gone on with where there is room again."""
    names = {"figure": "study", "intensity": "intensity", "pages": ""}
    text = STUDY.format(**names).replace('pages = ""\n', "")
    (tmp_path / "case.toml").write_text(text.partition("[intensity]")[0])
    # Kept kernels are files as well, and stay outside the limit.
    assert main(["study", str(tmp_path), "--no-figures"]) == 0
    shutil.rmtree(tmp_path / "results")
    with disk_of(100):
        assert main(["study", str(tmp_path), "--no-figures"]) == 2
    assert "File too large" in capsys.readouterr().err
    assert not (tmp_path / "results" / "study.csv").exists()
    assert main(["study", str(tmp_path), "--no-figures"]) == 0
    assert (tmp_path / "results" / "study.csv").is_file()


MANIFESTS = [
    "", "null", "[]", "3", "{}", "[" * 100_000, '{"a":' * 100_000, "\\xff", '{"format": 3}', "NaN",
    '{"files": 3}', '{"files": {"suite.csv": 1, "summary.json": {}}}',
    '{"format": "eventpound-suite/1", "files": {}}',
    '{"format": "eventpound-suite/1", "files": [], "case": 1, "options": []}',
]  # fmt: skip


@pytest.mark.parametrize("content", MANIFESTS, ids=range(len(MANIFESTS)))
@pytest.mark.parametrize("kind", ["run", "suite", "study"])
def test_manifests_that_somebody_has_edited(kind, content, tmp_path, capsys):
    results = tmp_path / "results"
    if kind == "study":
        names = {"figure": "study", "intensity": "intensity", "pages": ""}
        text = STUDY.format(**names).replace('pages = ""\n', "")
        (tmp_path / "case.toml").write_text(text.partition("[intensity]")[0])
        results.mkdir()
        (results / "manifest.json").write_text(content, encoding="latin-1")
        assert main(["study", str(tmp_path), "--no-figures"]) == 0
        return
    suite(tmp_path, "records/*")
    if kind == "run":
        (tmp_path / "case.toml").write_text(OF_RECORD)
    assert main(["run", str(tmp_path), "--no-figures"]) == 0
    name = "manifest.json" if kind == "run" else "suite.json"
    (results / name).write_text(content, encoding="latin-1")
    capsys.readouterr()
    assert main(["plot", str(tmp_path)]) == 2
    assert str(results) in capsys.readouterr().err


@pytest.mark.parametrize("content", MANIFESTS, ids=range(len(MANIFESTS)))
def test_certificates_that_somebody_has_edited(content, tmp_path, capsys):
    suite(tmp_path, "")
    (tmp_path / "case.toml").write_text(OF_RECORD)
    (tmp_path / "certificate.json").write_text(content, encoding="latin-1")
    assert main(["compare", str(tmp_path), "--rtol", "1e-4", "--repeats", "1"]) == 2
    assert "run eventpound verify again" in capsys.readouterr().err
