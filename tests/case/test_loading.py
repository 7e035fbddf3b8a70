"""Defaults, options, the round trip of what was understood, and the case that `new` writes."""

import hashlib
import time

import pytest

from eventpound.case import SolverOptions, load_case, read_case, write_template
from eventpound.errors import InputError
from eventpound.scene import BARRIER

FULL = """\
[excitation]
kind = "harmonic"
amplitude = "0.1 g"
period = 2
cycles = 3

[[body]]
name = "a"
mass = "2 t"
initial = { displacement = "-1 cm", velocity = "10 cm/s" }

[[body]]
name = "b"
mass = "1 t"

[[spring]]
between = ["ground", "a"]
law = "bouc-wen"
initial_stiffness = "100 kN/m"
yield_force = "2 kN"
hardening = 0.1
beta = 0.7
gamma = 0.3

[[spring]]
between = ["a", "b"]
law = "series"
parts = [ { law = "linear", stiffness = 1e5 },
          { law = "bilinear-elastic", compression = 2e5, extension = 0.0 } ]

[[dashpot]]
between = ["ground", "a"]
ratio = 0.05
refers_to = "post-yield-stiffness"

[[rayleigh]]
bodies = ["b"]
mass_coefficient = "0.1 1/s"

[[contact]]
between = ["a", "b"]
gap = 0
restitution = 1

[[contact]]
between = ["barrier", "a"]
gap = "2 cm"
restitution = 0.5

[run]
start_time = 1
duration = "9 s"
output_step = "5 ms"
energy = true
avoiding_gap = true
error_estimate = true

[solver]
name = "penalty"
rtol = 1e-6
atol = { displacement = "1 um", z = 1e-8 }
time_step = "0.1 ms"
contact_steps = 20
theta = 0.5
"""


def test_full_case(tmp_path):
    (tmp_path / "case.toml").write_text(FULL)
    case = load_case(tmp_path)
    assert case.title == tmp_path.name
    assert case.directory == tmp_path
    assert case.source_hash == hashlib.sha256(FULL.encode()).hexdigest()
    assert case.record is None
    a, b = case.scene.bodies
    assert (a.displacement, a.velocity, b.displacement, b.velocity) == (-0.01, 0.1, 0.0, 0.0)
    first, second = case.scene.contacts
    assert (first.name, first.left, first.right) == ("a-b", "a", "b")
    assert (second.name, second.left) == ("barrier-a", BARRIER)
    assert len(case.scene.dashpots) == 2
    assert (case.run.start_time, case.run.duration, case.run.output_step) == (1.0, 9.0, 0.005)
    assert case.run.energy
    assert case.run.stated.avoiding_gap
    assert case.run.error_estimate
    assert case.solver == SolverOptions(
        "penalty",
        1e-6,
        {"displacement": 1e-6, "z": 1e-8},
        {"time_step": 1e-4, "contact_steps": 20, "theta": 0.5},
    )
    shape, damping = case.warnings
    assert "gamma = 0.3" in shape
    assert "body 'b': a dashpot joins it to the ground past the springs that yield" in damping


def test_defaults(tmp_path):
    document = {
        "title": "plain",
        "excitation": {"kind": "sine", "amplitude": 1, "period": 1},
        "body": [{"name": "a", "mass": 1}],
    }
    case = read_case(document, tmp_path / "case.toml")
    assert case.title == "plain"
    assert case.solver == SolverOptions("cvode", 1e-9, {}, {})
    assert case.run.start_time == 0.0
    assert case.run.duration == 5.0
    assert case.run.output_step == 0.0025
    assert not case.run.energy
    assert not case.run.stated.avoiding_gap
    assert case.run.error_estimate is None
    assert read_case(case.understood, tmp_path / "case.toml").run == case.run
    assert case.warnings == ()


def test_template_runs(tmp_path):
    case = load_case(write_template(tmp_path / "new" / "case").parent)
    (spring,) = case.scene.springs
    # Paper, table of the bridge: K_s = 0.05 x 233443 kN/m, Q = 0.95 x 3621 kN.
    assert spring.law.stiffness == pytest.approx(11672.15e3, rel=1e-14)
    assert spring.law.strength == pytest.approx(3439.95e3, rel=1e-14)
    assert case.scene.dashpots[0].coefficient == pytest.approx(1742.7e3, abs=50.0)
    assert case.warnings == ()
    assert sorted(path.name for path in (tmp_path / "new" / "case").iterdir()) == ["case.toml"]


def test_a_byte_order_mark_is_passed_over(tmp_path):
    file = write_template(tmp_path)
    plain = load_case(tmp_path)
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert load_case(tmp_path).understood == plain.understood


@pytest.mark.parametrize(
    "line",
    ["{} = 1", "[{}]", "x = {{ {} = 1 }}", "[[body]]\n{} = 1"],
    ids=["a key", "a table", "an inline table", "a key of a list"],
)
@pytest.mark.parametrize("part", ["a", '"a b"', "'a.b'", "a "])
def test_a_key_of_thousands_of_parts_is_refused_at_once(tmp_path, line, part):
    text = "title = 'x'\n" + line.format(".".join([part] * 50_000))
    (tmp_path / "case.toml").write_text(text)
    began = time.monotonic()
    with pytest.raises(InputError, match=r"a key of more than 64 parts \(at line [23]\)"):
        load_case(tmp_path)
    # Reading it takes a minute.
    assert time.monotonic() - began < 5.0


def test_words_with_many_dots_are_no_keys(tmp_path):
    file = write_template(tmp_path)
    dots = "\n# " + "." * 200 + " . " * 200 + "1.2.3. and so on" * 100
    file.write_text(file.read_text() + dots)
    assert load_case(tmp_path).understood
