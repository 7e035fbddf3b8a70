"""A problem that cannot be read is one message."""

import json

from eventpound.cli import main
from eventpound.score.__main__ import main as judge_alone


def test_a_problem_that_is_none_is_one_message(folder, tmp_path, capsys):
    assert judge_alone([str(tmp_path), "mine.csv"]) == 2
    assert "problem.json: cannot be read" in capsys.readouterr().err
    for name in ("problem.json", "answer.json"):
        content = json.loads((folder / name).read_text())
        content.pop("gaps" if name == "problem.json" else "events")
        (tmp_path / name).write_text(json.dumps(content))
        assert judge_alone([str(tmp_path), "mine.csv"]) == 2
        assert capsys.readouterr().err.endswith((": has no gaps\n", ": has no events\n"))
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    assert main(["problems", "score", str(tmp_path), "mine.csv"]) == 2
    assert "set.toml: cannot be read" in capsys.readouterr().err
