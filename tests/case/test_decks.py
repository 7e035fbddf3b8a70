"""Decks and joints of a case: what they stand for, and what is said of what is wrong."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from eventpound import Study, simulate, simulate_suite
from eventpound.case import load_case, read_case
from eventpound.case.case import member_case
from eventpound.errors import InputError
from eventpound.scene.parameters import number_places, with_values
from eventpound.scene.scene import Scene
from tests.models import CASES

DECKS = """
[[deck]]
name = "A"
mass = "1200 t"
length = "40 m"
width = "12 m"
skew = "30 deg"
initial = { displacement = ["1 mm", 0.0], velocity = [0.0, "2 cm/s"], rotation = 1e-4, spin = 0.0 }
[[deck]]
name = "B"
mass = "1000 t"
length = "36 m"
width = "12 m"
skew = "30 deg"
inertia = "1.5e5 t m^2"
[[joint]]
name = "west"
between = ["barrier", "A"]
gap = ["5 cm", "6 cm"]
restitution = 0.5
[[joint]]
between = ["A", "B"]
gap = "4 cm"
restitution = 0.6
"""
PULSE = """
[excitation]
kind = "ricker"
amplitude = "0.4 g"
period = "0.8 s"
"""


def load(tmp_path: Path, text: str) -> Scene:
    (tmp_path / "case.toml").write_text(text)
    return load_case(tmp_path).scene


def problems(tmp_path: Path, text: str) -> str:
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    return str(caught.value)


def test_what_decks_and_joints_stand_for(tmp_path: Path) -> None:
    scene = load(tmp_path, PULSE + DECKS)
    a, b = scene.decks
    assert [body.name for body in scene.bodies] == [
        "A.x", "A.y", "A.turn", "B.x", "B.y", "B.turn"
    ]  # fmt: skip
    assert [body.direction for body in scene.bodies[:3]] == ["x", "y", "turn"]
    assert scene.bodies[0].displacement == 0.001
    assert scene.bodies[1].velocity == 0.02
    assert scene.bodies[2].displacement == pytest.approx(1e-4 * a.radius)
    # End to end along x, the gap at right angles to the edges.
    assert b.centre == (pytest.approx(38.0 + 0.04 / math.cos(math.pi / 6)), 0.0)
    assert b.radius == pytest.approx(math.sqrt(150.0))
    assert [c.name for c in scene.contacts] == [
        "west.lower", "west.upper", "A-B.lower", "A-B.upper"
    ]  # fmt: skip
    assert [c.gap for c in scene.contacts] == [0.05, 0.06, 0.04, 0.04]


def test_a_deck_that_is_moved_alike_keeps_or_loses_its_gap(tmp_path: Path) -> None:
    """A small rigid motion of both decks about one centre changes no gap; along x one does."""
    scene = load(tmp_path, PULSE + DECKS)
    contact = scene.contacts[2]
    turn, rate = 1e-3, dict.fromkeys((b.name for b in scene.bodies), 0.0)
    for deck in scene.decks:
        x, y = deck.centre
        rate |= {
            f"{deck.name}.x": -turn * y,
            f"{deck.name}.y": turn * x,
            f"{deck.name}.turn": deck.radius * turn,
        }
    # Their places are apart by the gap along x.
    gap_along = 0.04 / math.cos(math.pi / 6)
    change = sum(part * rate[name] for name, part in contact.direction)
    assert change == pytest.approx(turn * gap_along * math.sin(math.pi / 6), rel=1e-9)
    assert sum(p for n, p in contact.direction if n == "B.x") == pytest.approx(
        math.cos(math.pi / 6)
    )


def test_the_law_of_impact_stands_at_the_top(tmp_path: Path) -> None:
    rubs = PULSE + DECKS.replace("restitution = 0.5", "restitution = 0.5\nfriction = 0.3")
    assert load(tmp_path, rubs).impact_law == "newton"
    (tmp_path / "case.toml").write_text('impact_law = "poisson"' + rubs)
    case = load_case(tmp_path)
    assert case.scene.impact_law == "poisson"
    assert read_case(case.understood, tmp_path / "case.toml").scene.impact_law == "poisson"
    said = problems(tmp_path, 'impact_law = "poison"' + rubs)
    assert "impact_law: found 'poison', did you mean 'poisson'?; accepted: one" in said
    said = problems(tmp_path, 'impact_law = "poisson"' + PULSE + DECKS)
    assert "impact_law: found poisson; accepted: newton where no contact has friction" in said


def test_the_case_that_was_understood_is_the_same(tmp_path: Path) -> None:
    pulse = PULSE.replace("ricker", "cosine")
    text = pulse + 'attack = "20 deg"\nacross = { amplitude = "0.2 g", period = "0.7 s" }\n' + DECKS
    (tmp_path / "case.toml").write_text(text)
    case = load_case(tmp_path)
    again = read_case(case.understood, tmp_path / "case.toml")
    assert again.scene == case.scene
    assert again.understood == case.understood
    assert case.scene.attack == math.radians(20.0)


def write_record(file: Path, peak: float, count: int = 200) -> None:
    t = 0.01 * np.arange(count)
    rows = "\n".join(f"{s:.2f},{peak * math.sin(9.0 * s):.8f}" for s in t)
    file.parent.mkdir(exist_ok=True)
    file.write_text(f"time (s),acceleration (m/s^2)\n{rows}\n")


SPRING = """
[[spring]]
between = ["ground", "A.x"]
law = "linear"
stiffness = "40 MN/m"
[[joint]]
"""
PERIOD = 2.0 * math.pi * math.sqrt(1.2e6 / 40e6)
RECORD = '[excitation]\nkind = "record"\n'


def test_both_components_of_a_record_have_one_factor(tmp_path: Path) -> None:
    write_record(tmp_path / "x.csv", 2.0)
    write_record(tmp_path / "y.csv", 1.0)
    text = RECORD + 'file = "x.csv"\npga = "0.3 g"\n'
    scene = load(tmp_path, text + 'across = { file = "y.csv" }\n' + DECKS)
    assert scene.across.factor == scene.motion.factor
    places = number_places(scene)
    more = with_values(scene, {places["excitation.pga"]: 0.6 * 9.80665})
    assert more.across.factor == pytest.approx(2.0 * scene.across.factor)
    own = load(tmp_path, text + 'across = { file = "y.csv", scale = 3.0 }\n' + DECKS)
    assert own.across.factor == 3.0
    turned = with_values(scene, {places["excitation.attack"]: 0.5})
    assert turned.attack == 0.5


@pytest.fixture
def pairs(tmp_path: Path) -> Path:
    """Two records, each with a second component."""
    for i in (1, 2):
        write_record(tmp_path / "x" / f"{i}.csv", 2.0 * i)
        write_record(tmp_path / "y" / f"{i}.csv", 1.0 * i)
    write_record(tmp_path / "short.csv", 1.0, 150)
    return tmp_path


@pytest.mark.parametrize("own", ["", ', pga = "0.1 g"'])
def test_records_of_a_suite_go_with_their_second_components(pairs: Path, own: str) -> None:
    rest = f'pga = "0.3 g"\nattack = 0.2\n{DECKS}\n[run]\nduration = 1.0\n'
    (pairs / "case.toml").write_text(
        f'{RECORD}suite = "x/*.csv"\nacross = {{ suite = "y/*.csv"{own} }}\n{rest}'
    )
    case = load_case(pairs)
    assert read_case(case.understood, pairs / "case.toml").understood == case.understood
    table = simulate_suite(case, solver="fast")
    for i, member in enumerate(case.members, 1):
        single = f'{RECORD}file = "x/{i}.csv"\nacross = {{ file = "y/{i}.csv"{own} }}\n{rest}'
        (pairs / "case.toml").write_text(single)
        alone = load_case(pairs)
        of_suite = member_case(case, member, member.read())
        for one in (of_suite, read_case(of_suite.understood, pairs / "case.toml")):
            assert np.array_equal(one.scene.motion.values, alone.scene.motion.values)  # type: ignore[attr-defined]
            assert np.array_equal(one.scene.across.values, alone.scene.across.values)  # type: ignore[attr-defined]
            assert one.scene.attack == 0.2
        row, response = table.iloc[i - 1], simulate(alone, "fast", error_estimate=False)
        assert row["PGA.across"] == pytest.approx(np.abs(alone.scene.across.values).max())  # type: ignore[attr-defined]
        assert row["file.across"].endswith(f"y/{i}.csv")
        assert row["peaks.A.y.abs_max"] == response.peaks.loc["A.y", "abs_max"]


@pytest.mark.parametrize(
    "size", ["scale = [1.0, 0.5]", 'pga = "0.3 g"', 'psa = ["0.4 g", "0.2 g"]\npsa_period = "T1"']
)
def test_each_shock_has_one_factor_for_both_components(pairs: Path, size: str) -> None:
    size += DECKS.replace("[[joint]]", SPRING, 1)
    files = (
        'file = ["x/1.csv", "x/2.csv"]\nrest = 2.0\nacross = { file = ["y/1.csv", "y/2.csv"] }\n'
    )
    scene = load(pairs, RECORD + files + size)
    assert [f for _, f in scene.across.shocks] == [f for _, f in scene.motion.shocks]
    # The second components are halves of the first.
    np.testing.assert_allclose(scene.across.values, scene.motion.values / 2.0, rtol=1e-6, atol=1e-9)


def test_components_of_a_shock_may_differ_by_some_samples(pairs: Path) -> None:
    files = (
        'file = ["x/1.csv", "x/2.csv"]\nrest = 2\nacross = { file = ["short.csv", "y/2.csv"] }\n'
    )
    scene = load(pairs, RECORD + files + DECKS)
    assert np.array_equal(scene.across.begins, scene.motion.begins)
    t = np.linspace(scene.motion.begins[1], scene.motion.end, 500)
    np.testing.assert_allclose(
        scene.across.acceleration(t), scene.motion.acceleration(t) / 2.0, atol=1e-7
    )


def test_a_run_lasts_until_both_components_are_over(pairs: Path) -> None:
    for first, second in (("x/1", "short"), ("short", "x/1")):
        text = f'{RECORD}file = "{first}.csv"\nacross = {{ file = "{second}.csv" }}\n'
        (pairs / "case.toml").write_text(text + DECKS.replace("[[joint]]", SPRING, 1))
        assert load_case(pairs).run.duration == pytest.approx(1.99 + 5.0 * PERIOD)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('suite = "x/*.csv"\nacross = { file = "short.csv" }', "across: found one motion beside a"),
        ('file = "x/1.csv"\nacross = { suite = "y/*.csv" }', "across: found a suite beside one"),
        ('suite = "x/*.csv"\nacross = { suite = "?.csv" }', "across: suite: found '?.csv', but no"),
        ('suite = "x/*.csv"\nacross = { suite = "sh*" }', "across: found 1 records for the 2 of"),
        ('file = "x/1.csv"\nacross = { file = "y/1.csv", attack = 1 }', "across.attack: unknown"),
        (
            'file = "x/1.csv"\nacross = { file = "y/1.csv", psa = 1.0, psa_period = "T1" }',
            "across.psa_period: found 'T1'; accepted: a period",
        ),
        (
            'file = ["x/1.csv", "x/2.csv"]\nrest = 2\nacross = { file = ["short.csv"] }',
            "across: found 1 records for the 2 of the first component",
        ),
        (
            'file = ["short.csv", "x/2.csv"]\nrest = 0.1\n'
            'across = { file = ["x/1.csv", "x/2.csv"] }',
            "across: found 1.csv, which goes on when the next shock of the first",
        ),
    ],
)
def test_second_components_unlike_the_first(pairs: Path, text: str, said: str) -> None:
    assert said in problems(pairs, f"{RECORD}{text}\n{DECKS}")


def test_a_support_has_one_component(pairs: Path) -> None:
    for key in ('across = { file = "y/1.csv" }', "attack = 0.1"):
        own = f'excitation = {{ kind = "record", file = "x/1.csv", {key} }}'
        text = f'{PULSE}[[body]]\nname = "b"\nmass = 1.0\n[[support]]\nname = "s"\n{own}\n'
        assert f"excitation.{key.split()[0]}: unknown key" in problems(pairs, text)


def test_a_study_knows_its_second_component(pairs: Path) -> None:
    """It goes on where it stopped only if that is as it was."""
    text = f'{RECORD}file = "x/1.csv"\nacross = {{ file = "y/1.csv" }}\n{DECKS}'
    digests = set()
    for peak in (1.0, 1.1):
        write_record(pairs / "y" / "1.csv", peak)
        (pairs / "case.toml").write_text(text + "[run]\nduration = 1.0\n")
        digests.add(Study(load_case(pairs), {"excitation.attack": [0.0, 0.5]}).plan.digest)
    assert len(digests) == 2


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('length = "40 m"', "length = -1.0", "[[deck]] 1 (A): length: found -1.0; accepted: a pos"),
        ('skew = "30 deg"\ninit', 'skew = "85 deg"\ninit', "an angle within 80 degrees of zero"),
        ('name = "B"', 'name = "A"', "[[deck]] 2 (A): name: found 'A'; accepted: a name of its"),
        ('["A", "B"]', '["A", "C"]', "[[joint]] 2: between: found 'C'; accepted: two different on"),
        ('["A", "B"]', '["A", "A"]', "between: found 'A' twice; accepted: two different decks"),
        ("restitution = 0.6", "restitution = 1.6", "[[joint]] 2: restitution: found 1.6; accepte"),
        ('gap = "4 cm"', 'gap = ["4 cm"]', "gap: found ['4 cm']; accepted: a gap, or those"),
        ('skew = "30 deg"\ninertia', 'skew = "20 deg"\ninertia', "skews of 30 and 20 degrees"),
        ('inertia = "1.5e5 t m^2"', 'inertia = "1.5 m"', "is no unit of moment of inertia"),
        ("rotation = 1e-4", "turn = 1e-4", "initial.turn: unknown key"),
        ('mass = "1000 t"', 'mass = "1000 t"\ncentre = [41.0, 0.0]', "centre: missing; accepted"),
    ],
)
def test_wrong_decks_and_joints(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = PULSE + DECKS
    assert old in text
    assert said in problems(tmp_path, text.replace(old, new))


def test_decks_that_are_not_where_the_gap_is(tmp_path: Path) -> None:
    text = DECKS.replace('name = "A"\n', 'name = "A"\ncentre = [0.0, 0.0]\n')
    text = text.replace('name = "B"\n', 'name = "B"\ncentre = [40.0, 0.0]\n')
    assert "part their edges by 1.73205 m" in problems(tmp_path, PULSE + text)


def test_no_supports_and_no_second_component_of_what_is_on_a_line(tmp_path: Path) -> None:
    support = '[[support]]\nname = "s"\ndelay = 0.1\n'
    assert "none in a scene in plan" in problems(tmp_path, PULSE + DECKS + support)
    body = '[[body]]\nname = "b"\nmass = 1.0\n'
    across = PULSE + 'across = { amplitude = "0.2 g", period = "0.7 s" }\n'
    assert "no body moves across" in problems(tmp_path, across + body)


def test_a_contact_at_a_place_of_a_deck(tmp_path: Path) -> None:
    contact = (
        '[[contact]]\nbetween = [{ deck = "A", at = [20.0, 6.0], normal = [0.0, 1.0] }, "barrier"]'
        "\ngap = 0.01\nrestitution = 0.5\n"
    )
    scene = load(tmp_path, PULSE + DECKS + contact)
    assert scene.contacts[0].name == "A-barrier"
    parts = dict(scene.contacts[0].direction)
    assert parts == {"A.y": -1.0, "A.turn": -20.0 / scene.decks[0].radius, "barrier": 1.0}
    wrong = contact.replace("[0.0, 1.0]", "[0.0, 2.0]")
    assert "a normal of length one" in problems(tmp_path, PULSE + DECKS + wrong)
    assert "of the decks A, B" in problems(tmp_path, PULSE + DECKS + contact.replace('"A"', '"C"'))


@pytest.mark.parametrize("mass", ['mass = "0 t"', 'mass = "-1 t"', 'mass = "1 t"\ninertia = -1.0'])
def test_a_deck_without_mass_or_moment_is_refused(tmp_path, mass):
    text = (CASES / "skew-deck" / "case.toml").read_text()
    (tmp_path / "case.toml").write_text(text.replace('mass = "900 t"', mass))
    with pytest.raises(InputError, match=r"case\.toml: \[\[deck\]\].*a positive (mass|moment)"):
        load_case(tmp_path)
