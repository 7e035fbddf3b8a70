"""A study under records: axes times records, one table, whatever is wrong with some of them."""

from pathlib import Path

import numpy as np
import pytest

from eventpound import InputError, load_case, simulate_suite
from eventpound.cli import main
from eventpound.study.engine import Batch, Processes
from eventpound.study.plan import Chunk
from eventpound.study.reading import load_study
from eventpound.study.running import run_study
from eventpound.study.table import compute, read_table
from tests.study.test_suite import CASE, time_series

AXES = """
[study]
quantities = ["peaks.deck.abs_max", "free.peaks.deck.abs_max", "impacts",
              "contacts.joint.sum_impulse", "scales.L_e", "t_final", "excitation.time_step"]
{records}
[[study.axis]]
key = "contact.joint.gap"
values = ["1 cm", "2 cm", "3 cm"]
[[study.axis]]
key = "excitation.pga"
values = ["0.3 g", "0.6 g"]
{further}
"""
READ = 'units = "g"\ntime_step = "0.02 s"\n'


@pytest.fixture
def folder(tmp_path):
    for i, amplitude in enumerate((0.2, 0.5, 0.8, 0.4)):
        # Of different lengths.
        lines = time_series(amplitude).splitlines()
        (tmp_path / f"{i}.txt").write_text("\n".join(lines[: 200 - 30 * i]))
    return tmp_path


def study_of(folder: Path, records: str = 'records = "?.txt"', further: str = "", more: str = ""):
    text = CASE.format(READ) + AXES.format(records=records, further=further) + more
    (folder / "case.toml").write_text(text)
    return load_study(folder).study


def table_of(study, folder: Path):
    run_study(study, folder / "results", Batch(1))
    return read_table(folder / "results")


def test_rows_are_those_of_an_axis_of_files(folder):
    found = table_of(study_of(folder), folder)
    assert list(found.columns[:3]) == ["record", "contact.joint.gap", "excitation.pga"]
    assert found["record"].tolist() == [f"{i}.txt" for i in range(4) for _ in range(6)]
    assert found["success"].all()
    axis = '[[study.axis]]\nkey = "excitation.file"\nfiles = "?.txt"\n'
    other = table_of(study_of(folder, "", axis), folder)
    for name in found.columns[1:]:
        assert found[name].tolist() == other[name].tolist()
    assert found["impacts"].sum() > 20
    assert found["excitation.time_step"].unique().tolist() == [0.02]


def test_rows_are_those_of_a_suite(folder):
    text = CASE.format('suite = "?.txt"\n' + READ)
    study = '[study]\nquantities = ["peaks.deck.abs_max", "contacts.joint.sum_impulse"]\n'
    (folder / "case.toml").write_text(text + study)
    found = table_of(load_study(folder).study, folder)
    (folder / "case.toml").write_text(text)
    suite = simulate_suite(load_case(folder), rtol=1e-9)
    for name in ("record", "peaks.deck.abs_max", "contacts.joint.sum_impulse"):
        assert found[name].tolist() == suite[name].tolist()


def test_rows_do_not_depend_on_chunks_or_engines(folder):
    study = study_of(folder)
    whole = compute(study, Chunk(0, 0, 0, 24))
    parts = [(0, 1), (1, 7), (7, 9), (9, 24)]
    assert b"".join(compute(study, Chunk(0, 0, a, b)) for a, b in parts) == whole
    chunks = [Chunk(0, 0, 0, 9), Chunk(1, 0, 9, 24)]
    found = dict(Processes(2).run(study, chunks))
    assert b"".join(found[chunk] for chunk in chunks) == whole


def test_a_record_that_cannot_be_read_is_rows_with_its_reason(folder):
    good = table_of(study_of(folder), folder)
    (folder / "2.txt").write_text("0.1\n0.2\nNaN\n0.1\n")
    study = study_of(folder)
    found = table_of(study, folder)
    bad = found["record"] == "2.txt"
    assert (found["success"] == ~bad).all()
    assert found.loc[bad, "message"].str.contains("line 3").all()
    assert found.loc[bad, "contact.joint.gap"].tolist() == [0.01, 0.01, 0.02, 0.02, 0.03, 0.03]
    assert found.loc[bad, "impacts"].isna().all()
    for name in ("peaks.deck.abs_max", "free.peaks.deck.abs_max", "t_final"):
        assert np.array_equal(found.loc[~bad, name], good.loc[~bad, name])
    # A change of a record is another study.
    assert study.digest != study_of(folder, 'records = "[013].txt"').digest


def test_other_solvers_agree(folder):
    for i in (0, 1, 2):
        (folder / f"{i}.txt").unlink()
    fast = table_of(study_of(folder), folder)
    cvode = table_of(study_of(folder, more='[solver]\nname = "cvode"\n'), folder)
    assert cvode["impacts"].tolist() == fast["impacts"].tolist()
    # rtol 1e-9 promises a hundred times that.
    peaks = "peaks.deck.abs_max"
    np.testing.assert_allclose(cvode[peaks], fast[peaks], rtol=1e-7)
    assert cvode["scales.L_e"].tolist() == fast["scales.L_e"].tolist()


@pytest.mark.parametrize(
    ("records", "words"),
    [
        ('records = "none*.txt"', ["none*.txt", "no file matches"]),
        ("records = 3", ["[study]", "records", "3"]),
    ],
)
def test_wrong_records_are_refused(records, words, folder, capsys):
    with pytest.raises(InputError) as error:
        study_of(folder, records)
    for word in words:
        assert word in str(error.value)
    assert main(["study", str(folder)]) == 2
    assert not (folder / "results").exists()


def test_records_are_of_records_only(folder):
    (folder / "case.toml").write_text(
        CASE.format("").replace('kind = "record"', 'kind = "sine"\namplitude = 1\nperiod = 1')
        + AXES.format(records='records = "?.txt"', further="")
    )
    with pytest.raises(InputError, match=r"\[study\]: records: .*kind"):
        load_study(folder)


def test_no_record_that_can_be_read_is_an_error(folder):
    for path in folder.glob("?.txt"):
        path.write_text("nothing")
    with pytest.raises(InputError, match=r"\.txt"):
        study_of(folder)
