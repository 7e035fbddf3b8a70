"""A few interrupts of what runs compiled code; ``python -m tests.interrupts`` makes more."""

import signal

import pytest

from tests.interrupts.jobs import JOBS
from tests.interrupts.table import interrupted, line

CALLS = [
    number
    for number, job in enumerate(JOBS)
    if job.command in ("simulate", "simulate, thread") and job.solver in ("cvode", "ida")
]


@pytest.fixture(autouse=True)
def in_the_background():
    """As where a shell starts the tests in the background: what they start ignores SIGINT."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(
    "number",
    [CALLS[-1], *(pytest.param(n, marks=pytest.mark.sweep) for n in CALLS[:-1])],
    ids=lambda n: f"{JOBS[n].command} {JOBS[n].solver}",
)
def test_an_interrupt_is_no_crash(number, tmp_path):
    row = interrupted(number, 6, 1, tmp_path)
    assert not row.wrong, line(row)
    assert row.ends["130"] > 0
