"""Sheets of a report: what fits on them."""

import pytest

from eventpound import Case, load_case
from eventpound.report.design_report import Told, design_sheets
from eventpound.report.sheets import as_html, share_of
from eventpound.study.design import made_of_run
from tests.models import CASES
from tests.report.test_design_report import printed
from tests.report.test_html import CHROMIUM


def told(case: Case) -> Told:
    """The report of a single run."""
    return Told(case, *made_of_run(case))


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
@pytest.mark.parametrize("name", ["adjacent-buildings", "pair", "floor-to-column"])
def test_runs_of_unlike_scenes_fit_on_two_pages(name, tmp_path):
    sheets = design_sheets(told(load_case(CASES / name)))
    assert len(sheets) == 2
    assert printed(tmp_path, as_html(name, sheets)) == 2


def test_a_scene_without_contacts_has_a_report(undrawn):
    sheets = design_sheets(told(load_case(CASES / "elastic-record")))
    assert "peak displacement" in as_html("", sheets).decode()


def test_the_first_sheet_of_tall_buildings_has_room_for_its_sketch(tmp_path):
    text = '[excitation]\nkind = "sine"\namplitude = "0.4 g"\nperiod = "0.7 s"\n'
    for name in "AB":
        text += f'[[building]]\nname = "{name}"\nstoreys = 12\nmass = "200 t"\n'
        text += 'stiffness = "300 MN/m"\nyield_force = "0.3 W"\nheight = "3.2 m"\n'
    for i in range(1, 13):
        text += f'[[contact]]\nname = "floor {i}"\nbetween = ["A{i}", "B{i}"]\n'
        text += 'gap = "2 cm"\nrestitution = 0.6\n'
    text += '[solver]\nname = "fast"\nrtol = 1e-6\n[run]\nduration = "1.5 s"\n'
    (tmp_path / "case.toml").write_text(text)
    first, _ = design_sheets(told(load_case(tmp_path)))
    assert share_of(first) > 0.6
