"""Processes of this machine: for the solvers that compute one run at a time."""

from __future__ import annotations

import signal
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

from eventpound.errors import ComputationError
from eventpound.study.chunk import compute
from eventpound.study.plan import Chunk, Study

_MOST_BREAKS = 8
_study: Study | None = None


def _begin(study: Study) -> None:
    """Keep the study in a new process, so that a chunk is all that is sent."""
    global _study
    # Ctrl-C reaches every process of a terminal; the one that asked for the chunks answers it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _study = study


def _compute(chunk: Chunk) -> bytes:
    assert _study is not None
    return compute(_study, chunk, workers=1)


class Processes:
    """Chunks on several processes of this machine.

    Parameters
    ----------
    workers : int
        How many.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def run(self, study: Study, chunks: Iterable[Chunk]) -> Iterator[tuple[Chunk, bytes]]:
        """Compute chunks of a study; a process that dies is replaced, its chunk made again."""
        waiting, breaks = iter(chunks), 0
        lost: list[Chunk] = []
        while True:
            unfinished: list[Chunk] = []
            try:
                yield from self._one_pool(study, waiting, lost, unfinished)
            except BrokenProcessPool as error:
                breaks += 1
                if breaks > _MOST_BREAKS:
                    raise ComputationError(
                        f"processes died {breaks} times, the last time at one of the chunks "
                        f"{[chunk.number for chunk in unfinished]}; what is stored is kept",
                        0.0,
                    ) from error
                lost = unfinished
            else:
                return

    def _one_pool(
        self,
        study: Study,
        waiting: Iterator[Chunk],
        lost: list[Chunk],
        unfinished: list[Chunk],
    ) -> Iterator[tuple[Chunk, bytes]]:
        """Compute on one set of processes; `unfinished` holds what is in flight."""
        # A process that was forked from one with threads may hang.
        pool = ProcessPoolExecutor(self.workers, get_context("spawn"), _begin, (study,))
        running: dict[Future[bytes], Chunk] = {}

        def submit(chunk: Chunk) -> None:
            unfinished.append(chunk)
            running[pool.submit(_compute, chunk)] = chunk

        try:
            for chunk in lost:
                submit(chunk)
            while True:
                while len(running) < self.workers + 1:
                    following = next(waiting, None)
                    if following is None:
                        break
                    submit(following)
                if not running:
                    return
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    rows, chunk = future.result(), running.pop(future)
                    unfinished.remove(chunk)
                    yield chunk, rows
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
