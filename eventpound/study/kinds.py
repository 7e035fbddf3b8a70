"""Which kind of thing a path holds: asked here, at the door, and nowhere behind it."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

from eventpound.case.loading import CASE_FILE, read_document
from eventpound.errors import InputError

CASES = f"*/{CASE_FILE}"
"""Pattern of the cases of a folder."""


T = TypeVar("T")


class Holds(StrEnum):
    """What a case is, or its results are of."""

    RUN = "run"
    SUITE = "suite"
    STUDY = "study"
    FOLDER = "folder"

    def choose(self, *, run: T, suite: T, study: T, folder: T) -> T:
        """Of four things the one that is for this kind."""
        return {"run": run, "suite": suite, "study": study, "folder": folder}[self.value]


def has_records(document: Mapping[str, object]) -> bool:
    """Whether the tables of a case ask for many records."""
    excitation = document.get("excitation")
    return isinstance(excitation, dict) and bool({"suite", "synthetic"} & set(excitation))


def is_folder(path: Path) -> bool:
    """Whether a directory holds cases and is none."""
    return not (path / CASE_FILE).is_file() and any(path.glob(CASES))


def kind_of(path: Path) -> tuple[Holds, Mapping[str, object]]:
    """What a directory holds, and the tables of its case.

    Raises
    ------
    InputError
        Where there is neither a case nor a folder of cases.
    """
    if is_folder(path):
        return Holds.FOLDER, {}
    document, _, _ = read_document(path)
    if "study" in document:
        return Holds.STUDY, document
    return Holds.SUITE if has_records(document) else Holds.RUN, document


def kind_of_results(out: Path, path: Path) -> tuple[Holds, Mapping[str, object]]:
    """What results are of, by their table, else by the case, which need not be there any more."""
    # Who only asks what a case is does not pay for what makes tables.
    from eventpound.study.forms import SUITE_TABLE
    from eventpound.study.table import table_there

    try:
        kind, document = kind_of(path)
    except InputError:
        kind, document = Holds.RUN, {}
    table = table_there(out)
    if table and kind is not Holds.FOLDER:
        return (Holds.SUITE if table == SUITE_TABLE else Holds.STUDY), document
    # A suite without its table is drawn as the run whose results are there.
    return (Holds.RUN if kind is Holds.SUITE else kind), document
