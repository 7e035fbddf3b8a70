"""A study or a suite from its plan to its table: what is there is kept, what is missing is made."""

from __future__ import annotations

from pathlib import Path

from eventpound.basics.progress import Counted
from eventpound.results.files import check_writable, only_one
from eventpound.study.engines.base import Engine
from eventpound.study.parquet import PARQUET, write_parquet
from eventpound.study.plan import Plan
from eventpound.study.store import Details, Store
from eventpound.study.table import header

AT_WORK = ".study-at-work"
"""File that is in a directory while a study is made there."""


def run_study(
    study: Plan,
    directory: Path,
    engine: Engine,
    progress: Counted | None = None,
    details: Details | None = None,
    *,
    again: bool = False,
) -> Path | None:
    """Compute what is missing of a study and write its table.

    Parameters
    ----------
    study : Plan
        What is computed.
    directory : Path
        Where the table and its manifest go, and meanwhile the chunks.
    engine : Engine
        What computes it; it changes nothing in the table.
    progress : callable, optional
        Called at first and after every chunk.
    details : callable, optional
        Gives what is written beside the table of a suite. If that is stopped, the rows that are
        done are written.
    again : bool
        Whether a table that is done is made again.

    Returns
    -------
    Path or None
        Where results of another study or of a run, that lay in the directory, were moved.

    Raises
    ------
    InputError
        Where the directory cannot be written to, or another program makes a study there.
    ComputationError
        Where the engine gave up; chunks that are stored stay.
    """
    check_writable(directory)
    store = Store(directory, study)
    own = {"title": study.title, "runs": study.size}
    details = details or (lambda: ({}, own | study.described()))
    moved = None
    with only_one(directory, AT_WORK):
        if again or not store.finished():
            try:
                _compute_missing(study, store, engine, progress)
            except KeyboardInterrupt:
                if study.suite is not None and store.stored():
                    store.finish(header(study), details)
                raise
            moved = store.finish(header(study), details)
        store.clear()
        if study.suite is None and not (directory / PARQUET).exists():
            write_parquet(study, directory)
    return moved


def _compute_missing(study: Plan, store: Store, engine: Engine, progress: Counted | None) -> None:
    there = store.stored()
    done = sum(c.high - c.low for c in study.chunks() if c.number in there)
    missing = (chunk for chunk in study.chunks() if chunk.number not in there)
    if progress is not None:
        progress(done, study.size)
    for chunk, rows in engine.run(study, missing):
        store.put(chunk.number, rows)
        done += chunk.high - chunk.low
        if progress is not None:
            progress(done, study.size)
