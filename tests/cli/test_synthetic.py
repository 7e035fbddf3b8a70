"""The command for synthetic motions: files, table, and what it prints."""

import csv

import pytest

from eventpound.cli import main
from eventpound.motion import Record, read_record


def test_writes_motions_and_their_parameters(tmp_path, capsys):
    words = ["records", "synthetic", str(tmp_path / "a"), "--count", "3", "--seed", "7"]
    assert main(words) == 0
    assert "3 synthetic motions, seed 7" in capsys.readouterr().out
    with (tmp_path / "a" / "parameters.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["file"] for row in rows] == [f"synthetic-7-000{n}.AT2" for n in (1, 2, 3)]
    for row in rows:
        data = read_record(tmp_path / "a" / row["file"])
        scales = Record(data.acceleration, data.time_step).scales()
        assert float(row["PGA (m/s^2)"]) == scales.a_g
        assert float(row["L_e (m)"]) == scales.length
        assert row["kind"] == "synthetic"


def test_the_same_seed_gives_the_same_bytes_however_many(tmp_path):
    for name, count in (("a", "2"), ("b", "3")):
        assert main(["records", "synthetic", str(tmp_path / name), "--count", count]) == 0
    for file in (tmp_path / "a").glob("*.AT2"):
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


@pytest.mark.parametrize("words", [["--count", "0"], ["--seed", "x"], ["--count", "1.5"]])
def test_wrong_numbers(words, tmp_path, capsys):
    with pytest.raises(SystemExit) as caught:
        main(["records", "synthetic", str(tmp_path / "a"), *words])
    assert caught.value.code == 2
    assert "a whole number from 1" in capsys.readouterr().err
    assert not (tmp_path / "a").exists()
