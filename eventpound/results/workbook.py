"""Tables as a workbook that spreadsheets open (XLSX), a sheet a table; by XlsxWriter."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from datetime import datetime

Row = Sequence[str | float]
_LONGEST_NAME = 31
_FORBIDDEN = re.compile(r"[\[\]:*?/\\']")
_WIDEST = 200
"""Of a column, in pixels."""
_ANY_DAY = datetime(1980, 1, 1)
"""Of every workbook: the same tables make the same bytes."""


def workbook(sheets: Mapping[str, Sequence[Row]]) -> bytes:
    """A workbook, XLSX: headings in bold, in sight however far one scrolls.

    Parameters
    ----------
    sheets : mapping of str to sequence of rows
        Cells by the names of the sheets, the first row of each its headings; NaN is empty.
    """
    # Only who writes one imports it.
    from xlsxwriter import Workbook

    made, names = io.BytesIO(), set[str]()
    with Workbook(made, {"in_memory": True}) as book:
        book.set_properties({"created": _ANY_DAY})
        heading = book.add_format({"bold": True, "text_wrap": True})
        for wanted, rows in sheets.items():
            sheet = book.add_worksheet(_sheet_name(wanted, names))
            sheet.freeze_panes(1, 0)
            for i, row in enumerate(rows):
                style = heading if i == 0 else None
                for k, cell in enumerate(row):
                    if isinstance(cell, str):
                        sheet.write_string(i, k, cell, style)
                    elif cell == cell:
                        sheet.write_number(i, k, cell, style)
            sheet.autofit(_WIDEST)
    return made.getvalue()


def _sheet_name(wanted: str, names: set[str]) -> str:
    """A name that a workbook may have, which is noted among those that it has."""
    stem = (_FORBIDDEN.sub(" ", wanted).strip() or "table")[:_LONGEST_NAME]
    name, number = stem, 2
    while name.lower() in names:
        tail = f" {number}"
        name, number = stem[: _LONGEST_NAME - len(tail)] + tail, number + 1
    names.add(name.lower())
    return name
