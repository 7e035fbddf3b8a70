"""Units that a case chooses for its design numbers."""

import json
import re
from pathlib import Path

import pandas as pd
import pytest

from eventpound import InputError, design_numbers, load_case, simulate
from eventpound.case.loading import read_case
from eventpound.cli import main
from eventpound.report.design_report import Told, design_sheets
from eventpound.report.sheets import as_html
from eventpound.results.shown_units import Units
from tests.models import CASES
from tests.study.test_suite import CASE, time_series

GRAVITY = 9.80665
ACCEPTED = (
    "accepted: a list of texts, at most one unit each of force (N, kN, MN, kip), "
    "length (m, cm, mm, in), acceleration (m/s^2, g)"
)


def written(folder: Path, units: str) -> Path:
    """A deck that strikes a wall, told in units."""
    (folder / "a.txt").write_text(time_series(0.5))
    text = CASE.format('file = "a.txt"\nunits = "g"\ntime_step = "0.02 s"')
    (folder / "case.toml").write_text(f"{text}[run]\n{units}\n")
    return folder


@pytest.mark.parametrize(
    ("chosen", "value", "unit", "words"),
    [
        ((), 1.5e6, "N", "1500 kN"),
        (("MN",), 1.5e6, "N", "1.50 MN"),
        (("MN",), 1.5e6, "N s", "1.50 MN s"),
        (("MN",), 1.5e6, "J", "1.50 MJ"),
        (("N",), 1.5e6, "J", "1500000 J"),
        (("MN",), 0.0127, "m", "12.7 mm"),
        (("cm", "MN"), 0.0127, "m", "1.27 cm"),
        (("m/s^2",), 0.5 * GRAVITY, "m/s^2", "4.90 m/s²"),
        (("cm",), 0.5 * GRAVITY, "m/s^2", "0.500 g"),
        (("MN", "cm", "m/s^2"), 0.75, "m/s", "0.750 m/s"),
    ],
)
def test_a_chosen_unit_stands_for_its_dimension_and_those_that_follow(chosen, value, unit, words):
    assert Units(heavy=True, chosen=chosen).words(value, unit) == words


def test_what_is_nothing_is_so_in_every_unit():
    """A millionth of N and of mm is what rounding leaves; in MN and m it is no other."""
    for value, unit in ((2e-6, "N"), (2e-9, "m")):
        usual, large = (Units(False, chosen).number(value, unit) for chosen in ((), ("MN", "m")))
        assert float(usual) == pytest.approx(2e-6)
        assert float(large) == pytest.approx(value / {"N": 1e6, "m": 1.0}[unit])
        assert Units(False, ("MN", "m")).number(value / 4.0, unit) == "0"


def test_a_yield_force_that_is_small_in_its_unit_is_told(tmp_path, undrawn):
    text = (CASES / "pair" / "case.toml").read_text().replace("500 t", "0.5 kg")
    (tmp_path / "case.toml").write_text(
        text.replace("490.3 kN", "0.5 N") + '\n[run]\nunits = ["MN"]\n'
    )
    case = load_case(tmp_path)
    response = simulate(case, error_estimate=False)
    sheets = design_sheets(Told(case, design_numbers(case), response))
    # F_y = Q / (1 - alpha), of 1 / (1 - 4.93 / 54.9).
    assert ">0.000000549<" in as_html("", sheets).decode()


def test_the_report_and_the_screen_are_in_the_units_of_the_case(tmp_path, capsys, undrawn):
    folder = written(tmp_path, 'units = ["MN", "cm", "m/s^2"]')
    assert main(["report", str(folder)]) == 0
    printed = capsys.readouterr().out
    report = (folder / "results" / "report" / "report.html").read_text(encoding="utf-8")
    told = re.sub(r"<style.*?</style>|<[^>]*>|data:[^\"]*", " ", report, flags=re.DOTALL)
    assert "gap 1.27 cm" in printed
    assert "largest impulse, MN s" in printed
    assert "acceleration, m/s²" in printed
    assert "peak 4.90 m/s²" in told
    for text in (printed, told):
        assert not re.search(r"\b(mm|kN|kN s|g)\b", text.partition("Limits")[0]), text
    assert main(["run", str(folder), "--no-figures"]) == 0
    assert re.search(r"opening [\d.]+ cm, .*impulse [\d.]+ MN s", capsys.readouterr().out)


def test_files_of_numbers_stay_in_si(tmp_path):
    tables = []
    for units in ("", 'units = ["MN", "cm", "m/s^2"]'):
        assert main(["report", str(written(tmp_path, units)), "--no-pages"]) == 0
        tables.append(pd.read_csv(tmp_path / "results" / "report" / "report.csv"))
    pd.testing.assert_frame_equal(*tables)


def test_a_suite_in_other_units_is_not_run_again(tmp_path, capsys):
    results = tmp_path / "results" / "report"
    for units in ("cm", "mm"):
        case = written(tmp_path, f'units = ["{units}"]') / "case.toml"
        case.write_text(case.read_text().replace("file = ", "suite = "))
        assert main(["report", str(tmp_path), "--no-pages"]) == 0
        assert f"opening, {units}" in capsys.readouterr().out
    assert not list(results.glob("earlier-*"))


def test_a_case_that_was_understood_keeps_its_units(tmp_path):
    case = load_case(written(tmp_path, 'units = ["cm", "MN"]'))
    again = json.loads(json.dumps(case.understood))
    assert read_case(again, tmp_path / "case.toml").run.stated.units == ("cm", "MN")


@pytest.mark.parametrize(
    "units",
    ['["lbf"]', '["cm", "mm"]', '["kN", "kN"]', '["kN", "s"]', '"kN"', "[]", "[1]", '[["kN"]]'],
)
def test_other_words_are_refused_in_one_message(tmp_path, units):
    with pytest.raises(InputError) as caught:
        load_case(written(tmp_path, f"units = {units}"))
    found = units.replace('"', "'")
    assert caught.value.problems == [
        f"{tmp_path / 'case.toml'}: [run]: units: found {found}; {ACCEPTED}"
    ]


def test_customary_units_are_told():
    """1 kip is 1000 lbf of 4.4482216152605 N, an inch 25.4 mm."""
    units = Units(True, ("kip", "in"))
    assert units.words(4448.2216152605, "N") == "1.00 kip"
    assert units.words(0.0254, "m") == "1.00 in"
    assert units.words(4448.2216152605, "N s") == "1.00 kip s"
    assert units.words(4448.2216152605 * 0.0254, "J") == "1.00 kip in"
