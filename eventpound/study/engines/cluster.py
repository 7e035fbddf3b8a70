"""Workers of a Dask cluster, on this machine or on many."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Iterator
from typing import Any

from eventpound.errors import ComputationError, InputError
from eventpound.study.engines.local import computed
from eventpound.study.plan import Chunk, Plan
from eventpound.study.table import compute

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
