"""What is declared of the options of ``[run]`` is what the page of the case file says."""

from eventpound.case.run_options import Way, options
from tests.models import DOCS
from tests.study.test_stated import CELLS, WAYS

PAGE = DOCS / "case-format.md"
_WAYS = dict(zip(WAYS, (Way.RUN, Way.SUITE, Way.STUDY, Way.RUN, Way.MANY), strict=True))


def test_the_page_says_of_each_option_what_is_declared():
    section = PAGE.read_text().partition("## `[run]`")[2].partition("What each does")[0]
    rows = {f"| `{name}` | {key.says} | {key.default} |" for name, key in options()}
    assert {line for line in section.splitlines() if line.startswith("| `")} == rows


def test_the_page_says_in_which_ways_each_holds():
    assert {option for option, _ in CELLS} == {name for name, _ in options()}
    for name, key in options():
        for head, way in _WAYS.items():
            held = "same" if way in key.holds else "none"
            assert CELLS[name, head] == ("refused" if way in key.refused else held), (name, head)
