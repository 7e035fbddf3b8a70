"""An index page of the figures of several cases, and what a gallery says of one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from eventpound.report.html import Part, page

_GREEK = {"delta": "δ", "epsilon": "ε", "omega": "ω"}


@dataclass(frozen=True)
class GalleryEntry:
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
    files : sequence of Path
        Its pictures and data, relative to the page.
    claims : sequence of str
        What its figures are held against.
    """

    name: str
    command: str
    title: str
    about: str
    runs: int
    files: Sequence[Path]
    claims: Sequence[str] = ()


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


def index_page(
    title: str, entries: Sequence[GalleryEntry], left_out: Mapping[str, str] | None = None
) -> bytes:
    """Page of all figures, HTML: contents, then each with its claim, command and data.

    Parameters
    ----------
    title : str
        Of the page.
    entries : sequence of GalleryEntry
        In the order of the page.
    left_out : mapping of str to str, optional
        Names of cases that are not on it, with the reason.
    """
    sections = [(entry.title, _parts(entry), entry.name) for entry in entries]
    return page(title, sections, _left_out(left_out or {}))


def links_page(
    title: str, titles: Mapping[str, str], file: str, left_out: Mapping[str, object]
) -> bytes:
    """Page of links to a file in the folder of each case, HTML.

    Parameters
    ----------
    title : str
        Of the page.
    titles : mapping of str to str
        What the cases are called, by their folders.
    file : str
        In each of them.
    left_out : mapping
        Names of cases that are not on it, with the reason.
    """
    links = (
        f'<li><a href="{escape(name)}/{file}">{escape(name)}</a>: {escape(text)}</li>\n'
        for name, text in titles.items()
    )
    return page(title, [], [f"<ul>\n{''.join(links)}</ul>\n", *_left_out(left_out)])


def _left_out(why: Mapping[str, object]) -> list[Part]:
    """A list of what was left out, with the reasons."""
    lines = [f"<li>{escape(name)}: {escape(str(text))}</li>\n" for name, text in why.items()]
    return [f"<p>Left out:</p>\n<ul>\n{''.join(lines)}</ul>\n"] if lines else []


def _symbols(text: str) -> str:
    """HTML of a text, in which Pi_delta is a symbol, as pictures have it."""

    def symbol(found: re.Match[str]) -> str:
        words = [_GREEK.get(word, word) for word in found[1].split("_")]
        return f"Π<sub>{escape(' '.join(words))}</sub>"

    return re.sub(r"\bPi_(\w+)", symbol, escape(text)).replace("Pi-term", "Π-term")


def _parts(entry: GalleryEntry) -> Iterator[Part]:
    yield from (f"<blockquote>{_symbols(claim)}</blockquote>\n" for claim in entry.claims)
    yield f"<p>{_symbols(entry.about)}</p>\n"
    sources = {path: escape(path.as_posix()) for path in entry.files}
    pictures = [path for path in entry.files if path.suffix == ".png"]
    links = "".join(
        f', <a href="{sources[path]}">{escape(path.name)}</a>'
        for path in entry.files
        if path not in pictures
    )
    runs = "run" if entry.runs == 1 else "runs"
    command = escape(f"eventpound {entry.command} cases/{entry.name}")
    yield f"<p><code>{command}</code>, {entry.runs} {runs}{links}</p>\n"
    for source in map(sources.get, pictures):
        yield f'<p><a href="{source}"><img src="{source}" alt="{source}"></a></p>\n'
