"""A study or a suite from its plan to its table: what is there is kept, what is missing is made.

    results/unfinished-<hash>/000017.csv   rows of a chunk, no header
    results/study.csv                      the table, when all are there
    results/manifest.json                  what it is the table of; written after it
    results/earlier-<hash>/                a finished study that was another

Of a suite the two files are suite.csv and suite.json.

The hash is that of all that decides the table, so that the chunks of a changed
case lie beside those of the case as it was, and neither is taken for the other.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from eventpound.basics.told import Counted
from eventpound.errors import InputError
from eventpound.results.files import (
    check_writable,
    only_one,
    plain_name,
    write_stream,
    write_together,
)
from eventpound.results.jsontext import to_json
from eventpound.results.manifest import sha256
from eventpound.study.base import RECORD
from eventpound.study.engine import Engine
from eventpound.study.forms import MANIFEST, MESSAGE, SUCCESS, SUITE_MANIFEST, TABLE
from eventpound.study.plan import Plan
from eventpound.study.table import header, manifest_there

FORMAT = "eventpound-study/1"
"""Name and number of the form of the files."""
Details = Callable[[], tuple[Mapping[str, bytes], Mapping[str, object]]]
_DIGEST = "study_sha256"
_DIGITS = 12


class Store:
    """The chunks of one study or suite in one directory.

    Parameters
    ----------
    directory : Path
        Where the results go.
    study : Plan
        Whose they are.
    """

    def __init__(self, directory: Path, study: Plan) -> None:
        self.directory, self.study = directory, study
        self.table, self.manifest = study.form.table, study.form.manifest
        self.unfinished = directory / f"unfinished-{study.digest[:_DIGITS]}"

    def finished(self) -> bool:
        """Whether the table of this very study is there, whole."""
        manifest = manifest_there(self.directory, self.manifest)
        if manifest is None or manifest.get(_DIGEST) != self.study.digest:
            return False
        files = manifest.get("files")
        expected = files.get(self.table) if isinstance(files, dict) else None
        path = self.directory / self.table
        whole = manifest.get("complete", True) is True
        return whole and path.is_file() and _hash(path) == expected

    def stored(self) -> set[int]:
        """Numbers of the chunks that are there."""
        return {int(path.stem) for path in self.unfinished.glob("[0-9]*.csv")}

    def put(self, number: int, rows: bytes) -> None:
        """Keep a chunk."""
        write_together(self.unfinished, {_name(number): rows})

    def finish(self, header: bytes, details: Details) -> Path | None:
        """Make the table of the chunks that are there, then its manifest.

        Parameters
        ----------
        header : bytes
            First line of the table.
        details : callable
            Gives further files, and what the manifest says beside the hashes; called when the
            table is there.

        Returns
        -------
        Path or None
            Where results of another study or of a run were moved; None where there were none.
        """
        moved = self._set_aside()
        _, table_hash = write_stream(self.directory, self.table, self._pieces(header))
        further, said = details()
        hashes = {name: sha256(content) for name, content in further.items()}
        manifest = {
            "format": FORMAT,
            _DIGEST: self.study.digest,
            **said,
            "files": {self.table: table_hash, **hashes},
        }
        write_together(self.directory, {**further, self.manifest: to_json(manifest)})
        return moved

    def clear(self) -> None:
        """Let go what led to the table that is there: chunks, and what was left half written."""
        shutil.rmtree(self.unfinished, ignore_errors=True)
        # What a process left that was killed while it wrote the table.
        for path in self.directory.glob(f".{self.table}.*.partial"):
            path.unlink(missing_ok=True)

    def _pieces(self, header: bytes) -> Iterator[bytes]:
        yield header
        there = self.stored()
        for chunk in self.study.chunks():
            if chunk.number in there:
                yield (self.unfinished / _name(chunk.number)).read_bytes()

    def _set_aside(self) -> Path | None:
        """Move the results of another study, suite or run out of the way; where to."""
        there = {name: manifest_there(self.directory, name) for name in (MANIFEST, SUITE_MANIFEST)}
        found = [m for m in there.values() if m is not None]
        others = [m for m in found if m.get(_DIGEST) != self.study.digest]
        if not others:
            return None
        digest = plain_name(str(others[0].get(_DIGEST, "run")))
        earlier = self.directory / f"earlier-{digest[:_DIGITS]}"
        try:
            earlier.mkdir(exist_ok=True)
            for path in list(self.directory.iterdir()):
                if path.is_file() and path.name not in there:
                    path.replace(earlier / path.name)
            for name, manifest in there.items():
                if manifest is not None:
                    (self.directory / name).replace(earlier / name)
        except OSError as error:
            raise InputError(f"{earlier}: cannot be written to: {error.strerror}") from error
        return earlier


def _name(number: int) -> str:
    return f"{number:06d}.csv"


def _hash(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


PARQUET = "study.parquet"
_BLOCK = 1 << 18
"""Bytes of the table that are read at once: several such blocks are in memory."""


def write_parquet(study: Plan, directory: Path) -> bool:
    """Write ``study.parquet`` beside ``study.csv``, a block of rows at a time.

    Parameters
    ----------
    study : Plan
        Whose table it is.
    directory : Path
        Results of the study.

    Returns
    -------
    bool
        Whether pyarrow is installed, so that it was written.
    """
    if find_spec("pyarrow") is None:
        return False
    from pyarrow import csv, parquet, system_memory_pool

    target = directory / PARQUET
    temporary = directory / f".{PARQUET}.{os.getpid()}.partial"
    options = csv.ConvertOptions(column_types=_types(study), strings_can_be_null=False)
    try:
        with (
            csv.open_csv(
                directory / TABLE,
                read_options=csv.ReadOptions(block_size=_BLOCK),
                convert_options=options,
                # Others keep what they have been given back.
                memory_pool=system_memory_pool(),
            ) as blocks,
            parquet.ParquetWriter(temporary, blocks.schema) as writer,
        ):
            for block in blocks:
                writer.write_batch(block)
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
    return True


def _types(study: Plan) -> dict[str, Any]:
    """Types of the columns, which the first block alone need not show."""
    import pyarrow as pa

    words = {RECORD, *(name for base in study.bases for name in base.labels)}
    numbers = [name for name in (*study.columns, *study.quantities) if name not in words]
    types: dict[str, Any] = dict.fromkeys(words, pa.string()) | dict.fromkeys(numbers, pa.float64())
    return types | {SUCCESS: pa.bool_(), MESSAGE: pa.string()}


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
                if store.stored() and not study.form.whole:
                    store.finish(header(study), details)
                raise
            moved = store.finish(header(study), details)
        store.clear()
        if study.form.binary and not (directory / PARQUET).exists():
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
