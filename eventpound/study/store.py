"""Chunks of a study on disk, each there whole or not at all, and what is made of them.

    results/unfinished-<hash>/000017.csv   rows of a chunk, no header
    results/study.csv                      the table, when all are there
    results/manifest.json                  what it is the table of; written after it
    results/earlier-<hash>/                a finished study that was another

The hash is that of all that decides the table, so that the chunks of a changed
case lie beside those of the case as it was, and neither is taken for the other.
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterator
from pathlib import Path

from eventpound.errors import InputError
from eventpound.results.files import plain_name, write_stream, write_together
from eventpound.results.jsontext import to_json
from eventpound.results.read import MANIFEST
from eventpound.study.plan import Study
from eventpound.study.table import TABLE, read_manifest

FORMAT = "eventpound-study/1"
"""Name and number of the form of the files."""
_DIGITS = 12
_BLOCK = 1 << 20


class Store:
    """The chunks of one study in one directory.

    Parameters
    ----------
    directory : Path
        Where the results go.
    study : Study
        Whose they are.
    """

    def __init__(self, directory: Path, study: Study) -> None:
        self.directory, self.study = directory, study
        self.unfinished = directory / f"unfinished-{study.digest[:_DIGITS]}"

    def finished(self) -> bool:
        """Whether the table of this very study is there, whole."""
        manifest = read_manifest(self.directory)
        if manifest is None or manifest.get("study_sha256") != self.study.digest:
            return False
        files = manifest.get("files")
        expected = files.get(TABLE) if isinstance(files, dict) else None
        path = self.directory / TABLE
        return path.is_file() and _hash(path) == expected

    def stored(self) -> set[int]:
        """Numbers of the chunks that are there."""
        return {int(path.stem) for path in self.unfinished.glob("[0-9]*.csv")}

    def put(self, number: int, rows: bytes) -> None:
        """Keep a chunk."""
        write_together(self.unfinished, {_name(number): rows})

    def finish(self, header: bytes, details: dict[str, object]) -> Path | None:
        """Make the table of all chunks, then its manifest.

        Parameters
        ----------
        header : bytes
            First line of the table.
        details : dict
            What the manifest says beside the hashes.

        Returns
        -------
        Path or None
            Where results of another study or of a run were moved; None where there were none.
        """
        moved = self._set_aside()
        _, table_hash = write_stream(self.directory, TABLE, self._pieces(header))
        manifest = {
            "format": FORMAT,
            "study_sha256": self.study.digest,
            **details,
            "files": {TABLE: table_hash},
        }
        write_together(self.directory, {MANIFEST: to_json(manifest)})
        return moved

    def clear(self) -> None:
        """Let go what led to the table that is there: chunks, and what was left half written."""
        shutil.rmtree(self.unfinished, ignore_errors=True)
        # What a process left that was killed while it wrote the table.
        for path in self.directory.glob(f".{TABLE}.*.partial"):
            path.unlink(missing_ok=True)

    def _pieces(self, header: bytes) -> Iterator[bytes]:
        yield header
        for chunk in self.study.chunks():
            yield (self.unfinished / _name(chunk.number)).read_bytes()

    def _set_aside(self) -> Path | None:
        """Move the results of another study, or of a run, out of the way; where to."""
        manifest = read_manifest(self.directory)
        if manifest is None or manifest.get("study_sha256") == self.study.digest:
            return None
        digest = plain_name(str(manifest.get("study_sha256", "run")))
        earlier = self.directory / f"earlier-{digest[:_DIGITS]}"
        try:
            earlier.mkdir(exist_ok=True)
            for path in list(self.directory.iterdir()):
                if path.is_file() and path.name != MANIFEST:
                    path.replace(earlier / path.name)
            (self.directory / MANIFEST).replace(earlier / MANIFEST)
        except OSError as error:
            raise InputError(f"{earlier}: cannot be written to: {error.strerror}") from error
        return earlier


def _name(number: int) -> str:
    return f"{number:06d}.csv"


def _hash(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()
