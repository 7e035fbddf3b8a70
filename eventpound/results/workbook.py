"""Tables as a workbook that spreadsheets open: Office Open XML (ECMA-376), a sheet a table.

It is a few XML files in a ZIP archive, so that it takes no library. The same tables make the same
bytes.
"""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from xml.sax.saxutils import escape, quoteattr
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

Row = Sequence[str | float]
_LONGEST_NAME = 31
_FORBIDDEN = re.compile(r"[\[\]:*?/\\']")
_UNPRINTABLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f]")
_WIDEST, _LETTER = 60.0, 1.1
"""Of a column, and of a letter of it, in letters."""
_HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_TYPE = "application/vnd.openxmlformats-officedocument.spreadsheetml."
_PLAIN = 'numFmtId="0" fillId="0" borderId="0"'
_FONT = '<sz val="10"/><name val="Calibri"/>'
_STYLES = (
    f'<styleSheet xmlns="{_MAIN}"><fonts count="2"><font>{_FONT}</font>'
    f'<font><b/>{_FONT}</font></fonts><fills count="2"><fill><patternFill patternType="none"/>'
    '</fill><fill><patternFill patternType="gray125"/></fill></fills><borders count="1"><border>'
    "<left/><right/><top/><bottom/><diagonal/></border></borders>"
    f'<cellStyleXfs count="1"><xf {_PLAIN} fontId="0"/></cellStyleXfs><cellXfs count="2">'
    f'<xf {_PLAIN} fontId="0" xfId="0"/><xf {_PLAIN} fontId="1" xfId="0" applyFont="1" '
    'applyAlignment="1"><alignment wrapText="1"/></xf></cellXfs><cellStyles count="1">'
    '<cellStyle name="Normal" xfId="0" builtinId="0"/></cellStyles></styleSheet>'
)


def workbook(sheets: Mapping[str, Sequence[Row]]) -> bytes:
    """A workbook, XLSX.

    Parameters
    ----------
    sheets : mapping of str to sequence of rows
        Cells by the names of the sheets, the first row of each its headings; NaN is empty.
    """
    names = _sheet_names(list(sheets))
    numbers = range(1, len(names) + 1)
    listed = "".join(
        f'<sheet name={quoteattr(name)} sheetId="{i}" r:id="r{i}"/>'
        for i, name in zip(numbers, names, strict=True)
    )
    styles = len(names) + 1
    links = "".join(_link(i, "worksheet", f"worksheets/sheet{i}.xml") for i in numbers)
    kinds = "".join(_kind(f"/xl/worksheets/sheet{i}.xml", "worksheet") for i in numbers)
    plain = '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.'
    kinds += _kind("/xl/workbook.xml", "sheet.main") + _kind("/xl/styles.xml", "styles")
    types = f'<Types xmlns="{_PACKAGE}/content-types">{plain}relationships+xml"/>{kinds}</Types>'
    files = {
        "[Content_Types].xml": types,
        "_rels/.rels": _links(_link(1, "officeDocument", "xl/workbook.xml")),
        "xl/workbook.xml": f'<workbook xmlns="{_MAIN}" xmlns:r="{_OFFICE}">'
        f"<sheets>{listed}</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": _links(links + _link(styles, "styles", "styles.xml")),
        "xl/styles.xml": _STYLES,
    }
    files |= {
        f"xl/worksheets/sheet{i}.xml": _sheet(rows)
        for i, rows in zip(numbers, sheets.values(), strict=True)
    }
    made = io.BytesIO()
    with ZipFile(made, "w", ZIP_DEFLATED) as archive:
        for name, text in files.items():
            # Without a date of its own an entry has the first that there is.
            archive.writestr(ZipInfo(name), _HEAD + text, ZIP_DEFLATED)
    return made.getvalue()


def _link(i: int, kind: str, target: str) -> str:
    return f'<Relationship Id="r{i}" Type="{_OFFICE}/{kind}" Target="{target}"/>'


def _links(inner: str) -> str:
    return f'<Relationships xmlns="{_PACKAGE}/relationships">{inner}</Relationships>'


def _kind(part: str, kind: str) -> str:
    return f'<Override PartName="{part}" ContentType="{_TYPE}{kind}+xml"/>'


def _sheet_names(wanted: Sequence[str]) -> list[str]:
    """Names that a workbook may have, each once."""
    found: list[str] = []
    for name in wanted:
        short = (_FORBIDDEN.sub(" ", name).strip() or "table")[:_LONGEST_NAME]
        number = 2
        while short.lower() in map(str.lower, found):
            tail = f" {number}"
            short, number = short[: _LONGEST_NAME - len(tail)] + tail, number + 1
        found.append(short)
    return found


def _sheet(rows: Sequence[Row]) -> str:
    """A sheet: its headings bold, and in sight however far one scrolls."""
    widths = [
        min(max(len(str(cell)) for cell in column[1:] or column) * _LETTER + 4.0, _WIDEST)
        for column in zip(*(map(_shown, row) for row in rows), strict=True)
    ]
    columns = "".join(
        f'<col min="{i}" max="{i}" width="{wide:.1f}" customWidth="1"/>'
        for i, wide in enumerate(widths, 1)
    )
    lines = "".join(
        f"<row>{''.join(_cell(cell, int(i == 0)) for cell in row)}</row>"
        for i, row in enumerate(rows)
    )
    return (
        f'<worksheet xmlns="{_MAIN}"><sheetViews><sheetView workbookViewId="0">'
        '<pane ySplit="1" topLeftCell="A2" activePane="bottomLeft" state="frozen"/>'
        f"</sheetView></sheetViews><cols>{columns}</cols><sheetData>{lines}</sheetData></worksheet>"
    )


def _shown(cell: str | float) -> str:
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)


def _cell(cell: str | float, style: int) -> str:
    if isinstance(cell, str):
        text = escape(_UNPRINTABLE.sub(" ", cell))
        return f'<c t="inlineStr" s="{style}"><is><t xml:space="preserve">{text}</t></is></c>'
    return f'<c s="{style}"/>' if cell != cell else f'<c s="{style}"><v>{float(cell)!r}</v></c>'
