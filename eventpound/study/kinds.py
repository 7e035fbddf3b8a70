"""Which kind of thing a path holds: asked here, at the door, and nowhere behind it."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path

from eventpound.case.loading import CASE_FILE, read_document
from eventpound.errors import InputError
from eventpound.study.table import SUITE_TABLE, TABLE

CASES = f"*/{CASE_FILE}"
"""Pattern of the cases of a folder."""


class Kind(StrEnum):
    """What a case is, or its results are of."""

    RUN = "run"
    SUITE = "suite"
    STUDY = "study"
    FOLDER = "folder"


def has_records(document: Mapping[str, object]) -> bool:
    """Whether the tables of a case ask for many records."""
    excitation = document.get("excitation")
    return isinstance(excitation, dict) and bool({"suite", "synthetic"} & set(excitation))


def kind_of(path: Path) -> tuple[Kind, Mapping[str, object]]:
    """What a directory holds, and the tables of its case.

    Raises
    ------
    InputError
        Where there is neither a case nor a folder of cases.
    """
    if not (path / CASE_FILE).is_file() and any(path.glob(CASES)):
        return Kind.FOLDER, {}
    document, _, _ = read_document(path)
    if "study" in document:
        return Kind.STUDY, document
    return Kind.SUITE if has_records(document) else Kind.RUN, document


def kind_of_results(out: Path, path: Path) -> tuple[Kind, Mapping[str, object]]:
    """What results are of, by their table, else by the case, which need not be there any more."""
    try:
        kind, document = kind_of(path)
    except InputError:
        kind, document = Kind.RUN, {}
    if kind is not Kind.FOLDER and (out / SUITE_TABLE).is_file():
        return Kind.SUITE, document
    if kind is not Kind.FOLDER and (out / TABLE).is_file():
        return Kind.STUDY, document
    # A suite without its table is drawn as the run whose results are there.
    return (Kind.RUN if kind is Kind.SUITE else kind), document
