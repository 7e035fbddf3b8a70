"""In this process: the fast solver runs each chunk as one batch on all cores."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from eventpound.study.chunk import compute
from eventpound.study.plan import Chunk, Study


class Batch:
    """Chunks one after the other, in this process."""

    def run(self, study: Study, chunks: Iterable[Chunk]) -> Iterator[tuple[Chunk, bytes]]:
        """Compute chunks of a study."""
        for chunk in chunks:
            yield chunk, compute(study, chunk, workers=None)
