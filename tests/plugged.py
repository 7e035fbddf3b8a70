"""Distributions made up in a folder, so that their entry points are found as if installed."""

from pathlib import Path

import pytest


def plug_in(
    monkeypatch: pytest.MonkeyPatch,
    folder: Path,
    sources: dict[str, str],
    entries: dict[str, str],
    name: str = "made-up",
    group: str = "eventpound.solvers",
) -> None:
    """Put modules and the metadata of a distribution on the path for the time of a test."""
    metadata = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    lines = "".join(f"{key} = {value}\n" for key, value in entries.items())
    (metadata / "entry_points.txt").write_text(f"[{group}]\n{lines}")
    for file, text in sources.items():
        (folder / file).write_text(text)
    monkeypatch.syspath_prepend(folder)
