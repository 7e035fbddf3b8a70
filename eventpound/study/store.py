"""Chunks of a study on disk, each there whole or not at all, and what is made of them.

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
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from eventpound.errors import InputError
from eventpound.results.files import plain_name, write_stream, write_together
from eventpound.results.jsontext import to_json
from eventpound.results.manifest import sha256
from eventpound.study.plan import Plan
from eventpound.study.table import MANIFEST, SUITE_MANIFEST, files_of, manifest_there

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
        self.table, self.manifest = files_of(study)
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
