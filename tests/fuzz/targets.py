"""What is done with a damaged file, and what must not come of it."""

import contextlib
import io
import math
import random
import resource
import signal
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from eventpound.case import Case, load_case
from eventpound.case.loading import read_document
from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.motion.readers import RecordData, read_components, read_record
from eventpound.motion.record import Record
from eventpound.scene.check import check_scene
from eventpound.simulation import check_solver, task_of
from eventpound.study.reading import load_study
from tests.fuzz.damage import damaged_case, damaged_record
from tests.models import CASES
from tests.motion.readers.writers import WRITERS, Written, motion

LONGEST = 5.0
"""Processor time after which reading counts as a hang (s)."""
MEMORY = 6 * 2**30
"""Address space of a long run (bytes)."""
LONGEST_LINE = 1000
"""Characters of a message that a person would still read."""
SIZE, STEP = 60, 0.1


class HangError(BaseException):
    """Reading took too long; no reader catches it."""


class DefectError(AssertionError):
    """A reader did what it must not."""


@contextlib.contextmanager
def bounded() -> Iterator[None]:
    """Stop what takes too long."""

    def stop(*_: object) -> None:
        raise HangError(f"more than {LONGEST} s")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def limit_memory() -> None:
    """Turn an explosion of memory into a MemoryError."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def seeds_of_cases() -> list[str]:
    """Text of every case of the repository."""
    files = sorted(CASES.glob("*/case.toml")) + sorted(CASES.glob("hard/*/case.toml"))
    return [file.read_text() for file in files]


def try_case(content: bytes, folder: Path) -> str:
    """Read a case file; a word for how it ended.

    Raises
    ------
    DefectError
        Where a message is of no use, or what was accepted cannot be run.
    """
    file = folder / "case.toml"
    file.write_bytes(content)
    try:
        with bounded():
            document, _, _ = read_document(file)
            if "study" in document:
                load_study(file)
                return "study"
            case = load_case(file)
            if case.suite is None and case.scene.bodies:
                check_scene(case.scene)
                _try_task(case)
            with (
                contextlib.redirect_stdout(io.StringIO()),
                contextlib.redirect_stderr(io.StringIO()),
            ):
                ended = main(["check", str(file)])
            _require((ended == 0) == _has_solver(case), "check and run do not refuse the same")
        return "case"
    except InputError as error:
        _check_messages(error, str(folder))
        return "refused"


def _has_solver(case: Case) -> bool:
    """Whether there is the solver, with the settings, that a case asks for."""
    try:
        check_solver(case.solver)
    except InputError as error:
        _check_messages(error, "solver")
        return False
    return True


def _try_task(case: Case) -> None:
    """The task of a case; a solver may refuse its options, without the file's name."""
    try:
        task = task_of(case)
    except InputError as error:
        _check_messages(error, "solver")
        return
    _require(bool(np.isfinite(task.output_times).all()), "output times not finite")
    _require(math.isfinite(task.end) and task.end > task.start, "no time to run")


def written_records() -> list[tuple[str, Written]]:
    """One sound file of every text format."""
    return [(name, writer(motion(SIZE, STEP), STEP)) for name, writer in WRITERS.items()]


def try_record(content: bytes, written: Written, folder: Path, named: bool) -> str:
    """Read a record file; a word for how it ended.

    Raises
    ------
    DefectError
        Where a message is of no use, or what was read is no accelerogram.
    """
    file = folder / "damaged.txt"
    file.write_bytes(content)
    options = {
        "format": written.format if named else None,
        "units": written.units or "g",
        "time_step": written.time_step or STEP,
        "as_needed": True,
    }
    found: list[RecordData] = []
    try:
        with bounded():
            found = read_components(file, **options)
            for data in found:
                _check_data(data)
            found.append(read_record(file, component="#1", **options))
            _check_data(found[-1])
        return "read"
    except InputError as error:
        _check_messages(error, str(file))
        return "refused"


def _check_data(data: RecordData) -> None:
    _require(data.acceleration.ndim == 1 and data.acceleration.size >= 2, "too few samples")
    _require(bool(np.isfinite(data.acceleration).all()), "samples not finite")
    _require(bool(np.any(data.acceleration)), "samples all zero")
    _require(math.isfinite(data.time_step) and data.time_step > 0.0, "time step")
    Record(data.acceleration, data.time_step)


def _check_messages(error: InputError, named: str) -> None:
    _require(bool(error.problems), "an error without a message")
    for problem in error.problems:
        _require("\n" not in problem, f"a message of several lines: {problem[:300]!r}")
        _require(named in problem, f"a message without the file: {problem[:300]!r}")
        _require(len(problem) < LONGEST_LINE, f"a long message: {problem[:300]!r}")


def _require(condition: bool, text: str) -> None:
    if not condition:
        raise DefectError(text)


def case_attempts(seed: int, folder: Path) -> Iterator[tuple[bytes, Callable[[], str]]]:
    """Damaged case files without end, and how each is tried."""
    random_, seeds = random.Random(seed), seeds_of_cases()
    while True:
        content = damaged_case(random_.choice(seeds), seeds, random_)
        yield content, lambda content=content: try_case(content, folder)


def record_attempts(seed: int, folder: Path) -> Iterator[tuple[bytes, Callable[[], str]]]:
    """Damaged record files without end, every format in turn, and how each is tried."""
    random_, formats = random.Random(seed), written_records()
    while True:
        for _, written in formats:
            content = damaged_record(written.text.encode(), random_)
            named = random_.random() < 0.5
            yield (
                content,
                lambda content=content, written=written, named=named: try_record(
                    content, written, folder, named
                ),
            )


ATTEMPTS: dict[str, Callable[[int, Path], Iterator[tuple[bytes, Callable[[], str]]]]] = {
    "cases": case_attempts,
    "records": record_attempts,
}


def defects(
    kind: str, count: int, seed: int, folder: Path
) -> Iterator[tuple[int, bytes, str | BaseException]]:
    """Number, content and outcome of `count` damaged files: a word, or what must not happen."""
    for number, (content, attempt) in zip(range(count), ATTEMPTS[kind](seed, folder), strict=False):
        try:
            yield number, content, attempt()
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # anything but an InputError is a defect
            yield number, content, error


__all__: Sequence[str] = ["ATTEMPTS", "defects", "limit_memory", "try_case", "try_record"]
