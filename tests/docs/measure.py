"""Tables of docs/measured, written by the commands that measure.

    python -m tests.docs.measure              # the blocks of all pages, with their commands
    python -m tests.docs.measure steppers     # measure those of one page again
    python -m tests.docs.measure steppers 2   # its second block only

A block of a page is

    <!-- measured by: python -m tests.benchmarks.orders -->
    Measured 2026-11-22 on x86_64, 2 cores.

    | a table | ...
    <!-- end of measured -->

and holds the tables that the command prints, with the day and the class of the machine.
"""

from __future__ import annotations

import os
import platform
import re
import shlex
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "docs" / "measured"
BLOCK = re.compile(
    r"(<!-- measured by: python -m (?P<command>.*?) -->\n).*?(<!-- end of measured -->)", re.DOTALL
)


def tables_of(output: str) -> str:
    """The tables in what a command printed, a blank line between them."""
    return "\n\n".join(block.rstrip() for block in re.findall(r"(?:^\|.*\n?)+", output, re.M))


def machine() -> str:
    """Class of this machine."""
    return f"{platform.machine()}, {os.cpu_count()} cores"


def measured(output: str) -> str:
    """What stands in a block."""
    day = datetime.now(UTC).date().isoformat()
    return f"Measured {day} on {machine()}.\n\n{tables_of(output)}\n"


def measure(page: Path, which: int | None = None) -> None:
    """Run the commands of a page's blocks, or of one of them (from 1), and put in their tables."""
    text = page.read_text(encoding="utf-8")
    for number, block in enumerate(list(BLOCK.finditer(text)), start=1):
        if which not in (None, number):
            continue
        words = [sys.executable, "-m", *shlex.split(block["command"])]
        done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
        inside = measured(done.stdout)
        text = text.replace(block.group(), f"{block.group(1)}{inside}{block.group(3)}")
        page.write_text(text, encoding="utf-8")


def main(arguments: list[str]) -> None:
    """Measure, or list what could be."""
    if arguments:
        name, *which = arguments
        measure(PAGES / f"{name}.md", int(which[0]) if which else None)
        return
    for page in sorted(PAGES.glob("*.md")):
        for number, block in enumerate(BLOCK.finditer(page.read_text(encoding="utf-8")), start=1):
            print(f"{page.stem} {number}: python -m {block['command']}")


if __name__ == "__main__":
    main(sys.argv[1:])
