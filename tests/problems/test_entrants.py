"""Programs that take part: run in time, and judged by what they know."""

import json
import sys

from eventpound import score
from eventpound.cli import main
from tests.score.test_answer import HIT, SET


def test_solvers_report_what_they_know(tmp_path, capsys):
    out, page = tmp_path / "cards.json", tmp_path / "cards.html"
    words = [
        "problems",
        "score",
        str(SET.folder / "16-pressed-by-jump"),
        "--json",
        str(out),
        "--html",
        str(page),
    ]
    assert main([*words, "--solver", "cvode", "--solver", "moreau", "--solver", "penalty"]) == 0
    cards = {name: by["16-pressed-by-jump"][-1] for name, by in json.loads(out.read_text()).items()}
    matched = {
        name: [card["events"][kind]["matched"] for kind in score.EVENTS]
        for name, card in cards.items()
    }
    assert matched == {"cvode": [1, 1, 0], "moreau": [1, 1, None], "penalty": [None] * 3}
    text = page.read_text()
    assert "<td>1/1</td><td>1/1</td><td></td></tr>" in text
    assert "<td>not reported</td><td>not reported</td><td></td></tr>" in text


def test_a_solver_is_run_and_judged(tmp_path, capsys):
    out = tmp_path / "cards.json"
    words = [str(SET.folder / "01-elastic-cosine"), "--solver", "fast", "--solver",
             "moreau", "--json", str(out), "--html", str(tmp_path / "cards.html")]  # fmt: skip
    assert main(["problems", "score", *words]) == 0
    cards = json.loads(out.read_text())
    fast, moreau = (cards[name]["01-elastic-cosine"] for name in ("fast", "moreau"))
    assert [card["size"] for card in moreau] == ["0.001", "0.0001", "1e-05"]
    assert fast[-1]["passed"] == "reference"
    assert moreau[-1]["passed"] == "engineering"
    errors = [card["penetration"] for card in moreau]
    assert errors[0] > errors[1] > errors[2] > 0.0
    said = capsys.readouterr().out
    assert "fast: of 1 problems 1 engineering, 1 research, 1 reference" in said
    # A line a size, with what its card says, and what keeps it back.
    row = next(line.split() for line in said.splitlines() if line.startswith("1e-05 "))
    card = moreau[-1]
    assert row[:2] == ["1e-05", "engineering"]
    assert [float(word) for word in row[2:5]] == [
        card["digits"][group] for group in ("peaks", "final", "history")
    ]
    assert row[6:8] == ["0", "0"]
    assert f"1e-05: {card['levels']['research']}" in said


def test_a_command_is_run_in_time_or_given_up(tmp_path, capsys):
    script = tmp_path / "slow.py"
    script.write_text("while True: pass\n")
    words = ["problems", "score", str(SET.folder / HIT), "--limit", "1", "--run"]
    assert main([*words, f"{sys.executable} {script} {{problem}} {{out}}"]) == 0
    assert "takes more than 1 s" in capsys.readouterr().out
    script.write_text("raise SystemExit('no idea')\n")
    words[4] = "20"
    assert main([*words, f"{sys.executable} {script} {{problem}} {{out}}"]) == 0
    assert "ended with 1 and said: no idea" in capsys.readouterr().out
    assert main([*words, "program {problem}"]) == 2
    assert "{problem} and {out} must stand in it" in capsys.readouterr().err
