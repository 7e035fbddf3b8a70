"""``python -m tests.interrupts.worker JOB COUNT SEED FOLDER``: interrupt one job again and again.

A line for each interrupt: the exit code, or the name of the exception. Whoever started this
process learns of a crash by its end.
"""

import io
import os
import random
import signal
import sys
import threading
import time
import traceback
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from tests.interrupts.jobs import INTERRUPTED, JOBS, Job, prepare

AFTER = 1e-3
"""Seconds that a signal may come after the job."""


def once(job: Job, folder: Path, after: float) -> str:
    """The exit code of a job that is interrupted `after` so many seconds, or what it raises."""
    over = threading.Event()

    def interrupt() -> None:
        if not over.wait(after):
            os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    outcome = ""
    try:
        thread.start()
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            outcome = str(job.do(folder))
        over.set()
        thread.join()
        time.sleep(AFTER)
    except KeyboardInterrupt:
        outcome = outcome or str(INTERRUPTED)
    except BaseException as error:
        outcome = type(error).__name__
        print(job.command, job.solver, traceback.format_exc(), file=sys.__stderr__)
    over.set()
    thread.join()
    return outcome


def main() -> None:
    """Run the job once without a signal, which says how long it takes, then interrupt it."""
    # A process that was started in the background ignores them.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    number, count, seed = (int(word) for word in sys.argv[1:4])
    folder, job = Path(sys.argv[4]), JOBS[number]
    if not (folder / "case").exists():
        prepare(folder)
    began = time.perf_counter()
    once(job, folder, 1e6)
    length = time.perf_counter() - began
    began = time.perf_counter()
    once(job, folder, 1e6)
    length = min(length, time.perf_counter() - began)
    dice = random.Random(seed)
    print(f"{length:.3f}", flush=True)
    for _ in range(count):
        print(once(job, folder, dice.uniform(0.0, length)), flush=True)


if __name__ == "__main__":
    main()
