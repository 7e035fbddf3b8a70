"""The command behind docs/performance.md, on one small problem."""

import csv

from tests.benchmarks import work_precision


def test_it_writes_the_table(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(work_precision, "RTOL", (1e-3, 1e-6))
    words = ["P4", "--solvers", "fast,nobody", "--repeats", "1"]
    work_precision.main([*words, "--out", str(tmp_path)])
    new, old = (_rows(folder) for folder in (tmp_path, work_precision.DOCS))
    assert new[0] == old[0] == list(work_precision.COLUMNS)
    (row,) = [row for row in new if row[0] == "P4"]
    assert row[1] == "fast"
    assert float(row[2]) > 0.0
    # Of what was not measured the old rows stay.
    assert [row for row in new if row[0] != "P4"] == [row for row in old if row[0] != "P4"]
    assert "cvode at rtol 1e-13, checked by fast" in capsys.readouterr().out


def test_the_table_has_every_problem():
    rows = _rows(work_precision.DOCS)[1:]
    assert list(dict.fromkeys(row[0] for row in rows)) == list(work_precision.names())


def _rows(folder):
    text = (folder / work_precision.TABLE).read_text(encoding="utf-8")
    return list(csv.reader(text.splitlines()))
