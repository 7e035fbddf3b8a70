"""The set is what was frozen, its answers hold, and its archive is always the same."""

import json
import shutil
import subprocess
import sys
from decimal import Decimal

import pytest

from eventpound.cli import main
from eventpound.problems.collection import answer_of, read_collection
from eventpound.results.jsontext import canonical
from eventpound.results.manifest import sha256
from tests.models import CASES
from tests.reference.problems import load

SET = read_collection(CASES / "problems")
SOLVED = {
    p.name: text.split("problem ")[1][:3]
    for p in SET.problems
    if "open.json" in (text := (p.folder / "case.toml").read_text())
}
"""Problems whose answers others know to 28 digits, and what those call them."""


def test_the_set_is_what_was_frozen():
    SET.check_frozen()
    assert [p.name[:2] for p in SET.problems] == [f"{i:02d}" for i in range(1, 60)]
    assert {p.folder for p in SET.problems} == set(SET.folder.glob("[0-9]*"))


@pytest.mark.parametrize(
    ("version", "files", "published"),
    [("1.0", 107, "d3d543d810849dc2"), ("1.1", 115, "7f8a7925f912dcc6")],
)
def test_earlier_versions_are_in_it_unchanged(version, files, published):
    """By the hash with which each was published."""
    earlier = json.loads((SET.folder / f"frozen-{version}.json").read_text())
    assert (earlier["version"], len(earlier["files"])) == (version, files)
    assert sha256(canonical(earlier["files"])) == earlier["sha256"]
    assert earlier["sha256"].startswith(published)
    now = SET.frozen()
    assert {n: h for n, h in earlier["files"].items() if now.get(n) != h}.keys() == {"set.toml"}


@pytest.mark.parametrize("problem", SET.problems, ids=lambda p: p.name)
def test_every_answer_is_certified_and_agrees_with_the_independent_program(problem):
    answer = problem.answer()
    said = answer["independent"]
    assert answer["certified"]
    version = "1.0" if problem.name < "53" else "1.1" if problem.name < "57" else "1.2"
    assert answer["set"] == f"{SET.name} {version}"
    assert said["silent"] == ""
    assert said["checked"] == said["agree"] > 10
    assert {row[0].split(".")[0] for row in answer["quantities"]} == {"peaks", "final", "history"}
    assert all(bound > 0.0 for _, _, bound, *_ in answer["quantities"])


@pytest.mark.parametrize("name", SOLVED)
def test_bounds_hold_against_28_digits(name):
    answer = SET.some([name])[0].answer()
    solved = load()[SOLVED[name]]
    rows = {row[0]: row for row in answer["quantities"]}
    checked = 0
    for i, body in enumerate(solved.scene.bodies):
        stored = {
            f"peaks.{body.name}.max": solved.result["u_max"][i],
            f"peaks.{body.name}.min": solved.result["u_min"][i],
            f"final.{body.name}.u": solved.result["final"]["u"][i],
            f"final.{body.name}.v": solved.result["final"]["v"][i],
        }
        for key, true in stored.items():
            if key in rows:
                _, value, bound, amplification, scale = rows[key]
                # Both inputs are rounded: 2 pi/w is a double there, w one here.
                rounding = Decimal(2.0**-52 * amplification * scale)
                assert abs(Decimal(value) - Decimal(true)) <= Decimal(bound) + rounding
                checked += 1
    assert checked >= 3


def test_a_fresh_certificate_agrees_with_the_frozen_one():
    problem = SET.some(["31"])[0]
    fresh, _ = answer_of(SET, problem)
    frozen = problem.answer()
    for ours, theirs in zip(fresh["quantities"], frozen["quantities"], strict=True):
        assert ours[0] == theirs[0]
        assert abs(ours[1] - theirs[1]) <= ours[2] + theirs[2]
    assert [e[:2] for e in fresh["events"]] == [e[:2] for e in frozen["events"]]


@pytest.fixture
def copy(tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(
        SET.folder,
        folder,
        ignore=lambda _, names: [
            n for n in names if (n[:2] > "02" and n[:2].isdigit()) or n.startswith("frozen-")
        ],
    )
    text = (folder / "set.toml").read_text().split("\n\n[[problem]]")[:3]
    (folder / "set.toml").write_text("\n\n[[problem]]".join(text) + "\n")
    return folder


def test_a_changed_set_is_refused_until_it_is_frozen_anew(copy, tmp_path, capsys):
    out = ["--out", str(tmp_path / "set.zip")]
    assert main(["problems", "pack", str(copy), *out]) == 2
    assert "is not version 1.2 as it was frozen" in capsys.readouterr().err
    assert main(["problems", "pack", str(copy), "--freeze"]) == 0
    assert main(["problems", "pack", str(copy), *out]) == 0
    case = copy / "01-elastic-cosine" / "case.toml"
    case.write_text(case.read_text() + "# changed\n")
    capsys.readouterr()
    assert main(["problems", "pack", str(copy), *out]) == 2
    assert "differs in 01-elastic-cosine/case.toml" in capsys.readouterr().err


def test_a_damaged_list_of_hashes_is_one_message(copy, capsys):
    (copy / "frozen.json").write_text("{}")
    assert main(["problems", "pack", str(copy)]) == 2
    assert "has no hashes under 'files'" in capsys.readouterr().err


def test_a_problem_is_added_certified_and_packed(copy, tmp_path, capsys):
    assert main(["problems", "pack", str(copy), "--freeze"]) == 0
    capsys.readouterr()
    shutil.copytree(copy / "01-elastic-cosine", copy / "03-mine")
    (copy / "03-mine" / "answer.json").unlink()
    index = copy / "set.toml"
    index.write_text(
        index.read_text().replace('"1.2"', '"1.3"')
        + '\n[[problem]]\nname = "03-mine"\ntests = "Nothing new."\ntags = ["mine"]\n'
    )
    assert main(["problems", "pack", str(copy), "--certify"]) == 0
    assert capsys.readouterr().out.split() == ["03-mine", "certified"]
    assert main(["problems", "pack", str(copy), "--freeze"]) == 0
    assert main(["problems", "pack", str(copy), "--out", str(tmp_path / "mine.zip")]) == 0
    run = subprocess.run(
        [sys.executable, "-m", "zipfile", "-l", tmp_path / "mine.zip"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "eventpound-problems-1.3/03-mine/answer.json" in run.stdout
    assert "eventpound-problems-1.3/frozen-1.2.json" in run.stdout
    # A version that begins with the same number keeps all problems as they are.
    case = copy / "01-elastic-cosine" / "case.toml"
    case.write_text(case.read_text() + "# changed\n")
    index.write_text(index.read_text().replace('"1.3"', '"1.4"'))
    assert main(["problems", "pack", str(copy), "--freeze"]) == 2
    said = capsys.readouterr().err
    assert "version 1.4 does not keep 01-elastic-cosine/case.toml of version 1.3" in said
    index.write_text(index.read_text().replace('"1.4"', '"2.0"'))
    assert main(["problems", "pack", str(copy), "--freeze"]) == 0


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "'problem'"),
        ('name = "a"\nversion = "1"\n[[problem]]\nname = "b"\n', "'tests'"),
        ('name = "a"\nversion = "1"\nproblem = [{name="b", tests="", tags=[]}]', "no directory b"),
        ("name =", "Invalid value"),
    ],
)
def test_a_wrong_index_is_one_message(tmp_path, capsys, text, says):
    (tmp_path / "set.toml").write_text(text)
    assert main(["problems", "pack", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
