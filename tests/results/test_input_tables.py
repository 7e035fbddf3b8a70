"""Which ends and laws a table of inputs names."""

from pathlib import Path

from eventpound.case import read_case
from eventpound.results.input_tables import input_lines
from eventpound.results.inputs import inputs_of
from tests.scene.test_at_rest import document


def test_check_names_what_counts():
    lines = dict(input_lines(inputs_of(read_case(document(0.02), Path("case.toml")))))
    said = "springs that count in modes, T1 and damping: pier; springs that do not: cable"
    assert lines["at rest"] == said
    lines = dict(input_lines(inputs_of(read_case(document(0.0), Path("case.toml")))))
    assert (
        "at a kink (the smaller stiffness counts, so that no period is too short): cable"
        in (lines["at rest"])
    )
