"""Pictures of the gallery: `python docs/pictures.py [CASE ...]` runs cases and keeps one each.

Of a case of one run the sketch of its model is kept, too; `--models` draws these alone.

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
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from eventpound.case.loading import load_case
from eventpound.cli import main
from eventpound.report.model_figure import model_figure

ROOT = Path(__file__).parents[1]
GALLERY = ROOT / "docs" / "gallery"
MADE = GALLERY / "made.csv"
WIDTH, COLOURS = 900, 256
"""Pixels, and shades: enough for a figure of lines, at a quarter of the size."""
MODEL, MODEL_DPI = (5.6, 3.6), 150
"""Inches that a sketch has at most, so that its names are read in half a page."""
FIRST = ("plan.png", "displacements.png", "study.png")
"""The picture that says most, where there are several."""
AS_PRINTED = {
    "figure-04": ("figure-04-0.2.png",),
    "figure-05": ("figure-05-model.png", "figure-05-0.2.png"),
}
"""Those that the paper prints, from top to bottom, where a case draws more."""


def hash_of(name: str) -> str:
    """Hash of the case file of a case."""
    return hashlib.sha256((ROOT / "cases" / name / "case.toml").read_bytes()).hexdigest()[:16]


def case_names() -> list[str]:
    """All cases, in order."""
    return sorted(file.parent.name for file in (ROOT / "cases").glob("*/case.toml"))


def is_one_run(name: str) -> bool:
    """Whether a case is one structure under one motion, of which a sketch says most."""
    case = tomllib.loads((ROOT / "cases" / name / "case.toml").read_text(encoding="utf-8"))
    return not {"study", "figure"} & case.keys() and "suite" not in case["excitation"]


def made() -> dict[str, str]:
    """Hash of the case file that each picture was made from, by case."""
    if not MADE.exists():
        return {}
    with MADE.open(newline="", encoding="utf-8") as file:
        return {row["case"]: row["sha256"] for row in csv.DictReader(file)}


def shrink(sources: Sequence[Path], target: Path) -> None:
    """Pictures, one below the other, at the size and in the shades of those kept here."""
    images = [_as_wide(source, WIDTH // 2) for source in sources[:-1]]
    images.append(_as_wide(sources[-1], WIDTH))
    joined = Image.new("RGB", (WIDTH, sum(image.height for image in images)), "white")
    top = 0
    for image in images:
        joined.paste(image, ((WIDTH - image.width) // 2, top))
        top += image.height
    # Thin lines keep their hue by the largest coverage, wide tints theirs by means.
    palette = joined.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=3)
    palette.save(target, optimize=True)


def _as_wide(source: Path, width: int) -> Image.Image:
    with Image.open(source) as image:
        size = width, round(image.height * width / image.width)
        return image.convert("RGB").resize(size, Image.Resampling.LANCZOS)


def chosen(name: str, pictures: Sequence[Path]) -> list[Path]:
    """Which of the pictures that a case draws are kept."""
    if name in AS_PRINTED:
        by_name = {picture.name: picture for picture in pictures}
        return [by_name[printed] for printed in AS_PRINTED[name]]
    first = (p for word in FIRST for p in pictures if p.name == word)
    return [next(first, pictures[0])]


def make(name: str) -> None:
    """Run a case and keep its picture."""
    case = ROOT / "cases" / name
    command = "study" if "study" in tomllib.loads((case / "case.toml").read_text()) else "run"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "results"
        code = main([command, str(case), "--out", str(out)])
        if code:
            raise SystemExit(f"{name}: exit code {code}")
        shrink(chosen(name, sorted(out.rglob("*.png"))), GALLERY / f"{name}.png")


def draw_model(name: str) -> None:
    """Keep the sketch of a case of one run."""
    with tempfile.TemporaryDirectory() as folder:
        sketch = Path(folder) / "model.png"
        figure = model_figure(load_case(ROOT / "cases" / name).scene, within=MODEL)
        figure.savefig(sketch, dpi=MODEL_DPI)
        shrink([sketch], GALLERY / f"{name}-model.png")


def run(names: list[str], models: bool = False) -> None:
    """Make the pictures of these cases, or of all, and say of which files they are."""
    hashes = made()
    names = names or case_names()
    for name in filter(is_one_run, names):
        draw_model(name)
    for name in [] if models else names:
        make(name)
        hashes[name] = hash_of(name)
    with MADE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", "sha256"])
        writer.writerows((name, hashes[name]) for name in case_names() if name in hashes)


if __name__ == "__main__":
    run([word for word in sys.argv[1:] if word != "--models"], "--models" in sys.argv)
