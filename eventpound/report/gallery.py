"""An index page of the figures of several cases."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

_GREEK = {"delta": "δ", "epsilon": "ε", "omega": "ω"}
_PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }}
img {{ max-width: 100%; }}
code {{ font-size: 0.9em; }}
blockquote {{ border-left: 3px solid #0072b2; margin-left: 0; padding-left: 1em; }}
</style>
<h1>{title}</h1>
<ul>
{contents}</ul>
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
    title: str, entries: Sequence[Entry], left_out: Mapping[str, str] | None = None
) -> bytes:
    """Page of all figures, HTML: contents, then each with its claim, command and data.

    Parameters
    ----------
    title : str
        Of the page.
    entries : sequence of Entry
        In the order of the page.
    left_out : mapping of str to str, optional
        Names of cases that are not on it, with the reason.
    """
    contents = "".join(
        f'<li><a href="#{escape(entry.name)}">{escape(entry.title)}</a></li>\n' for entry in entries
    )
    text = "".join(part for entry in entries for part in _entry(entry))
    if left_out:
        lines = [f"<li>{escape(name)}: {escape(why)}</li>\n" for name, why in left_out.items()]
        text = f"<p>Left out:</p>\n<ul>\n{''.join(lines)}</ul>\n{text}"
    return _PAGE.format(title=escape(title), contents=contents, entries=text).encode()


def _symbols(text: str) -> str:
    """HTML of a text, in which Pi_delta is a symbol, as pictures have it."""

    def symbol(found: re.Match[str]) -> str:
        words = [_GREEK.get(word, word) for word in found[1].split("_")]
        return f"Π<sub>{escape(' '.join(words))}</sub>"

    return re.sub(r"\bPi_(\w+)", symbol, escape(text)).replace("Pi-term", "Π-term")


def _entry(entry: Entry) -> Iterator[str]:
    yield f'<h2 id="{escape(entry.name)}">{escape(entry.title)}</h2>\n'
    yield from (f"<blockquote>{_symbols(claim)}</blockquote>\n" for claim in entry.claims)
    yield f"<p>{_symbols(entry.about)}</p>\n"
    command = f"eventpound {entry.command} cases/{entry.name}"
    data = [path.as_posix() for path in entry.files if path.suffix != ".png"]
    links = "".join(f', <a href="{escape(path)}">{escape(Path(path).name)}</a>' for path in data)
    runs = "run" if entry.runs == 1 else "runs"
    yield f"<p><code>{escape(command)}</code>, {entry.runs} {runs}{links}</p>\n"
    for path in entry.files:
        if path.suffix == ".png":
            source = escape(path.as_posix())
            yield f'<p><a href="{source}"><img src="{source}" alt="{source}"></a></p>\n'
