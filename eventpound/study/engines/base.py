"""What an engine is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Protocol

from eventpound.study.plan import Chunk, Plan


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
