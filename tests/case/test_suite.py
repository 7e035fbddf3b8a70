"""What a case says of a suite: which records, how they are read, and what is understood."""

import math
from pathlib import Path

import pytest

from eventpound import InputError, load_case, simulate
from eventpound.case import read_case
from eventpound.case.case import member_case
from eventpound.motion.synthetic import synthetic_motion

CASE = """\
title = "an oscillator"
body = [{{ name = "deck", mass = "1000 t" }}]
spring = [
  {{ between = ["ground", "deck"], name = "frame", law = "linear", frequency = "6 rad/s" }},
]
[excitation]
kind = "record"
{}
"""
HUMP = "\n".join(str(x) for x in (0.0, 0.2, 0.3, 0.1, -0.2, -0.3, 0.0, 0.1, 0.0))


@pytest.fixture
def folder(tmp_path):
    for name in ("b.txt", "a.txt", "deeper/c.txt"):
        file = tmp_path / "records" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(HUMP)
    return tmp_path


def write(folder: Path, excitation: str) -> Path:
    (folder / "case.toml").write_text(CASE.format(excitation))
    return folder


def test_pattern(folder):
    text = 'suite = "records/**/*.txt"\nunits = "g"\ntime_step = 0.1\nscale = 2\nreverse = true'
    case = load_case(write(folder, text))
    assert case.solver.name == "fast"
    assert math.isnan(case.run.duration)
    members = case.suite.members(case.directory)
    assert [m.name for m in members] == ["a.txt", "b.txt", "deeper/c.txt"]
    data = members[0].read()
    one = member_case(case, members[0], data)
    scales = one.scene.motion.scales()
    assert scales.a_g == pytest.approx(0.6 * 9.80665)
    # Five periods 2 pi / 6 s after the last of nine samples.
    assert one.run.duration == pytest.approx(0.8 + 5.0 * 2.0 * math.pi / 6.0)
    assert one.run.output_step == 0.1


def test_what_was_understood_is_a_case_again(folder):
    text = 'suite = "records/*"\nunits = "g"\ntime_step = "0.1 s"\npga = "0.4 g"'
    first = load_case(write(folder, text))
    again = read_case(first.understood, folder / "case.toml")
    assert again.suite == first.suite
    assert again.understood == first.understood
    synthetic = load_case(write(folder, "synthetic = { count = 3, first = 2 }"))
    again = read_case(synthetic.understood, folder / "case.toml")
    assert again.suite.synthetic == synthetic.suite.synthetic


def test_a_member_is_a_case_again(folder):
    case = load_case(write(folder, 'suite = "records/*"\nunits = "g"\ntime_step = "0.1 s"'))
    member = case.suite.members(case.directory)[0]
    one = member_case(case, member, member.read())
    again = read_case(one.understood, folder / "case.toml")
    assert again.suite is None
    assert simulate(again).peaks.equals(simulate(one).peaks)


def test_list_with_units_and_time_steps(folder):
    lines = ["file,units,dt_s,remark", "records/b.txt,g,0.1,x", "records/a.txt,cm/s2,0.2,y"]
    lines += ["records/b.txt,g,fast,z", "records/b.txt,g,0.1,", "gone.txt,g,0.1,"]
    (folder / "list.csv").write_text("\n".join(lines))
    case = load_case(write(folder, 'suite = "list.csv"'))
    members = case.suite.members(case.directory)
    names = ["records/b.txt", "records/a.txt", "records/b.txt (2)", "records/b.txt (3)", "gone.txt"]
    assert [m.name for m in members] == names
    assert members[0].read().time_step == 0.1
    assert members[1].read().acceleration.max() == pytest.approx(0.003)
    with pytest.raises(InputError, match=r"list.csv, line 4: dt_s is 'fast'"):
        members[2].read()
    with pytest.raises(InputError, match=r"gone.txt"):
        members[4].read()


def test_other_records_for_a_case(folder, monkeypatch):
    write(folder, "synthetic = { count = 2 }\nunits = 'g'\ntime_step = 0.1")
    monkeypatch.chdir(folder / "records")
    case = load_case(folder, "a*")
    assert [m.name for m in case.suite.members(case.directory)] == ["a.txt"]


def test_synthetic_motions_are_those_of_the_files(folder):
    case = load_case(write(folder, "synthetic = { seed = 2, first = 4, count = 1 }"))
    (member,) = case.suite.members(case.directory)
    assert member.name == synthetic_motion(2, 4).name
    assert (member.read().acceleration == synthetic_motion(2, 4).record.acceleration).all()


def test_simulate_takes_no_suite(folder):
    case = load_case(write(folder, "synthetic = {}"))
    with pytest.raises(InputError, match="the case holds a suite of records"):
        simulate(case)


def test_wrong_lengths_are_named(tmp_path):
    (tmp_path / "case.toml").write_text(
        '[excitation]\nkind = "record"\nsynthetic = { count = 2 }\n'
        '[figure]\nkind = "similarity-contours"\ncontours = [1, 0.1]\n'
        'joint = [{ name = "in-deck", gap = ["1.3 cm", "0.6 cm"] }]\n'
    )
    with pytest.raises(InputError) as caught:
        load_case(tmp_path)
    assert any("joint 1: gap" in line for line in caught.value.problems)
    assert any("contours: found [1, 0.1]" in line for line in caught.value.problems)


def test_component_of_a_list_is_for_files_that_hold_several(folder):
    rows = "\n".join(f"{0.1 * i:.1f} {a} {b}" for i, (a, b) in enumerate([(0, 0), (1, 3), (0, 0)]))
    (folder / "records" / "two.txt").write_text(rows)
    lines = ["file,units,dt_s,component", "records/two.txt,m/s2,,#2", "records/a.txt,g,0.1,N"]
    lines += ["records/two.txt,m/s2,,"]
    (folder / "list.csv").write_text("\n".join(lines))
    case = load_case(write(folder, 'suite = "list.csv"'))
    second, single, unsaid = case.suite.members(case.directory)
    assert second.read().acceleration.max() == 3.0
    assert single.read().time_step == 0.1
    with pytest.raises(InputError, match="say which"):
        unsaid.read()
