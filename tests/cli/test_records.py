"""The command for records: what it prints and writes, for a file and for a folder."""

import csv
import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from eventpound.cli import main
from eventpound.cli.record_pulses import PULSE_WORDS
from eventpound.motion import Ricker, read_record
from eventpound.motion.pulse_fit import PULSES
from eventpound.motion.scales import mean_period
from tests.motion.readers.writers import WRITERS, motion

A = motion(1500, 0.01)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    records = tmp_path / "records"
    records.mkdir()
    for name in ("at2", "geonet", "one_column"):
        (records / f"{name}.txt").write_text(WRITERS[name](A, 0.01).text)
    (records / "notes.md").write_text("# Notes\n\nnothing to read\n")
    return records


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_file(folder, capsys, undrawn):
    path = folder / "at2.txt"
    assert main(["records", str(path)]) == 0
    out = Path("at2-record")
    data = read_record(path)
    (row,) = table(out / "records.csv")
    peak = float(np.max(np.abs(data.acceleration)))
    period = mean_period(data.acceleration, data.time_step)
    assert float(row["pga_m_s2"]) == peak
    assert float(row["tm_s"]) == float(row["tm_padded_s"]) == period
    assert float(row["le_m"]) == pytest.approx(peak * period**2 / (4.0 * np.pi**2), rel=1e-14)
    assert row["problem"] == ""
    manifest = json.loads((out / "manifest.json").read_text())
    assert manifest["processing"] == {}
    assert "trapezoid sum" in manifest["sums"]["arias_m_s"]
    assert float(row["cav_m_s"]) == pytest.approx(
        np.trapezoid(np.abs(data.acceleration), dx=data.time_step), rel=1e-13
    )
    assert manifest["records"][0]["file_sha256"] == data.sha256
    digest = hashlib.sha256((out / "records.csv").read_bytes()).hexdigest()
    assert manifest["files"]["records.csv"] == digest
    assert (out / "at2.txt-090.png").read_bytes().startswith(b"\x89PNG")
    printed = capsys.readouterr().out
    assert printed.count("(trapezoid sum)") == 2
    assert f"PGA       {peak:.5g} m/s^2" in printed
    assert f"T_m       {period:.4f} s (padded {period:.4f}, literal " in printed


def test_what_a_file_does_not_say_is_asked_for(folder, capsys):
    path = str(folder / "one_column.txt")
    assert main(["records", path]) == 2
    assert "does not state its units and its time step" in capsys.readouterr().err
    assert not Path("one_column-record").exists()
    assert main(["records", path, "--units", "m/s2", "--time-step", "0.01", "--no-figures"]) == 0
    assert [p.name for p in sorted(Path("one_column-record").iterdir())] == [
        "manifest.json",
        "records.csv",
    ]
    assert main(["records", str(folder / "geonet.txt")]) == 2
    assert "#1 N28W, #2 S62W, #3 Up" in capsys.readouterr().err


def test_a_folder_goes_on_past_what_cannot_be_read(folder, capsys):
    assert main(["records", str(folder), "--out", "out", "--units", "m/s2"]) == 0
    output = capsys.readouterr()
    assert "records   4 in 2 of 4 files" in output.out
    rows = table(Path("out/records.csv"))
    assert [row["component"] for row in rows] == ["090", "N28W", "S62W", "Up", "", ""]
    problems = {Path(row["file"]).name: row["problem"] for row in rows if row["problem"]}
    assert "not an accelerogram" in problems["notes.md"]
    assert "does not state its time step" in problems["one_column.txt"]
    assert "2 files were not read" in output.err
    assert sorted(p.name for p in Path("out").iterdir()) == ["manifest.json", "records.csv"]
    manifest = json.loads(Path("out/manifest.json").read_text())
    assert len(manifest["records"]) == 4
    assert len(manifest["unread"]) == 2


def test_the_table_of_a_folder_is_a_list(folder, capsys, monkeypatch):
    """Blanks filled in, it names every component, wherever it is read from."""
    monkeypatch.chdir(folder.parent)
    assert main(["records", folder.name, "--out", "out/deep"]) == 0
    assert "filled in in out/deep/records.csv" in capsys.readouterr().err
    path = Path("out/deep/records.csv")
    rows = [row for row in table(path) if not row["file"].endswith("notes.md")]
    for row in rows:
        if row["problem"]:
            row |= {"units": "m/s2", "dt_s": "0.01"}
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    monkeypatch.chdir("out")
    assert main(["records", str(folder), "--list", "deep/records.csv", "--out", "again"]) == 0
    assert [row["component"] for row in table(Path("again/records.csv"))] == [
        row["component"] for row in rows
    ]


def test_a_list_names_the_files(folder, undrawn):
    (folder / "list.csv").write_text("file,units,time_step\none_column.txt,m/s2,0.01\n")
    arguments = ["records", str(folder), "--list", str(folder / "list.csv"), "--out", "out"]
    assert main([*arguments, "--figures"]) == 0
    assert len(table(Path("out/records.csv"))) == 1
    assert Path("out/one_column.txt.png").exists()
    assert main(["records", str(folder / "at2.txt"), "--list", "x"]) == 2


def test_processing_is_recorded_and_changes_the_samples(folder):
    path = str(folder / "at2.txt")
    more = ["--baseline", "1", "--highpass", "0.2", "--lowpass", "20", "--order", "2"]
    assert main(["records", path, *more, "--out", "out", "--no-figures"]) == 0
    manifest = json.loads(Path("out/manifest.json").read_text())
    assert manifest["processing"] == {"baseline": 1, "highpass": 0.2, "lowpass": 20.0, "order": 2}
    (row,) = table(Path("out/records.csv"))
    assert "processed: baseline of degree 1" in row["notes"]
    assert float(row["pga_m_s2"]) != float(np.max(np.abs(read_record(path).acceleration)))
    assert main(["records", path, "--highpass", "90"]) == 2


def test_a_folder_without_a_record_is_an_error(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "records").mkdir()
    assert main(["records", "records"]) == 2
    assert "no file in the folder" in capsys.readouterr().err
    (tmp_path / "records" / "a").write_text("words only\nand more\n")
    assert main(["records", "records"]) == 2
    assert "not an accelerogram" in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["records"]


@pytest.mark.parametrize("convention", ["literal", "slammer"])
def test_the_convention_of_the_mean_period(folder, convention):
    path = str(folder / "at2.txt")
    assert main(["records", path, "--mean-period", convention, "--out", "o", "--no-figures"]) == 0
    (row,) = table(Path("o/records.csv"))
    assert row["tm_s"] == row[f"tm_{convention}_s"]


def test_pulse_of_a_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    t = np.arange(0.0, 10.0, 0.01)
    ricker = Ricker(amplitude=0.3, period=1.2, start=3.0)
    Path("pulse.txt").write_text("\n".join(map(repr, ricker.acceleration(t).tolist())))
    words = ["records", "pulse.txt", "--units", "m/s2", "--time-step", "0.01"]
    assert main([*words, "--pulse", "ricker", "--pulse-to", "acceleration"]) == 0
    out = capsys.readouterr().out
    assert "100.0%" in out
    (row,) = table(Path("pulse-record/pulses.csv"))
    assert row["pulse"] == "ricker"
    assert float(row["a_p"]) == pytest.approx(0.3, rel=1e-7)
    assert float(row["T_p"]) == pytest.approx(1.2, rel=1e-7)
    assert float(row["L_e"]) == pytest.approx(0.3 * (1.2 / (2.0 * np.pi)) ** 2, rel=1e-6)
    assert Path("pulse-record/pulse.txt-pulse.png").stat().st_size > 10_000
    assert main([*words, "--pulse", "--no-figures", "--out", "all"]) == 0
    assert table(Path("all/pulses.csv"))[0]["pulse"] == "ricker"
    assert not list(Path("all").glob("*.png"))


def test_words_for_pulses_are_those_that_can_be_fitted():
    assert list(PULSE_WORDS) == ["all", *PULSES]
