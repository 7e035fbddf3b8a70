"""A process may end while another of its threads still computes."""

import subprocess
import sys

import pytest

PROGRAM = """
import sys, threading, time
from eventpound.simulation import response_of
from tests.solvers.test_returned import scenes

shaken = scenes()[1]
response_of(shaken, sys.argv[1], 1e-6, duration=0.1)
begun = threading.Event()

def work():
    while True:
        response_of(shaken, sys.argv[1], 1e-13, duration=10.0, progress=lambda t: begun.set())

for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
begun.wait()
time.sleep(0.2)
"""


@pytest.mark.parametrize(
    ("solver", "times"),
    [("cvode", 1), *(pytest.param(s, 4, marks=pytest.mark.sweep) for s in ("cvode", "ida"))],
)
def test_the_end_of_a_process_frees_nothing_in_use(solver, times):
    for _ in range(times):
        done = subprocess.run([sys.executable, "-c", PROGRAM, solver], check=False)
        assert done.returncode == 0
