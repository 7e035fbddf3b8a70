"""Published PGA, T_m, Arias intensity, PGV and duration of the same digital files."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.motion import published as published_module
from tests.motion.published import Published, published_with_slammer
from tests.motion.readers.real_records import FOLDER


def _all() -> list[Published]:
    return published_with_slammer() if FOLDER.is_dir() else []


@pytest.mark.skipif(not FOLDER.is_dir(), reason=f"there are no real records in {FOLDER}")
@pytest.mark.parametrize("published", _all(), ids=lambda published: published.name)
def test_published_numbers_are_met_to_their_print(published: Published) -> None:
    for name, ours, printed, decimals, conventions in published.pairs():
        allowed = 0.5 * 10.0**-decimals * (1.0 + 1e-6) + conventions
        assert abs(ours - float(printed)) <= allowed, name


def test_the_program_says_that_it_skips_where_there_are_no_records(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(published_module, "FOLDER", tmp_path / "none")
    published_module.main()
    assert capsys.readouterr().out.startswith("skipped: there are no real records in")
