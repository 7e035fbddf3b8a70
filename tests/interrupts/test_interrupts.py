"""A few interrupts of what runs compiled code; ``python -m tests.interrupts`` makes more."""

from pathlib import Path

import pytest

from tests.interrupts.jobs import JOBS
from tests.interrupts.table import interrupted, line

CALLS = [
    number
    for number, job in enumerate(JOBS)
    if job.command in ("simulate", "simulate, thread") and job.solver in ("cvode", "ida")
]


@pytest.mark.parametrize("number", CALLS, ids=lambda n: f"{JOBS[n].command} {JOBS[n].solver}")
def test_an_interrupt_is_no_crash(number: int, tmp_path: Path) -> None:
    row = interrupted(number, 6, 1, tmp_path)
    assert not row.wrong, line(row)
    assert row.ends["130"] > 0
