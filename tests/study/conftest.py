"""Studies that take a moment."""

import pytest

from eventpound.study.reading import load_study
from eventpound.study.table import compute, header

ELASTOPLASTIC = """
[excitation]
kind = "cosine"

[pi]
structure = "elastoplastic"
uy = 0.2
epsilon = 0.6
periods = 6

[study]
quantities = ["pi_um", "free.pi_um", "amplification", "impacts", "resting_time"]
[[study.axis]]
key = "excitation.reverse"
values = [false, true]
[[study.axis]]
key = "pi.delta"
values = [0.1, 0.5]
[[study.axis]]
key = "pi.Q"
from = 0.1
to = 1.6
count = 40
"""


@pytest.fixture
def make_study(tmp_path):
    """Loader of a study from the text of its case."""

    def make(text: str = ELASTOPLASTIC, name: str = "case"):
        folder = tmp_path / name
        folder.mkdir(exist_ok=True)
        (folder / "case.toml").write_text(text)
        return load_study(folder)

    return make


def expected_table(study):
    return header(study) + b"".join(compute(study, chunk) for chunk in study.chunks())


def table_by(engine, study, at=-1, act=None):
    """The table of an engine, which gives each chunk once; before the chunk `at` something acts."""
    found = {}
    for chunk, rows in engine.run(study, study.chunks()):
        if len(found) == at:
            act()
        assert chunk.number not in found
        found[chunk.number] = rows
    return header(study) + b"".join(found[number] for number in sorted(found))
