"""What the command draws, in which kinds of files."""

import shutil
from pathlib import Path

import pytest

from eventpound.cli import main
from tests.models import CASES


def test_command(tmp_path, capsys, undrawn):
    folder = tmp_path / "pair"
    shutil.copytree(CASES / "pair", folder)
    assert main(["run", str(folder), "--no-figures"]) == 0
    words = ["plot", str(folder), "--format", "svg,pdf", "--width", "90 mm", "--xlim", "0.5,3"]
    capsys.readouterr()
    assert main(words) == 0
    assert {Path(line).suffix for line in capsys.readouterr().out.split()} == {".svg", ".pdf"}
    assert main(["plot", str(folder), "--model", "--format", "pdf"]) == 0
    for wrong, said in (
        (["--width", "1 mm"], "accepted: 20 mm to 2 m"),
        (["--width", "3 s"], "--width: found '3 s'"),
    ):
        assert main(["plot", str(folder), *wrong]) == 2
        assert said in capsys.readouterr().err
    for wrong in (["--format", "gif"], ["--xlim", "3,2"], ["--dpi", "0"]):
        with pytest.raises(SystemExit):
            main(["plot", str(folder), *wrong])
