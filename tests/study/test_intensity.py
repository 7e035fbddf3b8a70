"""Incremental dynamic analysis: fractiles over records, against numbers worked out by hand."""

import numpy as np
import pandas as pd
import pytest

from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.study.intensity import IntensityPlan, fractile_curves
from eventpound.study.table import read_table

PLAN = IntensityPlan("ida", "pga", "peak", "file", (16.0, 50.0, 84.0))
CASE = """
body = [{{ name = "deck", mass = 1000.0 }}]
spring = [{{ between = ["ground", "deck"], name = "piers", law = "linear", period = "0.5 s" }}]
contact = [{{ between = ["deck", "barrier"], name = "joint", gap = {gap}, restitution = 0.5 }}]
[excitation]
kind = "record"
units = "m/s2"
time_step = 0.02
[study]
quantities = ["peaks.deck.abs_max", "impacts"]
[[study.axis]]
key = "excitation.file"
files = "records/*.txt"
[[study.axis]]
key = "excitation.pga"
values = ["0.1 g", "0.2 g", "0.4 g"]
[intensity]
name = "ida"
measure = "excitation.pga"
demand = "peaks.deck.abs_max"
records = "excitation.file"
"""


def test_fractiles_of_eleven_demands():
    """Of 0, 10, ..., 100 the p per cent fractile is p."""
    demands = [(1.0, f"r{i}", 10.0 * i) for i in range(11)]
    table = pd.DataFrame([*demands, (0.5, "r0", 3.0)], columns=["pga", "file", "peak"])
    curves = fractile_curves(table, PLAN)
    assert curves["pga"].tolist() == [0.5, 1.0]
    assert curves["runs"].tolist() == [1, 11]
    assert curves.loc[1, ["16 %", "50 %", "84 %"]].tolist() == pytest.approx([16.0, 50.0, 84.0])
    assert curves.loc[0, ["16 %", "50 %", "84 %"]].tolist() == [3.0, 3.0, 3.0]


def test_failed_runs_have_no_demand():
    rows = [(1.0, "a", np.nan), (1.0, "b", 2.0), (2.0, "a", np.nan)]
    curves = fractile_curves(pd.DataFrame(rows, columns=["pga", "file", "peak"]), PLAN)
    assert curves["runs"].tolist() == [1, 0]
    assert curves["50 %"][0] == 2.0
    assert np.isnan(curves["50 %"][1])


def test_demands_of_another_axis_are_not_mixed():
    """Under two gaps a record has two demands at one intensity."""
    rows = [(gap, 1.0, name, gap) for gap in (0.1, 0.2) for name in "ab"]
    table = pd.DataFrame(rows, columns=["gap", "pga", "file", "peak"])
    assert fractile_curves(table[table["gap"] == 0.1], PLAN)["runs"].tolist() == [2]
    with pytest.raises(InputError, match="several rows have one file and one pga"):
        fractile_curves(table, PLAN)


@pytest.fixture
def records(tmp_path):
    """Three records beside the case."""
    folder = tmp_path / "case" / "records"
    folder.mkdir(parents=True)
    rng = np.random.default_rng(3)
    for i in range(3):
        np.savetxt(folder / f"{i}.txt", rng.normal(size=200) * np.hanning(200))
    return folder


def test_a_linear_structure_has_straight_curves(records, make_study):
    """Without contact demands are in proportion to the intensity, and so are their fractiles."""
    case = make_study(CASE.format(gap=10.0))
    assert main(["study", str(case.directory)]) == 0
    curves = pd.read_csv(case.directory / "results" / "ida.csv")
    for column in ("16 %", "50 %", "84 %"):
        ratios = curves[column] / curves["excitation.pga"]
        # rtol 1e-9 promises a hundred times that.
        assert ratios.to_numpy() == pytest.approx(ratios[0], rel=1e-7)
    assert curves["runs"].tolist() == [3, 3, 3]
    assert (case.directory / "results" / "ida.png").stat().st_size > 10_000


def test_the_table_has_a_row_for_each_record_and_intensity(records, make_study):
    case = make_study(CASE.format(gap=0.005))
    assert main(["study", str(case.directory), "--no-figures"]) == 0
    table = read_table(case.directory / "results")
    assert list(table["excitation.file"].unique()) == [f"records/{i}.txt" for i in range(3)]
    assert len(table) == 9
    assert table["impacts"].iloc[-1] > 0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"records/*.txt"', '"nothing/*.txt"', "files: found 'nothing/*.txt'"),
        ('demand = "peaks.deck.abs_max"', 'demand = "drift"', "[intensity]: demand: found 'drift'"),
        ("name = \"ida\"", "fractiles = [150]", "fractiles: found [150]"),
        ('measure = "excitation.pga"', 'measure = "impacts"', "measure: found 'impacts'"),
    ],
)  # fmt: skip
def test_problems_are_named(records, make_study, old, new, words):
    with pytest.raises(InputError) as caught:
        make_study(CASE.format(gap=1.0).replace(old, new))
    assert words in str(caught.value)


_GAP = """
[[study.axis]]
key = "contact.joint.gap"
values = ["1 cm", "2 cm"]
[intensity]"""


@pytest.mark.parametrize("command", ["check", "study", "report"])
def test_an_axis_beside_is_refused_before_any_run(records, tmp_path, capsys, command):
    """Under two gaps a record has two demands at one intensity, which is known without a run."""
    directory = records.parent
    text = CASE.format(gap=1.0).replace("[intensity]", _GAP)
    (directory / "case.toml").write_text(text)
    assert main([command, str(directory)]) == 2
    assert "several rows have one excitation.file and one excitation.pga" in capsys.readouterr().err
    assert not (directory / "results").exists()
    # An axis that goes along with the intensity leaves one demand.
    together = text.replace('["1 cm", "2 cm"]', '[0.01, 0.02, 0.03]\nzip = "a"')
    together = together.replace('"0.4 g"]', '"0.4 g"]\nzip = "a"')
    (directory / "case.toml").write_text(together)
    if command == "check":
        assert main([command, str(directory)]) == 0


def test_a_part_of_one_is_doubted_as_a_per_cent(records, capsys):
    text = CASE.format(gap=1.0) + "fractiles = [0.16, 0.5]\n"
    (records.parent / "case.toml").write_text(text)
    assert main(["check", str(records.parent)]) == 0
    assert "[intensity]: fractiles: 0.16 is 0.16 %; write 16 for 16 %" in capsys.readouterr().err
