"""The files of the set: an archive, problems in bare numbers, and what has no place in them."""

import io
import json
import shutil
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from eventpound import load_case
from eventpound.errors import InputError
from eventpound.problems.files import LAW, archive, bare_numbers, problem_files, problem_json
from eventpound.results.export import export
from eventpound.results.jsontext import canonical
from eventpound.results.manifest import sha256
from eventpound.score.problem import Problem
from tests.problems.test_collection import SET


def test_the_archive_is_the_same_each_time_and_whole():
    content = archive(SET)
    assert content == archive(SET)
    with zipfile.ZipFile(io.BytesIO(content)) as whole:
        names = whole.namelist()
        assert {info.date_time for info in whole.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        head = "eventpound-problems-1.2"
        for problem in SET.problems:
            for file in ("problem.md", "problem.json", "problem.txt", "motion.csv", "answer.json"):
                assert f"{head}/{problem.name}/{file}" in names
            assert f"{head}/{problem.name}/case.toml" in names
        assert {f"{head}/score.py", f"{head}/README.md", f"{head}/set.toml"} <= set(names)
        for name in names:
            if name.endswith(".json"):
                json.loads(whole.read(name), parse_constant=pytest.fail)


def test_files_of_version_1_1_are_as_they_were():
    """What later problems need besides is in their files alone; but for the name of the set."""
    hashes = {}
    for problem in SET.problems[:56]:
        made = problem_files(SET, problem)
        made["problem.json"] = made["problem.json"].replace(f"problems {SET.version}".encode(), b"")
        for name in ("problem.md", "problem.json", "problem.txt", "motion.csv"):
            hashes[f"{problem.name}/{name}"] = sha256(made[name])
    assert sha256(canonical(hashes)).startswith("87101e340b48e60f")


@pytest.mark.parametrize("name", ["01", "05", "16", "26", "32", "49", "51"])
def test_bare_numbers_are_those_of_the_problem(name):
    given = json.loads(canonical(problem_json(SET, SET.some([name])[0])))
    first, columns, *rest = bare_numbers(given).decode().splitlines()
    assert first == f"# problem {given['problem']}"
    x = iter([float(word) for line in rest for word in line.split()])
    n, springs, contacts = (int(next(x)) for _ in range(3))
    assert [next(x), next(x)] == [given["start"], given["end"]]
    bodies = [[next(x) for _ in range(3 + n)] for _ in range(n)]
    laws = [[next(x) for _ in range(9 + n)] for _ in range(springs)]
    touching = [[next(x) for _ in range(2 + n)] for _ in range(contacts)]
    assert next(x, None) is None
    initial = given["initial"]
    assert [b[:3] for b in bodies] == [
        list(row) for row in zip(given["M"], initial["u"], initial["v"], strict=True)
    ]
    assert [b[3:] for b in bodies] == given["C"]
    assert [row[:9] for row in laws] == [
        list(row) for row in zip(*(given["springs"][key] for key in LAW), strict=True)
    ]
    for rows, head, key in ((laws, 9, "B"), (touching, 2, "W")):
        assert [list(row) for row in zip(*(r[head:] for r in rows), strict=True)] == (
            given[key] if rows else []
        )
    assert [row[:2] for row in touching] == [
        list(row) for row in zip(given["gaps"], given["restitutions"], strict=True)
    ]
    known = Problem(given, {})
    names = [f"{key}.{body}" for key in "uv" for body in known.bodies]
    assert columns.split(",") == ["t", *names, *known.z_columns]


@pytest.mark.parametrize("name", ["01", "07", "11", "12", "15", "40", "49"])
def test_the_motion_in_numbers_is_the_motion(name):
    problem = SET.some([name])[0]
    motion = problem.case().scene.motion
    given = json.loads(canonical(problem_json(SET, problem)))
    t = np.random.default_rng(1).uniform(given["start"], given["end"], 200)
    (a_g,) = Problem(given, {}).ground(t)
    np.testing.assert_allclose(a_g, motion.acceleration(t), atol=1e-12 * np.abs(a_g).max())


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("31", ((4934802.2 + 49.03e6) / 5e5) ** 0.5, ((30842513.75 + 49.03e6) / 5e5) ** 0.5),
        ("35", 2.0, 200.0),
        ("50", 10.0 * 2.0 * np.sin(np.pi / 20.0), 20.0),
    ],
)
def test_frequencies_are_those_of_closed_forms(name, low, high):
    """Two oscillators; a free bar of ten lumped elements, ω_k = 20 sin(kπ/20)."""
    found = problem_json(SET, SET.some([name])[0])["frequencies"]
    assert found == pytest.approx([low, high], rel=1e-3)


@pytest.mark.parametrize("case", ["passing-wave", "pair-with-law"])
def test_what_the_files_have_no_place_for_is_refused(tmp_path, case):
    """Supports and contact laws would be left out."""
    folder = tmp_path / "01-wave"
    shutil.copytree(SET.folder.parent / case, folder)
    problem = replace(SET.problems[0], folder=folder)
    with pytest.raises(InputError, match=r"01-wave: has supports, .*eventpound run"):
        problem_json(SET, problem)


def test_another_impact_law_is_refused(tmp_path):
    """By the files of a problem, and by an export: neither has equations for it."""
    case = tmp_path / "case.toml"
    text = (SET.folder / "59-skew-deck-friction" / "case.toml").read_text()
    case.write_text('impact_law = "poisson"\n' + text)
    with pytest.raises(InputError, match=r"impact_law = 'poisson'; accepted: newton"):
        problem_json(SET, replace(SET.problems[0], folder=tmp_path))
    with pytest.raises(InputError, match=r"found impact_law = 'poisson'; accepted: newton"):
        export(load_case(tmp_path), tmp_path / "out")
