"""Engines: threads and processes of this machine, or workers of a Dask cluster.

The fast solver leaves Python's lock while it runs a chunk, so threads share all cores. Any other
computes one run at a time, and is given processes.
"""

from __future__ import annotations

import os
import pickle
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from itertools import chain
from multiprocessing import get_context, parent_process
from threading import Thread
from typing import Any, Protocol

from eventpound.basics.cores import cores
from eventpound.basics.interruption import Deferred
from eventpound.basics.told import show_warning
from eventpound.case.solver_options import FAST
from eventpound.errors import ComputationError, InputError
from eventpound.study.plan import Chunk, Plan
from eventpound.study.table import Keep, compute


class Engine(Protocol):
    """Computes chunks, wherever.

    Duties: `run` yields every chunk once, in any order, with the bytes that
    `eventpound.study.table.compute` gives for it; it asks for a further chunk
    only when it can use it, so that a long study is never all in memory; a
    worker that dies costs time, not chunks; when the iterator is closed,
    nothing goes on working.
    """

    def run(self, study: Plan, chunks: Iterable[Chunk]) -> Iterator[tuple[Chunk, bytes]]:
        """Compute chunks of a study."""
        ...


_MOST_BREAKS = 8
_LOOK = 0.1
"""How long a signal waits at most (s) while all chunks are being computed."""
_study: Plan | None = None


class Batch:
    """Chunks in this process, each as one compiled call.

    Parameters
    ----------
    workers : int, optional
        Threads; as many as there are cores.
    keep : callable, optional
        Given every record of a suite and its response, one at a time.
    """

    def __init__(self, workers: int | None = None, keep: Keep | None = None) -> None:
        self.workers, self.keep = workers or cores(), keep

    def run(self, study: Plan, chunks: Iterable[Chunk]) -> Iterator[tuple[Chunk, bytes]]:
        """Compute chunks of a study."""
        pool = ThreadPoolExecutor(self.workers)
        try:
            yield from computed(
                lambda chunk: pool.submit(compute, study, chunk, self.keep),
                iter(chunks),
                lambda: self.workers + 1,
                {},
            )
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


class Processes:
    """Chunks on several processes of this machine.

    Parameters
    ----------
    workers : int
        How many.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def run(self, study: Plan, chunks: Iterable[Chunk]) -> Iterator[tuple[Chunk, bytes]]:
        """Compute chunks of a study; a process that dies is replaced, its chunk made again."""
        waiting, breaks = iter(chunks), 0
        while True:
            flight: dict[Chunk, Future[bytes] | None] = {}
            # A process that was forked from one with threads may hang.
            pool = ProcessPoolExecutor(self.workers, get_context("spawn"), _begin, (study,))
            try:
                yield from computed(
                    lambda chunk, pool=pool: pool.submit(_compute, chunk),  # type: ignore[misc]
                    waiting,
                    lambda: self.workers + 1,
                    flight,
                )
            except BrokenProcessPool as error:
                breaks += 1
                if breaks > _MOST_BREAKS:
                    raise ComputationError(
                        f"processes died {breaks} times, the last time at one of the chunks "
                        f"{[chunk.number for chunk in flight]}; what is stored is kept",
                        0.0,
                    ) from error
                waiting = chain(list(flight), waiting)
            else:
                return
            finally:
                pool.shutdown(wait=False, cancel_futures=True)


def engine_of(solver: str, processes: int | None = None) -> Engine:
    """What computes the chunks on this machine.

    Parameters
    ----------
    solver : str
        The fast one runs chunks in this process.
    processes : int, optional
        How many to use instead; as many as there are cores for another solver.
    """
    if processes is None and solver == FAST:
        return Batch()
    return Processes(processes or cores())


def computed(
    submit: Callable[[Chunk], Future[bytes]],
    waiting: Iterator[Chunk],
    room: Callable[[], int],
    flight: dict[Chunk, Future[bytes] | None],
) -> Iterator[tuple[Chunk, bytes]]:
    """Chunks as they are done, as many in `flight` as there is room for, which holds them.

    A signal that ends the program is answered when what is done by then has been handed over.
    """
    with Deferred(patient=False) as signals:
        while True:
            going_on = signals.noted is None
            while going_on and len(flight) < room() and (chunk := next(waiting, None)) is not None:
                flight[chunk] = None
                flight[chunk] = submit(chunk)
            running = {future: chunk for chunk, future in flight.items() if future is not None}
            if not running:
                return
            if going_on:
                wait(running, _LOOK, FIRST_COMPLETED)
            # In the order of the chunks, where several are done.
            for future, chunk in running.items():
                # The same signal may have ended the processes.
                if future.done() and not (signals.noted and future.exception()):
                    rows = future.result()
                    del flight[chunk]
                    yield chunk, rows
            if not going_on:
                return


def _begin(study: Plan) -> None:
    """Keep the study in a new process, so that a chunk is all that is sent."""
    global _study
    Thread(target=_end_with_parent, daemon=True).start()
    # Ctrl-C reaches every process of a terminal; the one that asked for the chunks answers it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.showwarning = show_warning
    _study = study


def _end_with_parent() -> None:
    """End once the one that asked is gone: killed, it cannot say that there are no more chunks."""
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _compute(chunk: Chunk) -> bytes:
    assert _study is not None
    return compute(_study, chunk)


_IN_FLIGHT_A_WORKER = 2
_MOST_LOSSES = 8


class Cluster:
    """Chunks on the workers of a Dask scheduler.

    Parameters
    ----------
    scheduler : str, optional
        Address of a running scheduler, ``"tcp://host:8786"``.
    workers : int
        Without a scheduler: how many processes to start on this machine.

    Raises
    ------
    InputError
        Where Dask is not installed, or the scheduler does not answer.
    """

    def __init__(self, scheduler: str | None = None, workers: int = 1) -> None:
        try:
            import distributed
        except ImportError:
            raise InputError(
                'Dask is not installed; pip install "eventpound[dask]" brings it'
            ) from None
        self._distributed: Any = distributed
        self.scheduler, self.workers = scheduler, workers

    def run(self, study: Plan, chunks: Iterable[Chunk]) -> Iterator[tuple[Chunk, bytes]]:
        """Compute chunks of a study; those of a worker that is lost are made again elsewhere."""
        with self._client() as client:
            # Sent once to each worker, not with every chunk; a task, because the scheduler makes
            # a task again that was lost with its worker.
            shared = client.submit(pickle.loads, pickle.dumps(study), pure=False)
            pool = client.get_executor(pure=False, retries=_MOST_LOSSES)
            flight: dict[Chunk, Any] = {}
            try:
                yield from computed(
                    lambda chunk: pool.submit(compute, shared, chunk),
                    iter(chunks),
                    lambda: _IN_FLIGHT_A_WORKER * max(1, len(client.nthreads())),
                    flight,
                )
            except Exception as error:
                numbers = [chunk.number for chunk in flight]
                raise ComputationError(
                    f"one of the chunks {numbers} ended as {error!r}; what is stored is kept", 0.0
                ) from error

    def _client(self) -> Any:
        """A client of the scheduler, or of one of our own that ends with it."""
        dask = self._distributed
        if self.scheduler is None:
            return dask.Client(n_workers=self.workers, threads_per_worker=1, dashboard_address=None)
        try:
            return dask.Client(self.scheduler, timeout="10s")
        except OSError as error:
            raise InputError(f"--scheduler {self.scheduler}: does not answer: {error}") from error
