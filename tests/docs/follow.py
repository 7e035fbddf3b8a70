"""Tutorials followed to the letter: files written, commands run, numbers and pictures compared.

    python -m tests.docs.follow              # all of docs/tutorials, in new folders, with times
    python -m tests.docs.follow --pictures   # and keep the pictures that they show

A tutorial says in comments what a reader would do:

    <!-- file: PATH -->                 the next block is the content of a file
    <!-- added to: PATH -->             the next block comes at its end
    <!-- case from: PAGE -->            files of another tutorial are there already
    <!-- picture: PATH as NAME -->      what the picture below was
    <!-- value: FILE | KEY | TEXT -->   a number of a JSON file that the page states as TEXT

Blocks of `sh` are run by a shell, in order.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.models import ROOT

TUTORIALS = ROOT / "docs" / "tutorials"
_STEP = re.compile(
    r"<!-- (?P<how>file|added to): (?P<file>\S+) -->\n```\w+\n(?P<text>.*?)```"
    r"|<!-- (?P<word>case from|picture|value): (?P<what>.*?) -->"
    r"|^```sh\n(?P<commands>.*?)```",
    re.DOTALL | re.MULTILINE,
)
_UNITS = {"cm": 100.0, "MN": 1e-6, "kN s": 1e-3, "%": 100.0}
"""Factors from SI to units that pages use."""


def follow(name: str, folder: Path, *, keep_pictures: bool = False) -> list[str]:
    """Do what a tutorial says; what turned out otherwise than it says.

    Parameters
    ----------
    name : str
        Of the page, without ``.md``.
    folder : Path
        Where its files go.
    keep_pictures : bool
        Whether the pictures of the page are replaced.
    """
    page = (TUTORIALS / f"{name}.md").read_text(encoding="utf-8")
    shown = re.sub(r"<!--.*?-->", "", page, flags=re.DOTALL)
    wrong: list[str] = []
    for step in _STEP.finditer(page):
        word, what = step["word"], step["what"]
        if step["commands"]:
            wrong += _run(step["commands"], folder)
        elif step["file"]:
            _write(folder / step["file"], step["text"], "w" if step["how"] == "file" else "a")
        elif word == "case from":
            other = (TUTORIALS / what).read_text(encoding="utf-8")
            for file in _STEP.finditer(other):
                if file["how"] == "file":
                    _write(folder / file["file"], file["text"], "w")
        elif word == "picture":
            source, _, kept = what.partition(" as ")
            if f"({kept})" not in shown or not (folder / source).exists():
                wrong.append(f"no picture {source}, or the page does not show it")
            elif keep_pictures:
                _keep(folder / source, TUTORIALS / kept)
        else:
            wrong += _compare(folder, *(part.strip() for part in what.split("|")), shown)
    return wrong


def _write(path: Path, text: str, mode: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open(mode, encoding="utf-8") as file:
        file.write(text)


def _run(commands: str, folder: Path) -> list[str]:
    """Run lines in a shell whose `python` is this one; those that failed."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(
        ["bash", "-euc", commands],
        cwd=folder,
        env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    return [f"{commands.strip()}: {done.stderr[-300:]}"] if done.returncode else []


def _keep(source: Path, target: Path) -> None:
    """Keep a picture as small as those of the gallery."""
    sys.path.insert(0, str(ROOT / "docs"))
    from pictures import shrink

    shrink([source], target)


def _compare(folder: Path, file: str, keys: str, text: str, shown: str) -> list[str]:
    """Whether a number, or a sum of several, rounds to what the page states."""
    found = 0.0
    for key in keys.split(" + "):
        value = json.loads((folder / file).read_text(encoding="utf-8"))
        while key:
            # A corner has a dot in its name.
            name = max((n for n in value if f"{key}.".startswith(f"{n}.")), key=len)
            value, key = value[name], key[len(name) + 1 :]
        found += value
    number, _, unit = text.partition(" ")
    decimals = len(number.partition(".")[2])
    printed = f"{abs(found) * _UNITS.get(unit, 1.0):.{decimals}f}"
    if printed != number:
        return [f"{keys} = {found}, printed as {printed}; the page says {text}"]
    stated = re.sub(r"\s+", " ", shown)
    return [] if text in stated or printed == "0" else [f"the page does not say '{text}'"]


def main(keep_pictures: bool) -> int:
    """Follow all tutorials; how many went wrong."""
    failed = 0
    for page in sorted(TUTORIALS.glob("*.md")):
        with tempfile.TemporaryDirectory() as folder:
            started = time.monotonic()
            wrong = follow(page.stem, Path(folder), keep_pictures=keep_pictures)
        seconds = time.monotonic() - started
        print(f"{page.stem:12} {seconds:6.1f} s  {'; '.join(wrong) or 'as it says'}", flush=True)
        failed += bool(wrong)
    return failed


if __name__ == "__main__":
    raise SystemExit(main("--pictures" in sys.argv))
