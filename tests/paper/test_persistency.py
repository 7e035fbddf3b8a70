"""The range of L_e that the paper's records have, and the correlations within it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eventpound import load_case
from eventpound.scene import BoucWen
from tests.paper import persistency


def test_the_bounds_are_those_of_section_6() -> None:
    scene = load_case(persistency.CASES / "figure-12").scene
    laws = [s.law for s in scene.springs if isinstance(s.law, BoucWen)]
    first, second = (law.yield_displacement for law in laws)
    assert scene.contacts[0].gap / 0.5 == persistency.BOUNDS["L_e < 2.54 cm"]
    # Of the three bounds that of the stiff frame is taken; the flexible one's is a little more.
    assert first / 0.5 == pytest.approx(persistency.BOUNDS["L_e < 3.1 cm"], abs=5e-5)
    assert persistency.BOUNDS["L_e < 3.1 cm"] < second / 1.2 < 0.0314


def test_a_row_holds_the_records_below_its_bound() -> None:
    """Peaks that L_e orders below 2.54 cm, and that fall above it, among the lower ones."""
    length = np.linspace(0.001, 0.06, 60)
    u = np.where(length < 0.0254, length, 0.03 - length / 2.0)
    columns = {"failed": "", "L_e": length, "PGA": 1.0 / length, "T_m": length}
    table = pd.DataFrame(columns | {f"peaks.{body}.abs_max": u for body in persistency.BODIES})
    rows = [[c.strip() for c in row.split("|")] for row in persistency.rows("eq. 2", table)]
    below = [row for row in rows if row[3] == "L_e < 2.54 cm"]
    assert [row[5:7] for row in below] == [["1.00", "-1.00"]] * 2
    assert {row[4] for row in below} == {str(int((length < 0.0254).sum()))}
    assert all(float(row[5]) < 0.0 for row in rows if row[3] == "all")


def test_nothing_is_said_of_real_records_where_there_are_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(persistency, "INDEX", tmp_path / "index.csv")
    with pytest.raises(SystemExit, match=r"index\.csv: no real records there; give a LIST"):
        persistency.main()
    assert capsys.readouterr().out == ""


def test_the_motions_are_named_before_the_table(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(persistency, "tables", lambda files: {})
    persistency.main("mine.csv")
    assert capsys.readouterr().out.startswith("records of mine.csv\n\n| damping |")
