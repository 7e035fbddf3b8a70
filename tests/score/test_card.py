"""What a card tells of an answer."""

import numpy as np
import pytest

from eventpound import score
from tests.score.test_answer import events_found, exact, judged


def test_a_card_tells_the_restitution_that_the_rows_show(problem):
    card = judged(problem, *exact(problem, restitution=0.4))
    (row,) = card.impact_rows
    assert (row["contact"], row["t_found"]) == ("wall", pytest.approx(row["t"], abs=1e-12))
    assert row["speed_found"] == pytest.approx(np.sqrt(1.0 - 0.999**2), rel=1e-9)
    assert row["restitution"] == pytest.approx(0.5, rel=1e-9)
    assert row["restitution_found"] == pytest.approx(0.4, rel=1e-9)
    assert "restitution    0.4 in the rows where it is 0.5, wall at 3.097 s" in score.card_text(
        card
    )


def test_every_reason_is_told_not_only_the_first(problem):
    t, u, v = exact(problem, late=1e-2)
    reasons = judged(problem, t, u, v, reported={"impact"}).reasons["research"]
    starts = ("of 1 impacts 1 missed", "penetrates by", "final.b.u off by")
    assert len(reasons) == 3
    assert all(why.startswith(how) for why, how in zip(reasons, starts, strict=True)), reasons


def test_silence_about_events_is_no_fault(resting):
    said = events_found(resting, [], frozenset({"rest"}))
    silent = events_found(resting, [], frozenset())
    assert said.events["rest"]["missed"] == 1
    for card, kinds in ((said, ["detachment", "accumulation"]), (silent, list(score.EVENTS))):
        assert all(card.events[kind]["matched"] is None for kind in kinds)
    assert "rests          1 expected, not reported" in score.card_text(silent)
    assert said.levels == silent.levels
