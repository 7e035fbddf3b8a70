"""Cases written in Π-terms."""

import math
from pathlib import Path

import pytest

from eventpound import InputError, load_case
from eventpound.scene.pi_terms import pi_terms

TEXT = """
[excitation]
kind = "cosine"
{excitation}

[pi]
structure = "bilinear"
omega_s = 0.5
uy = "20 %"
Q = 0.4
delta = 0.5
epsilon = 0.6
periods = 20
{pi}
"""


def load(folder: Path, excitation: str = "", pi: str = "", after: str = ""):
    file = folder / "case.toml"
    file.write_text(TEXT.format(excitation=excitation, pi=pi) + after)
    return load_case(file)


def test_scales_are_one_where_they_are_not_given(tmp_path):
    case = load(tmp_path)
    scales = case.scene.motion.scales()
    assert (scales.a_g, scales.omega_g) == (1.0, 1.0)
    assert case.run.duration == pytest.approx(20 * 2 * math.pi, rel=1e-15)
    expected = {"omega_s": 0.5, "uy": 0.2, "Q": 0.4, "delta": 0.5, "epsilon": 0.6}
    assert pi_terms(case.scene) == pytest.approx(expected, rel=1e-14)


def test_scales_may_be_any(tmp_path):
    case = load(tmp_path, 'amplitude = "0.4 g"\nperiod = "0.8 s"')
    assert case.scene.motion.scales().a_g == 0.4 * 9.80665
    assert case.run.duration == pytest.approx(16.0, rel=1e-15)
    assert pi_terms(case.scene)["Q"] == pytest.approx(0.4, rel=1e-14)


def test_a_frequency_instead_of_a_period(tmp_path):
    case = load(tmp_path, 'frequency = "2 rad/s"')
    assert case.run.duration == pytest.approx(20 * math.pi, rel=1e-15)


def test_neighbours(tmp_path):
    case = load(tmp_path, pi='row = [1, 0, 2]\n"omega_s.i" = 2.0\n"omega_s.2" = 4.0')
    assert [(c.left, c.right) for c in case.scene.contacts] == [("1", "0"), ("0", "2")]
    terms = pi_terms(case.scene)
    assert terms["omega_s.1"] == pytest.approx(2.0, rel=1e-14)
    assert terms["omega_s.2"] == pytest.approx(4.0, rel=1e-14)


def test_what_was_understood_is_the_case(tmp_path):
    from eventpound.case import read_case

    case = load(tmp_path)
    assert read_case(case.understood, tmp_path / "case.toml").scene == case.scene


@pytest.mark.parametrize(
    ("pi", "after", "words"),
    [
        ("typo = 1", "", ["[pi]: typo: unknown key"]),
        ("row = [0, 2]", "", ["[pi]: row: found ['0', '2']"]),
        ('row = "0"', "", ["[pi]: row: found '0'"]),
        ("row = [0, 1]", "", ["omega_s.1: missing"]),
        ('"uy.1" = 1', "", ["[pi]: uy.1: unknown key"]),
        ("", "[run]\nduration = 3", ["[run]: duration", "periods"]),
        ("", '[[body]]\nname = "a"\nmass = 1', ["[[body]]", "beside [pi]"]),
    ],
)
def test_problems_are_named(tmp_path, pi, after, words):
    with pytest.raises(InputError) as caught:
        load(tmp_path, pi=pi, after=after)
    for word in words:
        assert word in str(caught.value)


def test_a_restitution_beyond_one_is_refused(tmp_path):
    file = tmp_path / "case.toml"
    text = TEXT.format(excitation="", pi="").replace("epsilon = 0.6", "epsilon = 1.6")
    file.write_text(text.replace('"bilinear"', '"rubber"'))
    with pytest.raises(InputError, match=r"found 'rubber'.*elastic, elastoplastic, bilinear"):
        load_case(file)
    file.write_text(text)
    with pytest.raises(InputError, match=r"restitution: found 1\.6"):
        load_case(file)
