"""Tables of the pages, written by the commands that measure.

    python -m tests.docs.measure                           # all blocks, with their commands
    python -m tests.docs.measure measured/steppers         # measure those of one page again
    python -m tests.docs.measure measured/steppers 2       # its second block only
    python -m tests.docs.measure measured/steppers 2 FILE  # from what its command printed earlier

A block of a page is

    <!-- measured by: python -m tests.benchmarks.orders -->
    Measured 2026-11-22 on x86_64, 2 cores.

    | a table | ...
    <!-- end of measured 1f0e9ad2c4b7 -->

and holds the tables that the command prints, with the day and the class of the machine. With
`; table 2` after the command it holds the second of them only. The mark at its end is a
checksum of the block, so that a test sees what was written by hand. FILE is what the command
printed on an earlier day, the day of the file, on a machine of this class.
"""

import hashlib
import os
import platform
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from tests.models import ROOT

DOCS = ROOT / "docs"
README = ROOT / "README.md"
PAGES = sorted([README, *DOCS.glob("*.md"), *DOCS.glob("measured/*.md")])
BLOCK = re.compile(
    r"<!-- measured by: python -m (?P<command>.*?)(?:; table (?P<table>\d+))? -->\n"
    r"(?P<inside>.*?)<!-- end of measured(?P<seal>.*?) -->",
    re.DOTALL,
)
TABLE = re.compile(r"(?:^\|.*\n?)+", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A block of a page.

    Parameters
    ----------
    text : str
        All of it, marks included.
    command : str
        Module and arguments.
    table : int
        Which of the tables that the command prints, from 1; 0: all.
    inside : str
        What stands between the marks.
    seal : str
        What its last mark says.
    """

    text: str
    command: str
    table: int
    inside: str
    seal: str

    @property
    def is_written(self) -> bool:
        """Whether it is as `measure` left it."""
        return self.seal == _seal(self.command, self.inside)

    def with_output(self, printed: str, day: str) -> str:
        """The block with the tables of what its command printed on a day."""
        tables = [found.rstrip() for found in TABLE.findall(printed)]
        if len(tables) < max(self.table, 1):
            raise SystemExit(f"python -m {self.command}: {len(tables)} tables printed")
        if self.table:
            tables = [tables[self.table - 1]]
        inside = f"Measured {day} on {machine()}.\n\n" + "\n\n".join(tables) + "\n"
        which = f"; table {self.table}" if self.table else ""
        return (
            f"<!-- measured by: python -m {self.command}{which} -->\n{inside}"
            f"<!-- end of measured {_seal(self.command, inside)} -->"
        )


def _seal(command: str, inside: str) -> str:
    return hashlib.sha256(f"{command}\n{inside}".encode()).hexdigest()[:12]


def blocks(text: str) -> Iterator[Block]:
    """Those of a page."""
    for found in BLOCK.finditer(text):
        yield Block(
            found.group(),
            found["command"],
            int(found["table"] or 0),
            found["inside"],
            found["seal"].strip(),
        )


def name_of(page: Path) -> str:
    """What a page is called by the command."""
    return page.relative_to(ROOT).with_suffix("").as_posix().removeprefix("docs/")


def machine() -> str:
    """Class of this machine."""
    return f"{platform.machine()}, {os.cpu_count()} cores"


def measure(page: Path, which: int | None = None, earlier: Path | None = None) -> None:
    """Put the tables of their commands into the blocks of a page, or into one of them (from 1)."""
    printed: dict[str, tuple[str, str]] = {}
    for number, block in enumerate(list(blocks(page.read_text(encoding="utf-8"))), start=1):
        if which not in (None, number):
            continue
        if block.command not in printed:
            printed[block.command] = _run(block.command) if earlier is None else _kept(earlier)
        text = page.read_text(encoding="utf-8")
        new = block.with_output(*printed[block.command])
        page.write_text(text.replace(block.text, new), encoding="utf-8")


def _run(command: str) -> tuple[str, str]:
    """What a command prints, and the day."""
    words = [sys.executable, "-m", *shlex.split(command)]
    done = subprocess.run(words, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout, datetime.now(UTC).date().isoformat()


def _kept(file: Path) -> tuple[str, str]:
    """What a command printed into a file, and the day of the file."""
    day = datetime.fromtimestamp(file.stat().st_mtime, UTC).date().isoformat()
    return file.read_text(encoding="utf-8"), day


def main(arguments: list[str]) -> None:
    """Measure, or list what could be."""
    if arguments:
        name, *rest = arguments
        which, file = [*rest, None, None][:2]
        page = README if name == README.stem else DOCS / f"{name}.md"
        measure(page, int(which) if which else None, Path(file) if file else None)
        return
    for page in PAGES:
        for number, block in enumerate(blocks(page.read_text(encoding="utf-8")), start=1):
            table = f", table {block.table}" if block.table else ""
            print(f"{name_of(page)} {number}: python -m {block.command}{table}")


if __name__ == "__main__":
    main(sys.argv[1:])
