"""The report of design numbers: two sheets of A4, in units of the trade, from matplotlib alone."""

import json
import re
import shutil
import subprocess
from contextlib import nullcontext
from itertools import pairwise
from pathlib import Path

import pandas as pd
import pytest
from matplotlib.image import imread

from eventpound import Body, Contact, InputError, Linear, Scene, Spring, load_case
from eventpound.case import read_case
from eventpound.case.case import case_of, member_case
from eventpound.cli import main
from eventpound.report.design_report import model_blocks
from eventpound.report.model_layout import layout_of
from eventpound.report.record_tables import scaling_words
from eventpound.report.sheets import Columns
from eventpound.results.inputs import inputs_of
from eventpound.results.shown_units import units_of_scene
from eventpound.results.tables import Cells
from tests.blank import blank_figures
from tests.report.test_html import CHROMIUM, Balanced
from tests.results.test_workbook import read as read_workbook
from tests.study.test_suite import time_series

APPENDIX = '<section class="appendix">'
HEAD = """\
title = "Three-span bridge on two piers"
[excitation]
kind = "record"
suite = "?.txt"
units = "g"
time_step = "0.02 s"
psa = "0.5 g"
psa_period = "T1 of deck 2"
"""
PARTS = {
    "body": [("deck 1", 900), ("deck 2", 1400), ("deck 3", 900), ("pier A", 160), ("pier B", 160)],
    "bearing": [
        *(("ground", "deck 1", 6), ("pier A", "deck 1", 9), ("pier A", "deck 2", 40)),
        *(("pier B", "deck 2", 40), ("pier B", "deck 3", 9), ("deck 3", "ground", 6)),
    ],
    "joint": [
        *(("barrier", "deck 1", 80), ("deck 1", "deck 2", 60)),
        *(("deck 2", "deck 3", 60), ("deck 3", "barrier", 80)),
    ],
}


def bridge() -> str:
    """Three decks on bearings on two piers and two abutments, with a gap at each end of each."""
    text = HEAD + "".join(
        f'[[body]]\nname = "{name}"\nmass = "{mass} t"\n' for name, mass in PARTS["body"]
    )
    for pier in ("pier A", "pier B"):
        text += (
            f'[[spring]]\nname = "column {pier[-1]}"\nbetween = ["ground", "{pier}"]\n'
            'law = "bouc-wen"\ninitial_stiffness = "120 MN/m"\nyield_force = "3200 kN"\n'
            "hardening = 0.03\n"
        )
    for i, (first, second, k) in enumerate(PARTS["bearing"], 1):
        text += (
            f'[[spring]]\nname = "bearing {i}"\nbetween = ["{first}", "{second}"]\n'
            f'law = "linear"\nstiffness = "{k} MN/m"\n'
        )
    for i, (left, right, gap) in enumerate(PARTS["joint"], 1):
        text += (
            f'[[contact]]\nname = "joint {i}"\nbetween = ["{left}", "{right}"]\n'
            f'gap = "{gap} mm"\nrestitution = 0.6\n'
        )
    return text


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bridge")
    for name, amplitude in (("a", 0.2), ("b", 0.5), ("c", 0.8)):
        (folder / f"{name}.txt").write_text(time_series(amplitude))
    (folder / "case.toml").write_text(bridge())
    # Only a browser looks at what is drawn.
    with nullcontext() if CHROMIUM else blank_figures():
        assert main(["report", str(folder)]) == 0
    return folder / "results" / "report"


def pages(pdf: bytes) -> int:
    return len(re.findall(rb"/Type\s*/Page[^s]", pdf))


def printed(folder: Path, html: bytes) -> int:
    """Pages that a browser makes of it."""
    (folder / "page.html").write_bytes(html)
    words = ["--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"]
    file = folder / "page.pdf"
    subprocess.run(
        [CHROMIUM, *words, f"--print-to-pdf={file}", str(folder / "page.html")],
        check=True,
        capture_output=True,
        timeout=120,
    )
    return pages(file.read_bytes())


def test_the_command_writes_two_sheets_without_a_browser(suite):
    assert pages((suite / "report.pdf").read_bytes()) == 2
    text = (suite / "report.html").read_text(encoding="utf-8")
    parser = Balanced()
    parser.feed(text)
    assert parser.open == []
    assert parser.links == [f"#{name}" for name in parser.ids]
    assert all(source.startswith(("data:", "#")) for source in parser.sources)
    assert text.count('<section class="sheet">') == 2


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_a_browser_prints_two_pages_of_it(suite, tmp_path):
    sheets, *_ = (suite / "report.html").read_text(encoding="utf-8").partition(APPENDIX)
    assert printed(tmp_path, sheets.encode()) == 2


def test_it_speaks_as_the_trade_does(suite):
    text = (suite / "report.html").read_text(encoding="utf-8")
    sheets, *_ = text.partition(APPENDIX)
    plain = re.sub(r"<svg.*?</svg>|<style.*?</style>", "", sheets, flags=re.DOTALL)
    numbers = re.findall(r"<td>([^<]+)</td>", plain)
    assert len(numbers) > 100
    for number in numbers:
        digits = number.replace(".", "").lstrip("-0")
        assert "e" not in digits, number
        assert len(digits.rstrip("0")) <= 3, number
    assert not re.search(r"\bPi\b|Π|L_e|docs/|case\.toml|m/s\^2", plain)
    for word in ("separation needed", "ductility", "kN s", "every record to a PSA of 0.500 g"):
        assert word in plain
    assert "3 records are few" in plain


def test_it_says_what_is_left_out(suite, tmp_path, undrawn):
    for file in suite.parents[1].glob("*.t*"):
        shutil.copy(file, tmp_path)
    (tmp_path / "d.txt").write_text("0.1\nNaN\n")
    assert main(["report", str(tmp_path)]) == 0
    text = (tmp_path / "results" / "report" / "report.html").read_text(encoding="utf-8")
    assert "Left out, because it failed: d.txt: " in text


def test_decks_stand_on_bearings_on_piers(suite):
    scene = load_case(suite.parents[1]).scene
    boxes = layout_of(scene).boxes
    decks, piers = (
        [boxes[f"{kind} {i}"] for i in names] for kind, names in (("deck", "123"), ("pier", "AB"))
    )
    assert [box.x for box in decks] == sorted(box.x for box in decks)
    for i, pier in enumerate(piers):
        assert pier.top < decks[0].bottom
        assert decks[i].x < pier.x < decks[i + 1].x


def test_a_long_row_fills_the_sheet_of_its_model():
    """Bodies and contacts beside springs, with the rows that there is room for."""
    names = [f"deck {i}" for i in range(30)]
    scene = Scene(
        [Body(name, "900 t") for name in names],
        [Spring(name, ("ground", name), Linear("9 MN/m")) for name in names],
        contacts=[Contact(b, a, b, "8 cm", 0.6) for a, b in pairwise(names)],
    )
    shown = []
    for parts in (21, 40):
        (beside,) = [b for b in model_blocks(case_of(scene), parts=parts) if isinstance(b, Columns)]
        shown.append([[len(t.rows) for t in column if isinstance(t, Cells)]
                      for column in beside.columns])  # fmt: skip
    assert shown == [[[21, 21], [21]], [[30, 29], [30]]]


def test_the_sources_of_numbers_stand_in_the_model(tmp_path, undrawn):
    (tmp_path / "a.txt").write_text(time_series(0.3))
    text = bridge().replace('gap = "80 mm"', 'gap = "80 mm"\nsource = "drawing B-12"', 1)
    (tmp_path / "case.toml").write_text(text)
    case = load_case(tmp_path)
    (member,) = case.suite.members(tmp_path)
    one = member_case(case, member, member.read())
    for each in (case, one, read_case(one.understood, tmp_path / "case.toml")):
        sources = [contact.get("source") for contact in inputs_of(each)["contacts"]]
        assert sources == ["drawing B-12", None, None, None]
    assert main(["report", str(tmp_path)]) == 0
    page = (tmp_path / "results" / "report" / "report.html").read_text(encoding="utf-8")
    assert "drawing B-12" in page
    (tmp_path / "case.toml").write_text(text.replace('"drawing B-12"', "12"))
    with pytest.raises(InputError, match="source: found 12; accepted: where its numbers are from"):
        load_case(tmp_path)


def test_scaling_is_said_in_the_chosen_unit(tmp_path):
    (tmp_path / "a.txt").write_text(time_series(0.3))
    (tmp_path / "case.toml").write_text(bridge() + '[run]\nunits = ["m/s^2"]\n')
    case = load_case(tmp_path)
    said = scaling_words(case, units_of_scene(case.scene, case.run.stated))
    assert said.startswith("every record to a PSA of 4.90 m/s² at T1 of deck 2 = ")


def test_the_workbook_has_the_numbers_of_the_table_in_its_units(suite):
    sheets = read_workbook((suite / "report.xlsx").read_bytes())
    table = pd.read_csv(suite / "report.csv").set_index("quantity")
    headings, *rows = sheets["Piers and other yielding springs"[:31]]
    columns = dict(zip(headings, zip(*rows, strict=True), strict=True))
    assert columns["Piers and other yielding springs"] == ("column A", "column B")
    for key in ("50 %", "84 %", "largest"):
        for i, name in enumerate("AB"):
            force = table.loc[f"springs.column {name}.abs_max_force", key]
            assert columns[f"peak force (kN): {key}"][i] == pytest.approx(force / 1e3, rel=1e-15)
            ductility = table.loc[f"springs.column {name}.ductility", key]
            assert columns[f"ductility: {key}"][i] == pytest.approx(ductility, rel=1e-15)
    assert [row[0] for row in sheets["Records"][1:]] == ["1 a.txt", "2 b.txt", "3 c.txt"]


def test_bearings_hide_no_piers(suite):
    text = (suite / "report.html").read_text(encoding="utf-8")
    first, *_ = text.partition('<section class="sheet">\n<h2')
    for kind in ("Structure", "Piers and other yielding springs (2)", "Bodies (5)"):
        assert f">{kind}<" in first
    assert ">Bearings and other elastic springs (6)<" in first
    # The appendix has every one of them.
    _, _, appendix = text.partition(APPENDIX)
    assert all(f">bearing {i}<" in appendix for i in range(1, 7))


def test_the_page_that_zooms_is_whole_in_itself(suite, tmp_path):
    page = suite / "motion.html"
    text = page.read_text(encoding="utf-8")
    parser = Balanced()
    parser.feed(text)
    assert parser.open == []
    assert parser.sources == []
    assert "http" not in text.replace("http-equiv", "")
    data = json.loads(text.partition('id="run">')[2].partition("</script>")[0])
    assert [panel["name"] for panel in data["panels"]] == ["ground", "displacement", "gap"]
    assert {loop["name"] for loop in data["loops"]} == {"column A", "column B"}
    assert all(len(line["y"]) == len(data["t"]) for p in data["panels"] for line in p["lines"])
    assert text.count("<tr data-event=") == len(data["events"]) > 0
    assert re.search(r"<h1>.*: record .*, which governs, times [\d.]+</h1>", text)
    if CHROMIUM is None:
        pytest.skip("no Chromium here")
    red = {}
    for name, address in (("all", page.as_uri()), ("event", f"{page.as_uri()}#event=0")):
        picture = tmp_path / f"{name}.png"
        words = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=4000"]
        home = f"--user-data-dir={tmp_path / 'home'}"
        command = [CHROMIUM, *words, home, f"--screenshot={picture}", "--window-size=1100,1500"]
        subprocess.run([*command, address], check=True, capture_output=True, timeout=120)
        shown = imread(picture)[:, :, :3]
        red[name] = int(((shown[:, :, 0] > 0.7) & (shown[:, :, 1:] < 0.2).all(axis=2)).sum())
    # The chosen event is a red line in every panel.
    assert red["event"] > red["all"] + 300
