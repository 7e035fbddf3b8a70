"""The folder of a set of problems, and the answer of each.

``set.toml`` names the set, its version and its problems, each a directory with a
``case.toml``, perhaps a record, and an ``answer.json``. ``frozen.json`` holds the SHA-256 of
every one of these files: with the version it makes the set what others can cite.
``frozen-VERSION.json`` are those of earlier versions, whose problems a version that begins with
the same number has, too, byte for byte.

    columns     quantity, value, bound, amplification, scale
    events      kind, contact, t, bound of t, rates of the gap before and after (m/s)

as a certificate has them (page "accuracy" of the docs): peaks and their times, final values,
``history.<k>.<body>`` at the `MOMENTS` - 1 moments k T/`MOMENTS` of a run of length T. A
number without a bound is no part of the answer; of impacts only those faster than `LISTED`
of the fastest are, since slower ones are told apart by rounding.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eventpound.accuracy.certificate import Certificate, CertifiedQuantity
from eventpound.accuracy.verify import PATIENCE, Report, verify
from eventpound.case import load_case
from eventpound.case.case import Case
from eventpound.case.run_options import RunOptions
from eventpound.errors import InputError
from eventpound.mechanics.model import assemble
from eventpound.results import write_together
from eventpound.results.jsontext import canonical, read_json, to_json
from eventpound.results.manifest import sha256
from eventpound.score.levels import LISTED
from eventpound.solvers.base import EventKind

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


MOMENTS = 40
"""Equal parts of a run at whose borders displacements are stated."""
COLUMNS = ("quantity", "value", "bound", "amplification", "scale")
EVENT_COLUMNS = ("kind", "contact", "t", "t_bound", "before", "after")


def moments_of(options: RunOptions) -> list[float]:
    """The times (s) at which a history is stated, the ends of the run not among them."""
    return [options.start_time + options.duration * k / MOMENTS for k in range(1, MOMENTS)]


def answer_of(
    collection: Collection,
    problem: ProblemFolder,
    *,
    patience: float = PATIENCE,
    report: Report | None = None,
) -> tuple[dict[str, object], Certificate]:
    """Certify a problem.

    Parameters
    ----------
    collection : Collection
        The set.
    problem : ProblemFolder
        One of it.
    patience : float
        Wall time (s) after which a run of a route is given up.
    report : callable, optional
        Told what is done next.

    Returns
    -------
    answer : dict
        The content of its ``answer.json``.
    certificate : Certificate
        What it is from.
    """
    case = problem.case()
    moments = moments_of(case.run)
    certificate = verify(case, moments=moments, patience=patience, report=report)
    bounded = [q for q in certificate.quantities if q.bound is not None]
    known = {q.quantity: q for q in certificate.quantities}
    states = [q for q in bounded if not q.quantity.startswith("events.")]
    events = _events(certificate, known)
    model = assemble(case.scene)
    answer: dict[str, object] = {
        "set": f"{collection.name} {collection.version}",
        "problem": problem.name,
        "certified": certificate.certified,
        "independent": None,
        "reference": certificate.reference,
        "routes": [route.label for route in certificate.solver_routes if not route.message],
        "properties": {
            "bodies": model.bodies,
            "contacts": model.contacts,
            "events": dict(Counter(str(event[0]) for event in events)),
            "amplification": _rounded(max((q.amplification or 0.0 for q in states), default=0.0)),
            "near_misses": len(certificate.near_misses),
            "grazes": len(certificate.grazes),
        },
        "moments": moments,
        "columns": COLUMNS,
        "quantities": [
            [q.quantity, q.value, _rounded(q.bound), _rounded(q.amplification), q.scale]
            for q in states
        ],
        "event_columns": EVENT_COLUMNS,
        "events": events,
    }
    return answer, certificate


def _events(certificate: Certificate, known: dict[str, CertifiedQuantity]) -> list[list[object]]:
    """Events in order, slow impacts left out; a bound of None where there is none."""
    impact = EventKind.IMPACT.value
    speeds = [-float(str(e["gap_velocity_before"])) for e in certificate.events]
    fastest = max(
        (s for s, e in zip(speeds, certificate.events, strict=True) if e["kind"] == impact),
        default=0.0,
    )
    listed: list[list[object]] = []
    for speed, event in zip(speeds, certificate.events, strict=True):
        if event["kind"] == impact and speed <= LISTED * fastest:
            continue
        head = f"events.{event['row']}"
        t = known.get(f"{head}.t")
        after = known.get(f"{head}.gap_velocity_after")
        listed.append(
            [
                event["kind"],
                event["contact"],
                event["t"],
                None if t is None else _rounded(t.bound),
                event["gap_velocity_before"],
                None if after is None else after.value,
            ]
        )
    return listed


def _rounded(value: float | None) -> float | None:
    """Two digits, never less than the value."""
    if value is None or not np.isfinite(value):
        return None
    return float(f"{1.05 * value:.1e}")
