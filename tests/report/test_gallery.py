"""The page of all figures."""

from eventpound.cli import main


def test_page_takes_the_figures_of_suites(tmp_path, undrawn):
    case = tmp_path / "scales" / "case.toml"
    case.parent.mkdir()
    case.write_text(
        '# Shows scales.\n[excitation]\nkind = "record"\n'
        'synthetic = { seed = 1, count = 1 }\n[figure]\nkind = "record-scales"\n'
        'claim = "Scales order."\nnote = "$T_m$ of others"\n'
    )
    assert main(["plot", str(tmp_path), "--out", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "index.html").read_text()
    assert "Shows scales." in page
    assert "eventpound run cases/scales" in page
    assert "Scales order." in page
    assert (tmp_path / "out" / "scales" / "suite.csv").is_file()
    assert (tmp_path / "out" / "scales" / "record-scales.png").is_file()
