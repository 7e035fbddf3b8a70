"""The workbook, read by the standard library as any reader of the format would."""

import io
from xml.etree import ElementTree
from zipfile import ZipFile

from eventpound.results.tables import workbook

MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
SHEETS = {
    "Piers [a/b]": [("pier", "force (kN)"), ("A & <B>", 12.345678901234567), ("C", float("nan"))],
    "piers  a b ": [("a" * 40,), ("\x07bell",)],
}


def read(data: bytes) -> dict[str, list[list[str | float | None]]]:
    with ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        trees = {n: ElementTree.fromstring(archive.read(n)) for n in archive.namelist()}
    texts = [each.findtext(f"{MAIN}t") for each in trees["xl/sharedStrings.xml"]]
    names = [sheet.get("name") for sheet in trees["xl/workbook.xml"].iter(f"{MAIN}sheet")]
    found = {}
    for number, name in enumerate(names, 1):
        rows: list[list[str | float | None]] = []
        for row in trees[f"xl/worksheets/sheet{number}.xml"].iter(f"{MAIN}row"):
            cells = {str(cell.get("r")).rstrip("0123456789"): cell for cell in row}
            values = {at: float(cell.findtext(f"{MAIN}v") or "nan") for at, cell in cells.items()}
            rows.append(
                [texts[int(v)] if cells[at].get("t") == "s" else v for at, v in values.items()]
            )
        found[str(name)] = rows
    return found


def test_numbers_and_texts_come_back():
    data = workbook(SHEETS)
    first, second = read(data).items()
    assert first == ("Piers  a b", [["pier", "force (kN)"], ["A & <B>", 12.34567890123457], ["C"]])
    # Names that are told apart by capitals or blanks only are one in a workbook.
    assert second == ("piers  a b 2", [["a" * 40], ["_x0007_bell"]])
    assert workbook(SHEETS) == data
