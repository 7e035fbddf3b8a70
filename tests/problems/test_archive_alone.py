"""A program in another language, scored from the archive where there is no eventpound."""

import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from eventpound.cli import main
from eventpound.problems.files import archive
from tests.problems.league import compiled, piped
from tests.problems.test_collection import SET

NAMES = ("01", "12", "31")


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("elsewhere")
    (folder / "set.zip").write_bytes(archive(SET))
    with zipfile.ZipFile(folder / "set.zip") as whole:
        whole.extractall(folder)
    return folder / "eventpound-problems-1.2"


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    made = compiled(tmp_path_factory.mktemp("program"))
    if made is None:
        pytest.skip("there is no C compiler")
    return made


def scored(unpacked, answer, name):
    """What score.py of the archive says, in a Python that cannot import eventpound."""
    numpy = str(next(iter(np.__path__)).rpartition("/")[0])
    guard = (
        "import sys, runpy\n"
        f"sys.path.append({numpy!r})\n"
        "class NoEventpound:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name.split('.')[0] == 'eventpound': raise ImportError(name)\n"
        "sys.meta_path.insert(0, NoEventpound())\n"
        "sys.argv = ['score.py', *sys.argv[1:]]\n"
        "runpy.run_path('score.py', run_name='__main__')\n"
    )
    return subprocess.run(
        [sys.executable, "-I", "-S", "-c", guard, name, answer, "--html", "card.html"],
        cwd=unpacked, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("number", NAMES)
def test_a_c_program_is_scored_from_the_archive_alone(unpacked, program, tmp_path, capsys, number):
    name = SET.some([number])[0].name
    digits = []
    for size in ("1e-3", "1e-5"):
        answer = tmp_path / "answer.csv"
        line = piped(program).format(problem=unpacked / name, size=size, out=answer)
        subprocess.run(["sh", "-c", line], check=True)
        run = scored(unpacked, answer, name)
        assert (run.returncode, run.stderr) == (0, "")
        said = dict(line.split(maxsplit=1) for line in run.stdout.splitlines() if line.strip())
        assert said["problem"] == name
        digits.append(float(said["history"].split()[0]))
    # First order: two digits for two decades of the step, less what chance does to each.
    assert digits[1] > digits[0] + 1.0
    assert said["passed"] in ("engineering", "research")
    # eventpound says the same of the unpacked archive.
    assert main(["problems", "score", str(unpacked / name), str(answer)]) == 0
    assert capsys.readouterr().out == run.stdout
    assert "<svg" in (unpacked / "card.html").read_text()


def test_an_octave_program_is_scored_from_the_archive_alone(unpacked, tmp_path):
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("there is no Octave")
    name, answer = SET.some(["01"])[0].name, tmp_path / "answer.csv"
    program = unpacked / "entrants" / "rk4_events.m"
    words = [octave, program, unpacked / name, answer, "1e-3"]
    subprocess.run(words, check=True, capture_output=True)
    run = scored(unpacked, answer, name)
    assert run.returncode == 0
    assert "passed         research" in run.stdout
