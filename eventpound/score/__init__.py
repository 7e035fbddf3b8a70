"""Judge a program's history by the certified answer of a problem: NumPy and nothing else.

Its modules, one behind the other, are the file ``score.py`` of the archive of a set
(`eventpound.problems.files`), which works where there is no eventpound.
"""

from eventpound.score.answer import Motion, check, read_history
from eventpound.score.card import Card, card_text, judge
from eventpound.score.levels import EVENTS, LEVELS, ScoreError
from eventpound.score.page import best_of, card_page, count_text, ladder_text, set_page
from eventpound.score.pairing import Event
from eventpound.score.problem import Problem, read_problem

__all__ = [
    "EVENTS",
    "LEVELS",
    "Card",
    "Event",
    "Motion",
    "Problem",
    "ScoreError",
    "best_of",
    "card_page",
    "card_text",
    "check",
    "count_text",
    "judge",
    "ladder_text",
    "read_history",
    "read_problem",
    "set_page",
]
