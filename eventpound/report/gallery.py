"""An index page of the figures of several cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

_PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }}
img {{ max-width: 100%; }}
code {{ font-size: 0.9em; }}
</style>
<h1>{title}</h1>
{entries}</html>
"""


@dataclass(frozen=True)
class Entry:
    """What the page says of one case.

    Parameters
    ----------
    name : str
        Of its case.
    command : str
        That makes it, ``study`` or ``run``.
    title : str
        One line.
    about : str
        What it shows, and what is from where.
    runs : int
        How many it has.
    pictures : sequence of Path
        Relative to the page.
    """

    name: str
    command: str
    title: str
    about: str
    runs: int
    pictures: Sequence[Path]


def about_case(directory: Path) -> str:
    """The comment that a case begins with, as one paragraph.

    Parameters
    ----------
    directory : Path
        Of the case.
    """
    lines = []
    for line in (directory / "case.toml").read_text(encoding="utf-8-sig").splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.removeprefix("#").strip())
    return " ".join(lines)


def index_page(title: str, entries: Sequence[Entry]) -> bytes:
    """Page of all figures, HTML.

    Parameters
    ----------
    title : str
        Of the page.
    entries : sequence of Entry
        In the order of the page.
    """
    parts = []
    for entry in entries:
        parts.append(f'<h2 id="{escape(entry.name)}">{escape(entry.title)}</h2>\n')
        parts.append(f"<p>{escape(entry.about)}</p>\n")
        command = f"eventpound {entry.command} cases/{entry.name}"
        parts.append(f"<p><code>{escape(command)}</code>, {entry.runs} runs</p>\n")
        for picture in entry.pictures:
            source = escape(picture.as_posix())
            parts.append(f'<p><a href="{source}"><img src="{source}" alt="{source}"></a></p>\n')
    return _PAGE.format(title=escape(title), entries="".join(parts)).encode()
