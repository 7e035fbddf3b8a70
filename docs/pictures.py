"""Pictures of the gallery: `python docs/pictures.py [CASE ...]` runs cases and keeps one each.

They are kept in docs/gallery with `made.csv`, which says of which case file each picture is
(its hash): tests/docs/test_site.py tells those that are out of date. All cases take two minutes
once kernels are compiled.
"""

from __future__ import annotations

import csv
import hashlib
import sys
import tempfile
import tomllib
from pathlib import Path

from PIL import Image

from eventpound.cli import main

ROOT = Path(__file__).parents[1]
GALLERY = ROOT / "docs" / "gallery"
MADE = GALLERY / "made.csv"
WIDTH, COLOURS = 900, 128
"""Pixels, and shades: enough for a figure of lines, at a quarter of the size."""
FIRST = ("displacements.png", "study.png")
"""The picture that says most, where there are several."""


def hash_of(name: str) -> str:
    """Hash of the case file of a case."""
    return hashlib.sha256((ROOT / "cases" / name / "case.toml").read_bytes()).hexdigest()[:16]


def case_names() -> list[str]:
    """All cases, in order."""
    return sorted(file.parent.name for file in (ROOT / "cases").glob("*/case.toml"))


def made() -> dict[str, str]:
    """Hash of the case file that each picture was made from, by case."""
    if not MADE.exists():
        return {}
    with MADE.open(newline="", encoding="utf-8") as file:
        return {row["case"]: row["sha256"] for row in csv.DictReader(file)}


def shrink(source: Path, target: Path) -> None:
    """A picture at the size and in the shades of those kept here."""
    with Image.open(source) as image:
        height = round(image.height * WIDTH / image.width)
        small = image.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
        palette = small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE)  # thin lines keep their hue
        palette.save(target, optimize=True)


def make(name: str) -> None:
    """Run a case and keep its picture."""
    case = ROOT / "cases" / name
    command = "study" if "study" in tomllib.loads((case / "case.toml").read_text()) else "run"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "results"
        code = main([command, str(case), "--out", str(out)])
        if code:
            raise SystemExit(f"{name}: exit code {code}")
        pictures = sorted(out.rglob("*.png"))
        chosen = next((p for first in FIRST for p in pictures if p.name == first), pictures[0])
        shrink(chosen, GALLERY / f"{name}.png")


def run(names: list[str]) -> None:
    """Make the pictures of these cases, or of all, and say of which files they are."""
    hashes = made()
    for name in names or case_names():
        make(name)
        hashes[name] = hash_of(name)
    with MADE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", "sha256"])
        writer.writerows((name, hashes[name]) for name in case_names() if name in hashes)


if __name__ == "__main__":
    run(sys.argv[1:])
