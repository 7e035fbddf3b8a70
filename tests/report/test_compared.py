"""The page of a comparison."""

import shutil

import pandas as pd

from eventpound.cli import main
from tests.models import CASES
from tests.report.test_html import whole


def test_page_of_a_comparison(tmp_path):
    folder = tmp_path / "pair"
    shutil.copytree(CASES / "pair", folder)
    words = ["--solvers", "fast,moreau", "--rtol", "1e-6", "--steps", "0.01", "--repeats", "1"]
    assert main(["compare", str(folder), *words]) == 0
    text = whole(folder / "comparison" / "report.html")
    # The diagram and the scene.
    assert text.count("<svg") == 2
    runs = pd.read_csv(folder / "comparison" / "comparison.csv")
    assert all(f"<td>{error:.1e}</td>" in text for error in runs["peak_error"])
    worst = pd.read_csv(folder / "comparison" / "quantities.csv").sort_values("error").iloc[-1]
    assert f"{worst['reference']:.6g}" in text
