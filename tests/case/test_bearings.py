"""Bearings and piers of decks in plan: the springs that they stand for, and their stiffness."""

import numpy as np
import pytest

from eventpound.case import load_case, read_case
from eventpound.errors import InputError
from eventpound.scene.linkage import linkage_of

TEXT = """
[excitation]
kind = "cosine"
amplitude = "0.3 g"
period = "0.8 s"
[[deck]]
name = "A"
mass = "1200 t"
length = "40 m"
width = "12 m"
skew = "30 deg"
[[pier]]
name = "P"
mass = "200 t"
stiffness = ["60 MN/m", "90 MN/m"]
damping = "300 kN s/m"
[[bearing]]
name = "left"
deck = "A"
side = "left"
count = 3
stiffness = "6 MN/m"
[[bearing]]
name = "right"
deck = "A"
at = [20.0, 0.0]
on = "P"
stiffness = ["4 MN/m", "5 MN/m"]
damping = ["80 kN s/m", 0.0]
"""


def load(tmp_path, text=TEXT):
    (tmp_path / "case.toml").write_text(text)
    return load_case(tmp_path)


def test_the_springs_of_bearings_make_the_stiffness_of_the_deck(tmp_path):
    """On u, v and θ: sums of k, and of k times the arms about the centre."""
    case = load(tmp_path)
    scene = case.scene
    assert [s.name for s in scene.springs] == [
        *(f"{n}.{w}" for n in ("P", "left.1", "left.2", "left.3", "right") for w in "xy")
    ]  # fmt: skip
    assert len(scene.dashpots) == 3
    links = linkage_of(scene, 0.0)
    k = np.array([spring.law.stiffness for spring in scene.springs])
    K, r = links.springs.T * k @ links.springs, scene.decks[0].radius
    deck = scene.decks[0]
    places = [(*deck.on_edge("left", y), 6e6, 6e6) for y in (-4.0, 0.0, 4.0)]
    places.append((20.0, 0.0, 4e6, 5e6))
    turn = sum(kx * y * y + ky * x * x for x, y, kx, ky in places)
    assert K[2, 2] == pytest.approx(22e6)
    assert K[3, 3] == pytest.approx(23e6)
    assert K[4, 4] == pytest.approx(turn / r**2)
    assert K[2, 4] == pytest.approx(-sum(kx * y for _, y, kx, _ in places) / r, abs=1e-6)
    assert K[3, 4] == pytest.approx(sum(ky * x for x, _, _, ky in places) / r)
    assert (K[0, 0], K[0, 2]) == (pytest.approx(64e6), pytest.approx(-4e6))
    assert read_case(case.understood, tmp_path / "case.toml").scene == scene


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('on = "P"', 'on = "Q"', "[[bearing]] 2 (right): on: found 'Q'; accepted"),
        ('side = "left"', 'side = "top"', "side: found 'top'; accepted"),
        ("at = [20.0, 0.0]", "at = 20.0", "at: found 20.0; accepted: a place [x, y]"),
        ('deck = "A"\nside', 'deck = "B"\nside', "deck: found 'B'"),
        ('"300 kN s/m"', '"-300 kN s/m"', "numbers that are not negative"),
        ('mass = "200 t"', "mass = 0.0", "[[pier]] 1 (P): mass: found 0.0; accepted: a positive"),
        ("count = 3", "number = 3", "number: unknown key"),
    ],
)
def test_wrong_bearings(tmp_path, old, new, said):
    assert old in TEXT
    with pytest.raises(InputError) as caught:
        load(tmp_path, TEXT.replace(old, new))
    assert said in str(caught.value)
