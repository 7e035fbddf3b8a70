"""Every broken case gets one clear message, exit code 2, no traceback, and nothing written."""

from pathlib import Path

import pytest

from eventpound.case import load_case
from eventpound.cli import main
from eventpound.errors import InputError

SOUND = """\
title = "sound"

[excitation]
kind = "cosine"
amplitude = "0.4 g"
period = "0.8 s"

[[body]]
name = "deck1"
mass = "1301 t"

[[body]]
name = "deck2"
mass = "3210 t"

[[spring]]
between = ["ground", "deck1"]
name = "frame1"
law = "bouc-wen"
stiffness = "11672.15 kN/m"
strength = "3440 kN"
yield_displacement = "1.551 cm"

[[spring]]
between = ["deck1", "deck2"]
name = "bearing"
law = "linear"
stiffness = "1051 kN/m"

[[dashpot]]
between = ["ground", "deck1"]
coefficient = "1743 kN s/m"

[[contact]]
between = ["deck1", "deck2"]
name = "joint"
gap = "1.27 cm"
restitution = 0.7

[run]
output_step = "5 ms"
"""

RECORD = 'kind = "record"\nfile = "{}"\ntime_step = 0.01\nunits = "g"'
PULSE = 'kind = "cosine"\namplitude = "0.4 g"\nperiod = "0.8 s"'

# (name, old text, new text, what the one message holds)
BROKEN: list[tuple[str, str, str, tuple[str, ...]]] = [
    ("missing mass", 'mass = "1301 t"\n', "", ("[[body]] 1 (deck1): mass: missing", "kg")),
    ("missing name of a body", 'name = "deck1"\nm', "m", ("[[body]] 1: name: missing",)),
    ("missing gap", 'gap = "1.27 cm"\n', "", ("[[contact]] 1 (joint): gap: missing", "m,")),
    ("missing law", 'law = "linear"\n', "", ("[[spring]] 2 (bearing): law: missing", "bouc-wen")),
    ("missing ends", 'between = ["ground", "deck1"]\nc', "c", ("[[dashpot]] 1: between: missing",)),
    ("missing kind", 'kind = "cosine"\n', "", ("[excitation]: kind: missing", "ricker")),
    ("missing period", 'period = "0.8 s"\n', "", ("[excitation]: period: missing", "rad/s")),
    ("no excitation", f"[excitation]\n{PULSE}\n", "", ("[excitation]: missing", "none")),
    ("no duration of an endless motion", f"{PULSE}\n", PULSE.replace("cosine", "harmonic") + "\n",
     ("[run]: duration: missing", "without end")),
    ("unknown key", "yield_displacement", "yield_displacment",
     ("[[spring]] 1 (frame1): yield_displacment", "did you mean 'yield_displacement'?")),
    ("unknown table", "[run]", "[runn]", ("runn: unknown key", "did you mean 'run'?")),
    ("misspelt needed key", "mass = \"1301 t\"", 'mas = "1301 t"',
     ("[[body]] 1 (deck1): mas: unknown key, did you mean 'mass'?",)),
    ("key of another law", 'stiffness = "1051 kN/m"', 'stiffness = 1e6\nstrength = 1.0',
     ("[[spring]] 2 (bearing): strength: unknown key",)),
    ("unknown law", 'law = "linear"', 'law = "liner"',
     ("law: found 'liner'", "did you mean 'linear'?", "bilinear-elastic")),
    ("unknown kind", 'kind = "cosine"', 'kind = "cosin"', ("kind", "did you mean 'cosine'?")),
    ("wrong unit", '"1.27 cm"', '"1.27 kg"',
     ("[[contact]] 1 (joint): gap: found '1.27 kg'", "no unit of length", "1.27 cm")),
    ("unknown unit", '"1301 t"', '"1301 tonns"', ("mass", "unknown unit 'tonns'")),
    ("short ton", '"1301 t"', '"1301 ton"', ("mass", "'ton' may be 907", "'t'")),
    ("grams", '"1301 t"', '"1301 g"', ("mass", "'g'", "standard gravity")),
    ("a comma in a number", '"1.27 cm"', '"1,27 cm"', ("gap: found '1,27 cm'",)),
    ("a number without digits", '"1.27 cm"', '"cm"', ("gap: found 'cm'",)),
    ("Hz for an angular frequency", 'period = "0.8 s"', 'frequency = "1.25 Hz"',
     ("[excitation]: frequency: found '1.25 Hz'", "rad/s", "period")),
    ("frequency and period disagree", 'period = "0.8 s"', 'period = 0.8\nfrequency = 8.0',
     ("[excitation]: frequency: found 8.0", "7.853981634")),
    ("true for a number", "restitution = 0.7", "restitution = true", ("restitution: found True",)),
    ("NaN", "restitution = 0.7", "restitution = nan", ("restitution: found nan",)),
    ("infinite", '"1.27 cm"', "inf", ("gap: found inf",)),
    ("negative mass", '"1301 t"', '"-1301 t"',
     ("[[body]] 1 (deck1): mass: found '-1301 t'", "positive")),
    ("zero mass", '"1301 t"', "0", ("mass: found 0", "positive")),
    ("negative stiffness", '"1051 kN/m"', '"-1051 kN/m"', ("(bearing): stiffness: found '-1051",)),
    ("negative damping", '"1743 kN s/m"', "-1.0", ("[[dashpot]] 1: coefficient: found -1.0",)),
    ("yield displacement zero", '"1.551 cm"', "0.0",
     ("[[spring]] 1 (frame1): yield_displacement: found 0.0", "positive")),
    ("dependent triple", "strength = \"3440 kN\"\nyield_displacement = \"1.551 cm\"",
     "initial_stiffness = 2e8\nhardening = 0.05",
     ("(frame1): found initial_stiffness, stiffness, hardening", "add one of strength")),
    ("too few parameters", 'strength = "3440 kN"\n', "", ("(frame1): found stiffness, yield",)),
    ("overdetermined, disagreeing", 'strength = "3440 kN"', 'strength = 3.44e6\nhardening = 0.06',
     ("(frame1)", "disagree", "hardening")),
    ("strength that softens", 'stiffness = "11672.15 kN/m"', "initial_stiffness = 1e8",
     ("(frame1)", "together they make stiffness = -")),
    ("exponent below one", 'law = "bouc-wen"', 'law = "bouc-wen"\nexponent = 0.5',
     ("(frame1): exponent: found 0.5", ">= 1")),
    ("beta + gamma not positive", 'law = "bouc-wen"', 'law = "bouc-wen"\nbeta = -0.5',
     ("(frame1): beta: found -0.5", "beta + gamma > 0")),
    ("z beyond its bound", 'law = "bouc-wen"', 'law = "bouc-wen"\ninitial_z = -1.1',
     ("(frame1): initial_z: found -1.1", "1 in size")),
    ("frequency between two bodies", 'stiffness = "1051 kN/m"', "frequency = 6.0",
     ("(bearing): frequency: found 6.0", "of_mass beside it")),
    ("stiffness and frequency disagree", 'strength = "3440 kN"', 'strength = 3.44e6\nfrequency = 3',
     ("(frame1): stiffness: found '11672.15 kN/m'", "11709000 N/m")),
    ("ratio of what", 'coefficient = "1743 kN s/m"', "ratio = 0.05",
     ("[[dashpot]] 1: refers_to: missing", "initial-stiffness")),
    ("ratio of an unknown thing", 'coefficient = "1743 kN s/m"',
     'ratio = 0.05\nrefers_to = "stiffness"', ("refers_to: found 'stiffness'", "post-yield")),
    ("ratio between two bodies", 'between = ["ground", "deck1"]\ncoefficient = "1743 kN s/m"',
     'between = ["deck1", "deck2"]\nratio = 0.05\nrefers_to = "initial-stiffness"',
     ("[[dashpot]] 1: ratio: found 0.05", "coefficient")),
    ("ratio without a spring", 'between = ["ground", "deck1"]\ncoefficient = "1743 kN s/m"',
     'between = ["ground", "deck2"]\nratio = 0.05\nrefers_to = "initial-stiffness"',
     ("[[dashpot]] 1: ratio: found 0.05", "no spring")),
    ("coefficient and ratio disagree", 'coefficient = "1743 kN s/m"',
     'coefficient = 1.8e6\nratio = 0.05\nrefers_to = "2 rad/s"',
     ("[[dashpot]] 1: coefficient: found 1800000.0", "260200 N s/m")),
    ("restitution above one", "restitution = 0.7", "restitution = 1.2",
     ("[[contact]] 1 (joint): restitution: found 1.2", "0 to 1")),
    ("initial penetration", 'mass = "1301 t"', 'mass = 1e6\ninitial = { displacement = "2 cm" }',
     ("[[contact]] 1 (joint): gap: found '1.27 cm'", "-0.0073 m")),
    ("negative gap", '"1.27 cm"', '"-1 mm"', ("gap: found '-1 mm'", "penetrated")),
    ("contact naming no body", 'between = ["deck1", "deck2"]\nname = "joint"',
     'between = ["deck1", "deck3"]\nname = "joint"',
     ("[[contact]] 1 (joint): between: found ['deck1', 'deck3']", "deck1, deck2, barrier")),
    ("contact with the ground", 'between = ["deck1", "deck2"]\nname = "joint"',
     'between = ["deck1", "ground"]\nname = "joint"', ("(joint): between", "barrier")),
    ("spring to a barrier", 'between = ["deck1", "deck2"]\nname = "bearing"',
     'between = ["deck1", "barrier"]\nname = "bearing"', ("(bearing): between", "ground")),
    ("spring with one end", 'between = ["deck1", "deck2"]\nname = "bearing"',
     'between = ["deck1"]\nname = "bearing"', ("(bearing): between: found ['deck1']",)),
    ("spring with one body twice", 'between = ["deck1", "deck2"]\nname = "bearing"',
     'between = ["deck1", "deck1"]\nname = "bearing"', ("(bearing): between", "two different")),
    ("a name given twice", 'name = "bearing"', 'name = "frame1"',
     ("[[spring]] 2 (frame1): name: found 'frame1'", "spring 1 has this one")),
    ("a body named ground", 'name = "deck2"\nmass = "3210 t"', 'name = "deck2"\nmass = 1\n'
     '[[body]]\nname = "ground"\nmass = 1', ("[[body]] 3 (ground): name: found 'ground'",)),
    ("a name with a comma", 'name = "joint"', 'name = "a,b"', ("name: found 'a,b'", "comma")),
    ("one table for a list", '[[contact]]', '[contact]', ("contact: found a table", "[[contact]]")),
    ("rayleigh of no body", "[run]", '[[rayleigh]]\nbodies = ["x"]\nmass_coefficient = 0.1\n[run]',
     ("[[rayleigh]] 1: bodies: found 'x'", "deck1, deck2")),
    ("rayleigh without frequencies", "[run]",
     '[[rayleigh]]\nbodies = ["deck1"]\nratio = 0.05\n[run]',
     ("[[rayleigh]] 1: frequencies", "found none of frequencies, periods, modes")),
    ("negative amplitude", '"0.4 g"', '"-0.4 g"', ("amplitude: found '-0.4 g'", "reverse")),
    ("half a cycle of type-c", PULSE, PULSE.replace("cosine", "type-c") + "\ncycles = 1.5",
     ("[excitation]", "cycles", "1.5")),
    ("negative duration", "[run]", '[run]\nduration = "-4 s"',
     ("[run]: duration: found '-4 s'", "positive")),
    ("output step of a wrong size", '"5 ms"', '"1 ns"',
     ("[run]: output_step", "4e+09 rows")),
    ("text for a flag", "[run]", '[run]\nenergy = "yes"',
     ("[run]: energy: found 'yes'", "true or false")),
    ("rtol above one", "[run]", "[solver]\nrtol = 2\n[run]", ("[solver]: rtol: found 2",)),
    ("atol of an unknown kind", "[run]", "[solver]\natol = { displacment = 1e-9 }\n[run]",
     ("[solver]: atol.displacment: unknown key", "did you mean 'displacement'?")),
    ("a study", "[run]", "[study]\n[run]", ("[study]", "`eventpound study` makes them")),
    ("a suite and a file", PULSE, RECORD.format("good.txt") + '\nsuite = "*.txt"',
     ("[excitation]: file: found 'good.txt'", "one of file and suite")),
    ("a suite and synthetic motions", PULSE, 'kind = "record"\nsuite = "*"\nsynthetic = {}',
     ("[excitation]: synthetic", "one of suite and synthetic")),
    ("half a synthetic motion", PULSE, 'kind = "record"\nsynthetic = { count = 0.5 }',
     ("[excitation]: synthetic.count: found 0.5", "a whole number from 1")),
    ("a suite that matches nothing", PULSE, 'kind = "record"\nsuite = "*.AT2"',
     ("suite: found '*.AT2'", "no file matches")),
    ("a figure of a pulse", "[run]", '[figure]\nkind = "suite-spectrum"\n[run]',
     ("[figure]", "accepted: [excitation] with suite or synthetic")),
    ("a figure of no kind", PULSE + "\n",
     'kind = "record"\nsynthetic = {}\n[figure]\nkind = "spectrum"\n',
     ("[figure]: kind: found 'spectrum'", "suite-spectrum")),
    ("no record file", PULSE, RECORD.format("nowhere.txt"), ("[excitation]", "nowhere.txt")),
    ("record of an absent package", PULSE, RECORD.format("package:nosuchpackage/a.AT2"),
     ("[excitation]", "pip install nosuchpackage")),
    ("NaN in a record", PULSE, RECORD.format("nan.txt"), ("nan.txt", "line 3")),
    ("empty record", PULSE, RECORD.format("empty.txt"), ("empty.txt", "empty")),
    ("scale and pga", PULSE, RECORD.format("good.txt") + '\nscale = 2\npga = "0.4 g"',
     ("[excitation]: scale: found 2", "pga")),
    ("broken TOML", 'name = "deck1"', "name = deck1", ("not valid TOML", "line 9")),
]  # fmt: skip

FILES = {"good.txt": "0.1\n-0.2\n0.3\n0.05\n", "nan.txt": "0.1\n-0.2\nnan\n0.05\n", "empty.txt": ""}


@pytest.fixture
def directory(tmp_path):
    for name, content in FILES.items():
        (tmp_path / name).write_text(content)
    return tmp_path


def refused(directory: Path, capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Message of a refused command, after which the directory is as it was."""
    before = sorted(directory.rglob("*"))
    assert main(list(arguments)) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "Traceback" not in err
    assert sorted(directory.rglob("*")) == before
    return err


@pytest.mark.parametrize(("name", "old", "new", "fragments"), BROKEN, ids=[b[0] for b in BROKEN])
def test_one_clear_message(directory, capsys, name, old, new, fragments):
    assert old in SOUND
    text = SOUND.replace(old, new, 1)
    (directory / "case.toml").write_text(text)
    message = refused(directory, capsys, "run", str(directory))
    assert len(message.splitlines()) == 1
    assert message.startswith(f"eventpound: {directory / 'case.toml'}: ")
    for fragment in fragments:
        assert fragment in message


def test_the_sound_case_is_sound(directory):
    (directory / "case.toml").write_text(SOUND)
    assert len(load_case(directory).scene.bodies) == 2


def test_all_problems_together(directory):
    text = SOUND.replace('"1301 t"', '"1301 m"').replace("strength", "strenght")
    text = text.replace("restitution = 0.7", "restitution = 2.0").replace('"0.4 g"', '"0.4 Hz"')
    (directory / "case.toml").write_text(text)
    with pytest.raises(InputError) as caught:
        load_case(directory)
    assert len(caught.value.problems) == 4
    for fragment in ("mass", "strenght", "restitution", "amplitude"):
        assert any(fragment in problem for problem in caught.value.problems)


def test_no_case_file(directory, capsys):
    message = refused(directory, capsys, "run", str(directory))
    assert "no case.toml" in message
    assert "eventpound new" in message


def test_no_directory(directory, capsys):
    message = refused(directory, capsys, "run", str(directory / "nowhere"))
    assert "nowhere: no such file or directory" in message


def test_not_text(directory, capsys):
    (directory / "case.toml").write_bytes(b'title = "\xff\xfe"\n')
    assert "not UTF-8" in refused(directory, capsys, "check", str(directory))


def test_nowhere_to_write(directory, capsys):
    (directory / "case.toml").write_text(SOUND)
    out = str(directory / "good.txt" / "results")
    message = refused(directory, capsys, "run", str(directory), "--out", out)
    assert "cannot be written to" in message


def test_plot_without_results(directory, capsys):
    (directory / "case.toml").write_text(SOUND)
    assert "run the case first" in refused(directory, capsys, "plot", str(directory))


def test_new_does_not_overwrite(directory, capsys):
    (directory / "case.toml").write_text(SOUND)
    assert "not overwritten" in refused(directory, capsys, "new", str(directory))
    assert (directory / "case.toml").read_text() == SOUND
