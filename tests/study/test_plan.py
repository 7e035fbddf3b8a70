"""Chunks of a plan change no row."""

from eventpound.study.plan import Chunk
from eventpound.study.table import compute


def test_rows_do_not_depend_on_the_chunks_they_are_in(make_study):
    study = make_study().study
    whole = compute(study, Chunk(0, 0, 0, 80))
    parts = [(0, 1), (1, 30), (30, 80)]
    assert b"".join(compute(study, Chunk(0, 0, a, b)) for a, b in parts) == whole
