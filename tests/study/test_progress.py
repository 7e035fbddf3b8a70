"""What is said on a terminal while a study runs."""

import eventpound.cli.progress as module
from eventpound.cli.progress import StudyProgress


def test_rate_and_time_left_count_the_runs_of_this_call(monkeypatch, capsys):
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    progress = StudyProgress(1000)
    progress(0, 400)
    assert "40%  400 of 1000 runs" in capsys.readouterr().err
    # 100 runs in 10 s, 500 to go.
    now[0] = 110.0
    progress(100, 400)
    assert "50%  500 of 1000 runs, 10 a second, 50 s left" in capsys.readouterr().err
