"""What is said on a terminal while a study runs."""

import sys

import eventpound.cli.progress as module
from eventpound.case import load_case, write_template
from eventpound.cli.progress import Counter, Progress


def test_rate_and_time_left_count_the_runs_of_this_call(monkeypatch, capsys):
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    progress = Counter("runs")
    progress(400, 1000)
    assert "40%  400 of 1000 runs" in capsys.readouterr().err
    # 100 runs in 10 s, 500 to go.
    now[0] = 110.0
    progress(500, 1000)
    assert "50%  500 of 1000 runs, 10 a second, 50 s left" in capsys.readouterr().err


def test_a_further_pass_is_called_what_it_is(monkeypatch, capsys, tmp_path):
    case = load_case(write_template(tmp_path / "case"))
    length = case.run.duration
    now = [0.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    progress = Progress(case)
    progress(0.5 * length)
    assert "\r  50%  t = " in capsys.readouterr().err
    progress.begins("without contact, for the gaps")
    now[0] = 1.0
    progress(0.1 * length)
    assert "\rwithout contact, for the gaps:   10%  t = " in capsys.readouterr().err
