"""The page of a run: whole in itself, with the numbers of its files, and opened in a browser."""

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eventpound.cli import main
from eventpound.report.record_tables import record_names
from eventpound.results import read
from tests.blank import blank_figures
from tests.models import CASES
from tests.study.test_suite import CASE, time_series

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
VOID = {"meta", "input", "img", "br"}


class Balanced(HTMLParser):
    """Whether every element is closed in its place."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sources: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.sources += [v or "" for k, v in attrs if k in ("src", "xlink:href", "data")]
        self.links += [given["href"] or ""] if tag == "a" and "href" in given else []
        self.ids += [given["id"] or ""] if tag == "h2" and "id" in given else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page") / "pair"
    shutil.copytree(CASES / "pair", folder)
    assert main(["report", str(folder)]) == 0
    return folder / "results" / "report" / "report.html"


def test_nothing_is_loaded_from_elsewhere(page):
    assert whole(page).count("<h2 id=") >= 7


def test_it_has_the_numbers_of_the_files(page):
    text = page.read_text(encoding="utf-8")
    summary = read(page.parent).summary
    for name, peak in summary["peaks"].items():
        assert f"{peak['abs_max']:.6g}" in text, name
    assert f"{summary['contacts']['joint']['sum_impulse']:.6g}" in text
    assert f"{len(read(page.parent).events)} events" in text
    assert summary["scene"]["bodies"][0]["name"] in text
    assert read(page.parent).manifest["case_sha256"] in text
    # Scene and motion on the sheets; scene, spectrum, displacements and loops behind them.
    assert text.count("<svg") == 6


def test_the_same_results_make_the_same_page(page):
    before = page.read_bytes()
    assert main(["report", str(page.parents[2])]) == 0
    assert page.read_bytes() == before


def test_a_certificate_is_one_sentence_and_of_this_run(page, tmp_path, undrawn):
    folder = shutil.copytree(page.parents[2], tmp_path / "pair")
    peak = read(page.parent).summary["peaks"]["stiff"]["max"]
    for value, said in ((peak, "1 of 2 numbers hold to 11 digits"), (9.9, "is of another case")):
        other = {"quantity": "final.stiff.u", "digits": 0, "certified": False}
        one = {"quantity": "peaks.stiff.max", "value": value, "scale": 0.1, "digits": 11}
        certificate = json.dumps({"quantities": [one | {"certified": True}, other]})
        (folder / "results" / "certificate.json").write_text(certificate)
        assert main(["report", str(folder)]) == 0
        made = folder / "results" / "report" / "report.html"
        assert said in made.read_text(encoding="utf-8")


def test_a_folder_of_cases_has_a_report_each(page, tmp_path, capsys, undrawn):
    shutil.copytree(CASES / "pair", tmp_path / "one")
    (tmp_path / "two").mkdir()
    (tmp_path / "two" / "case.toml").write_text("title = 2\n")
    assert main(["report", str(tmp_path)]) == 2
    assert "left out two: " in capsys.readouterr().err
    index = (tmp_path / "reports" / "index.html").read_text(encoding="utf-8")
    assert 'href="one/report.html"' in index
    assert "two: " in index
    made = tmp_path / "reports" / "one" / "report.csv"
    assert made.read_bytes() == (page.parent / "report.csv").read_bytes()
    assert main(["report", str(tmp_path), "--suite", "x.AT2"]) == 2
    assert "--suite: is for a single case" in capsys.readouterr().err


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_a_browser_shows_it(page, tmp_path):
    assert CHROMIUM is not None
    picture = tmp_path / "page.png"
    flags = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--window-size=1000,3000",
    ]
    home = f"--user-data-dir={tmp_path / 'home'}"
    words = [CHROMIUM, *flags, home, f"--screenshot={picture}", page.as_uri()]
    subprocess.run(words, check=True, capture_output=True, timeout=120)
    from matplotlib.image import imread

    shown = imread(picture)[:, :, :3]
    # Text and lines on white from the head of the page to its foot.
    ink = (shown < 0.6).any(axis=2)
    assert all(ink[low : low + 500].mean() > 0.002 for low in range(0, 3000, 500))


def whole(path: Path) -> str:
    """The text of a page, which loads nothing and closes what it opens."""
    text = path.read_text(encoding="utf-8")
    parser = Balanced()
    parser.feed(text)
    assert parser.open == []
    assert all(source.startswith(("#", "data:")) for source in parser.sources)
    assert "<script" not in text
    assert "@import" not in text
    assert not re.search(r"url\((?!#)", text)
    assert [f"#{name}" for name in parser.ids] == parser.links
    return text


SUITE = """
title = "a suite"
[excitation]
kind = "record"
suite = "records/*.txt"
units = "m/s2"
time_step = 0.02
target = [[0.05, 4.0], [0.5, 4.0], [4.0, 1.0]]
target_periods = [0.2, 1.0]
[[body]]
name = "deck"
mass = "900 t"
[[spring]]
name = "pier"
between = ["ground", "deck"]
law = "linear"
period = "0.6 s"
[[contact]]
name = "wall"
between = ["deck", "barrier"]
gap = "1 cm"
restitution = 0.6
"""


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    folder = tmp_path_factory.mktemp("suite")
    (folder / "records").mkdir()
    rng = np.random.default_rng(3)
    for i in range(4):
        text = "\n".join(f"{v:.5f}" for v in rng.normal(0.0, 1.0, 250))
        (folder / "records" / f"{i}.txt").write_text(text)
    (folder / "records" / "broken.txt").write_text("1.0\nx\n2.0\n")
    (folder / "case.toml").write_text(SUITE)
    with blank_figures():
        assert main(["report", str(folder)]) == 0
    return folder / "results" / "report"


def test_page_of_a_suite(suite):
    text = whole(suite / "report.html")
    table = pd.read_csv(suite / "suite.csv")
    done = table[table["failed"].isna()]
    assert len(done) == 4
    assert "Under 4 of 5 records" in text
    # Scene, motion and demands on the sheets; scene, spectra of the records, peaks behind them.
    assert text.count("<svg") == 6
    peaks = done["peaks.deck.abs_max"]
    record = record_names(table)[done["record"][peaks.idxmax()]]
    words = " ".join(re.sub("<[^>]+>", " ", text).split())
    sizes = " ".join(f"{1e3 * np.percentile(peaks, part):.3g}" for part in (50.0, 84.0, 100.0))
    assert f"peak displacement mm {sizes} {record}" in words
    assert "line 2" in text
    assert json.loads((suite / "suite.json").read_text())["case_sha256"] in text


STUDY = """\
title = "A small study"
[excitation]
kind = "sine"
[pi]
structure = "elastoplastic"
uy = 0.1
Q = 0.3
epsilon = 0.7
periods = 2
[solver]
name = "fast"
rtol = 1e-8
[study]
quantities = ["pi_um", "impacts"]
[[study.axis]]
key = "excitation.reverse"
values = [false, true]
[[study.axis]]
key = "pi.delta"
from = 0.1
to = 2.0
count = 10
[figure]
name = "gaps"
x = "pi.delta"
y = "pi_um"
curves = "excitation.reverse"
claim = "Wide gaps are never closed."
"""


def test_page_of_a_study(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(STUDY)
    assert main(["study", str(tmp_path), "--no-figures"]) == 0
    with blank_figures():
        assert main(["report", str(tmp_path)]) == 0
    # In Π-terms there are no design numbers: the appendix alone, of the table of the study.
    report = tmp_path / "results" / "report"
    assert [path.name for path in report.iterdir()] == ["report.html"]
    text = whole(report / "report.html")
    table = pd.read_csv(tmp_path / "results" / "study.csv")
    # The figure and the scene.
    assert text.count("<svg") == 2
    assert "20 of 20" in text
    assert "Wide gaps are never closed." in text
    row = table.loc[table["pi_um"].idxmax()]
    reverse, gap = row["excitation.reverse"], row["pi.delta"]
    assert f"<td>{np.percentile(table['pi_um'], 84.0):.6g}</td>" in text
    assert f">excitation.reverse = {reverse}, pi.delta = {gap:.6g}<" in text
    # Its figures are drawn again, on paper too.
    drawn = tmp_path / "results" / "gaps.pdf"
    assert main(["plot", str(tmp_path), "--format", "pdf"]) == 0
    assert drawn.stat().st_size > 5000
    capsys.readouterr()
    assert main(["plot", str(tmp_path), "--pi"]) == 2
    assert "--pi: is for a single run, and these are the results of a study" in (
        capsys.readouterr().err
    )
    # The table of a case that has changed since is not shown as its own.
    (tmp_path / "case.toml").write_text(STUDY.replace("0.3", "0.4"))
    assert main(["plot", str(tmp_path)]) == 2
    assert "no table of this case as it is; `eventpound study`" in capsys.readouterr().err


def test_page_of_a_study_under_records(tmp_path, undrawn):
    for name, amplitude in (("a", 0.2), ("b", 0.5)):
        (tmp_path / f"{name}.txt").write_text(time_series(amplitude))
    study = '[study]\nrecords = "?.txt"\nquantities = ["peaks.deck.abs_max"]\n'
    text = CASE.format('units = "g"\ntime_step = "0.02 s"') + study
    (tmp_path / "case.toml").write_text(text)
    assert main(["report", str(tmp_path)]) == 0
    text = whole(tmp_path / "results" / "report" / "report.html")
    # The scene of the first run has its record; how long a run lasts is each record's own.
    assert "<dd>record, a_g = " in text
    assert "<dd>from 0 s, as long as each motion says</dd>" in text
