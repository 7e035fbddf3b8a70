"""The folder of a set: which problems it has, and whether they are those that were frozen.

``set.toml`` names the set, its version and its problems, each a directory with a
``case.toml``, perhaps a record, and an ``answer.json``. ``frozen.json`` holds the SHA-256 of
every one of these files: with the version it makes the set what others can cite.
``frozen-VERSION.json`` are those of earlier versions, whose problems a version that begins with
the same number has, too, byte for byte.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eventpound.case import load_case
from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.results import write_together
from eventpound.results.jsontext import canonical, read_json, to_json
from eventpound.results.manifest import sha256

INDEX, FROZEN, ANSWER = "set.toml", "frozen.json", "answer.json"
EARLIER = "frozen-{}.json"


@dataclass(frozen=True)
class ProblemFolder:
    """A problem of a set.

    Parameters
    ----------
    name : str
        Its number and name, its directory.
    tests : str
        What it tests, in a line.
    tags : tuple of str
        Its properties.
    folder : Path
        Where it is.
    """

    name: str
    tests: str
    tags: tuple[str, ...]
    folder: Path

    def case(self) -> Case:
        """What is to be computed."""
        return load_case(self.folder)

    def answer(self) -> dict[str, object]:
        """The certified answer.

        Raises
        ------
        InputError
            Where there is none.
        """
        return read_json(self.folder / ANSWER)


@dataclass(frozen=True)
class Collection:
    """A set of problems.

    Parameters
    ----------
    name, version : str
        What it is cited by.
    problems : tuple of ProblemFolder
        In order.
    folder : Path
        Where it is.
    """

    name: str
    version: str
    problems: tuple[ProblemFolder, ...]
    folder: Path

    def some(self, names: list[str]) -> tuple[ProblemFolder, ...]:
        """Problems by their names or numbers, all where none is named.

        Raises
        ------
        InputError
            Where there is no such problem.
        """
        known = {p.name: p for p in self.problems} | {
            p.name.split("-")[0]: p for p in self.problems
        }
        unknown = [name for name in names if name not in known]
        if unknown:
            raise InputError(f"{self.folder / INDEX}: has no problem {', '.join(unknown)}")
        return tuple(known[name] for name in names) or self.problems

    def hashes(self) -> dict[str, str]:
        """SHA-256 of every file of the set, by its path in the set."""
        files = [self.folder / INDEX]
        for problem in self.problems:
            files += sorted(p for p in problem.folder.iterdir() if p.is_file())
        return {
            file.relative_to(self.folder).as_posix(): sha256(file.read_bytes()) for file in files
        }

    def frozen(self) -> Mapping[str, str]:
        """The hashes with which the version was frozen; empty where it never was."""
        file = self.folder / FROZEN
        files = read_json(file).get("files") if file.is_file() else {}
        if not isinstance(files, dict):
            raise InputError(f"{file}: has no hashes under 'files'; --freeze writes it anew")
        return files

    def freeze(self) -> str:
        """Write the hashes of the set as it is; the hash of them all.

        Those of another version are kept under its name.

        Raises
        ------
        InputError
            Where a problem has no answer, or one of an earlier version is changed or gone.
        """
        for problem in self.problems:
            problem.answer()
        hashes = self.hashes()
        whole = sha256(canonical(hashes))
        content = {"set": self.name, "version": self.version, "sha256": whole, "files": hashes}
        written = {FROZEN: to_json(content)}
        for version, earlier in self._earlier().items():
            if version.partition(".")[0] == self.version.partition(".")[0]:
                self._check_kept(version, earlier["files"], hashes)
            written[EARLIER.format(version)] = to_json(earlier)
        write_together(self.folder, written)
        return whole

    def _earlier(self) -> dict[str, dict[str, Any]]:
        """What other versions were frozen as."""
        paths = [self.folder / FROZEN, *sorted(self.folder.glob(EARLIER.format("*")))]
        found = [read_json(path) for path in paths if path.is_file()]
        named = {str(one["version"]): one for one in found if "version" in one and "files" in one}
        return {version: one for version, one in named.items() if version != self.version}

    def _check_kept(
        self, version: str, earlier: Mapping[str, str], hashes: Mapping[str, str]
    ) -> None:
        other = sorted(n for n, known in earlier.items() if n != INDEX and hashes.get(n) != known)
        if other:
            raise InputError(
                f"{self.folder}: version {self.version} does not keep {', '.join(other[:5])} of "
                f"version {version}; accepted: more problems, or another first number"
            )

    def check_frozen(self) -> None:
        """Refuse a set that is not what was frozen under its version.

        Raises
        ------
        InputError
            Naming every file that differs.
        """
        frozen, now = self.frozen(), self.hashes()
        if not frozen:
            raise InputError(f"{self.folder}: was never frozen; --freeze does")
        other = sorted(name for name in {*frozen, *now} if frozen.get(name) != now.get(name))
        if other:
            raise InputError(
                f"{self.folder}: is not version {self.version} as it was frozen; "
                f"differs in {', '.join(other)}; give it another version in {INDEX} and --freeze"
            )


def read_collection(folder: Path) -> Collection:
    """The set of a folder.

    Raises
    ------
    InputError
        Where it has no ``set.toml``, or one that is not as it should be.
    """
    file = folder / INDEX
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
        problems = tuple(
            ProblemFolder(
                str(p["name"]), str(p["tests"]), tuple(p["tags"]), folder / str(p["name"])
            )
            for p in content["problem"]
        )
        found = Collection(str(content["name"]), str(content["version"]), problems, folder)
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise InputError(
            f"{file}: {error}; accepted: name, version, [[problem]] with name, tests, tags"
        ) from error
    missing = [p.name for p in problems if not p.folder.is_dir()]
    if missing:
        raise InputError(f"{file}: no directory {', '.join(missing)} beside it")
    return found
