"""A study on disk: stopped, killed, changed, made by others, and always the same table."""

import json
import subprocess
import sys
import time
from itertools import islice

import pytest

from eventpound.cli import main
from eventpound.study.engine import Batch
from eventpound.study.running import Store, run_study
from eventpound.study.table import read_table
from tests.study.conftest import ELASTOPLASTIC, expected_table

# Without the runs that only tell what contact changes.
SHORT = ELASTOPLASTIC.replace('"free.pi_um", "amplification", ', "")
MANY = SHORT.replace("count = 40", "count = 400")


class Broken:
    """An engine that ends after some chunks, as a process does that is killed."""

    def __init__(self, after):
        self.after = after

    def run(self, study, chunks):
        yield from islice(Batch(1).run(study, chunks), self.after)
        raise KeyboardInterrupt


class Counting:
    """An engine that counts the chunks it is asked for."""

    def __init__(self):
        self.asked = []

    def run(self, study, chunks):
        for chunk, rows in Batch(1).run(study, chunks):
            self.asked.append(chunk.number)
            yield chunk, rows


def test_a_stopped_study_goes_on_where_it_was(make_study):
    case = make_study()
    out = case.directory / "results"
    study = case.study
    total = len(list(study.chunks()))
    with pytest.raises(KeyboardInterrupt):
        run_study(study, out, Broken(2))
    assert not (out / "study.csv").exists()
    assert Store(out, study).stored() == {0, 1}
    rest, seen = Counting(), []
    run_study(study, out, rest, lambda done, size: seen.append((done, size)))
    assert rest.asked == list(range(2, total))
    assert (out / "study.csv").read_bytes() == expected_table(study)
    rows = [chunk.high - chunk.low for chunk in study.chunks()]
    assert seen[0] == (sum(rows[:2]), sum(rows))
    assert seen[-1] == (sum(rows), sum(rows))
    # Done: nothing is asked for again, and the chunks are gone.
    again = Counting()
    run_study(study, out, again)
    assert again.asked == []
    assert sorted(p.name for p in out.iterdir() if p.suffix != ".parquet") == [
        "manifest.json",
        "study.csv",
    ]


def test_a_table_that_was_tampered_with_is_made_again(make_study):
    case = make_study()
    out = case.directory / "results"
    run_study(case.study, out, Batch())
    table = (out / "study.csv").read_bytes()
    (out / "study.csv").write_bytes(table[:-1])
    run_study(case.study, out, Batch())
    assert (out / "study.csv").read_bytes() == table


def test_a_changed_case_begins_afresh_beside_the_old_one(make_study):
    first = make_study()
    out = first.directory / "results"
    with pytest.raises(KeyboardInterrupt):
        run_study(first.study, out, Broken(2))
    second = make_study(ELASTOPLASTIC.replace("uy = 0.2", "uy = 0.1"))
    fresh = Counting()
    run_study(second.study, out, fresh)
    assert fresh.asked[0] == 0
    assert (out / "study.csv").read_bytes() == expected_table(second.study)
    # The first goes on from its own chunks, and sets the second aside.
    rest = Counting()
    moved = run_study(first.study, out, rest)
    assert rest.asked[0] == 2
    assert (out / "study.csv").read_bytes() == expected_table(first.study)
    earlier = out / f"earlier-{second.study.digest[:12]}"
    assert moved == earlier
    assert run_study(first.study, out, Counting()) is None
    assert (earlier / "study.csv").read_bytes() == expected_table(second.study)
    manifest = json.loads((earlier / "manifest.json").read_text())
    assert manifest["study_sha256"] == second.study.digest


def test_processes_end_with_a_study_that_is_killed(make_study):
    case = make_study(MANY)
    process = start(case.directory, "--processes", "2", stdout=subprocess.PIPE)
    wait_for_a_chunk(Store(case.directory / "results", case.study), process)
    process.kill()
    # Its end is where the last of all that may write to it is gone.
    process.communicate(timeout=60)


def start(directory, *options, stdout=subprocess.DEVNULL):
    command = [sys.executable, "-m", "eventpound", "study", str(directory), "--no-figures"]
    return subprocess.Popen([*command, *options], stdout=stdout)


def wait_for_a_chunk(store, process):
    while not list(store.unfinished.glob("[0-9]*.csv")) and process.poll() is None:
        time.sleep(0.005)


def test_command(make_study, capsys):
    text = ELASTOPLASTIC + '[figure]\nx = "pi.Q"\ny = "pi_um"\ncurves = "pi.delta"\n'
    case = make_study(text + 'columns = "excitation.reverse"\ngrey = "free.pi_um"\nregions = 0.1\n')
    assert main(["study", str(case.directory)]) == 0
    printed = capsys.readouterr().out
    assert "160, 0 failed" in printed
    assert "study.png" in printed
    assert (case.directory / "results" / "study.png").stat().st_size > 10_000


def test_command_refuses_a_case_without_a_study(tmp_path, capsys):
    (tmp_path / "case.toml").write_text('[excitation]\nkind = "none"\n')
    assert main(["study", str(tmp_path)]) == 2
    assert "[study]: missing" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def test_check_says_what_was_understood(make_study, capsys):
    case = make_study()
    assert main(["check", str(case.directory)]) == 0
    printed = capsys.readouterr().out
    assert "runs      160, stored in chunks of 64" in printed
    assert "excitation.reverse, pi.delta, pi.Q" in printed


def test_parquet_holds_the_table(make_study):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    case = make_study(ELASTOPLASTIC.replace("0.5]", "0.5, 3.0]"))
    out = case.directory / "results"
    run_study(case.study, out, Batch())
    table, stored = read_table(out), parquet.read_table(out / "study.parquet")
    assert stored.column_names == list(table.columns)
    assert stored.num_rows == case.study.size
    for name in ("pi.Q", "pi_um", "amplification", "impacts"):
        assert stored[name].to_pylist() == table[name].tolist()
    assert stored["success"].to_pylist() == [True] * case.study.size
    assert set(stored["excitation.reverse"].to_pylist()) == {"False", "True"}


class Waiting:
    """An engine that hands over a chunk and then does something else."""

    def __init__(self, meanwhile):
        self.meanwhile = meanwhile

    def run(self, study, chunks):
        for number, found in enumerate(Batch().run(study, chunks)):
            yield found
            if number == 0:
                self.meanwhile()


def test_a_second_program_at_the_same_study_is_refused(make_study):
    case = make_study()
    out = case.directory / "results"
    said = []

    def second():
        command = [sys.executable, "-m", "eventpound", "study", str(case.directory)]
        said.append(subprocess.run(command, capture_output=True, text=True, check=False))

    run_study(case.study, out, Waiting(second))
    assert said[0].returncode == 2
    assert "another program is at work on it" in said[0].stderr
    assert (out / "study.csv").read_bytes() == expected_table(case.study)
    assert not list(out.glob(".*"))


def test_chunks_beside_a_finished_table_are_cleared(make_study):
    case = make_study()
    out = case.directory / "results"
    run_study(case.study, out, Batch())
    Store(out, case.study).put(0, b"left by somebody\n")
    run_study(case.study, out, Batch())
    assert not list(out.glob("unfinished-*"))
    assert (out / "study.csv").read_bytes() == expected_table(case.study)
