"""The two headline claims of the paper, as the command prints them."""

import re

import pytest

from tests.benchmarks import claims

NEXT_DOOR = re.compile(r"omega_0/omega_1 = ([\d.]+), .* (\d+)%; median gains ([\d.]+) and ([\d.]+)")
DANGEROUS = re.compile(r"figure-09 (\w+) (\w+): free ([\d.]+); (.*)")


def test_a_flexible_structure_is_hindered_while_its_neighbour_is_accentuated(tmp_path):
    found = {}
    for line in claims.next_door(tmp_path):
        if match := NEXT_DOOR.match(line):
            ratio, *numbers = map(float, match.groups())
            found[ratio] = numbers
    assert sorted(found) == [0.3, 0.5, 0.7, 1.43, 2.0, 3.33]
    assert found[0.3][0] >= 99.0
    assert found[0.5][0] >= 99.0
    # The further apart the frequencies, the more.
    assert found[0.3][1] < found[0.5][1] < found[0.7][1] < 1.0
    assert found[0.3][2] > found[0.5][2] > found[0.7][2] > 1.0


@pytest.mark.sweep
def test_contact_shifts_the_most_dangerous_frequency(tmp_path, monkeypatch):
    """Of the flexible structure of figure 9 it falls below what is looked at."""
    whole = claims.table_of(tmp_path, "figure-09")
    monkeypatch.setattr(claims, "table_of", lambda folder, name: whole)
    shifted = {}
    for line in claims.most_dangerous(tmp_path):
        if match := DANGEROUS.match(line):
            which, pulse, free, gaps = match.groups()
            at = [float(text) for text in re.findall(r": ([\d.]+) \(", gaps)]
            shifted[which, pulse] = float(free), at
    assert shifted["flexible", "cosine"] == (0.86, [0.25] * 3)
    assert shifted["flexible", "sine"] == (0.44, [0.25] * 3)
    assert all(at < 0.86 for at in shifted["stiff", "cosine"][1])
