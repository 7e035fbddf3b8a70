"""One page generator: a page is a title and sections, and a section is a list of parts.

Parts are figures, tables, lists, texts, what was understood of a case, and what was run. The
appendix of a report, the pages of a comparison and of a gallery are these parts in another order.
Pictures are SVG within the page (a click makes one larger), nothing is loaded from elsewhere
and no script runs, so that a page can be kept and sent as it is; the pictures of a gallery are
the files beside it.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from eventpound.case.case import Case
from eventpound.report.model_figure import model_figure
from eventpound.report.style import svg
from eventpound.results.input_tables import input_lines, input_tables
from eventpound.results.inputs import inputs_of
from eventpound.results.tables import Cells

PAGE = "report.html"
"""Name of the file."""
Part = str
"""HTML."""
_DOCUMENT = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
{css}</style>
</head>
<body>
{body}</body>
</html>
"""


Section = tuple[str, Iterable[Part]] | tuple[str, Iterable[Part], str]
"""Its name, its parts, and perhaps what links call it."""


def page(title: str, sections: Iterable[Section], before: Iterable[Part] = ()) -> bytes:
    """A page with links to its sections, of which empty ones are left out.

    Parameters
    ----------
    title : str
        Of the page.
    sections : iterable of Section
        In the order of the page.
    before : iterable of str
        Parts above the first section.

    Returns
    -------
    bytes
        HTML, UTF-8.
    """
    return document(title, ["page.css"], [chapter(title, sections, before)])


def chapter(title: str, sections: Iterable[Section], before: Iterable[Part] = ()) -> Part:
    """A heading with links to its sections, of which empty ones are left out, then these."""
    links, body = [], []
    for name, parts, *anchors in sections:
        if content := "".join(parts):
            anchor = escape(anchors[0] if anchors else name.lower().replace(" ", "-"))
            links.append(f'<a href="#{anchor}">{escape(name)}</a>')
            body.append(f'<h2 id="{anchor}">{escape(name)}</h2>\n{content}')
    head = f"<h1>{escape(title)}</h1>\n<nav>{''.join(links)}</nav>\n"
    return "".join([head, *before, *body])


def document(title: str, styles: Iterable[str], body: Iterable[Part]) -> bytes:
    """A file of HTML, UTF-8, with style sheets of this package in it."""
    css = "".join((files("eventpound.report") / s).read_text(encoding="utf-8") for s in styles)
    return _DOCUMENT.format(title=escape(title), css=css, body="".join(body)).encode()


def model_of(case: Case) -> Iterator[Part]:
    """The scene as a picture, and everything that was understood of it."""
    yield figure_of(
        model_figure(case.scene), "The scene; nothing is to scale but given heights of storeys."
    )
    inputs = inputs_of(case)
    yield from map(table_of, input_tables(inputs))
    yield list_of(dict(input_lines(inputs)))


def origin_of(manifest: Mapping[str, Any]) -> Part:
    """What was run, by what, and the hashes that say so, as far as a manifest has them."""
    named = {"case": "case_sha256", "study": "study_sha256"}
    lines = {word: manifest.get(key) for word, key in named.items()}
    # What a run took stands in its summary, which differs from run to run.
    tables = {name: value for name, value in manifest["files"].items() if name.endswith(".csv")}
    lines |= {**manifest["versions"], **tables}
    record = manifest.get("record") or {}
    lines |= {key: record.get(key) for key in ("file", "file_sha256")}
    lines["machine"] = ", ".join(map(str, manifest.get("machine", {}).values()))
    return list_of({key: str(value) for key, value in lines.items() if value})


def figure_of(figure: Figure, caption: str) -> Part:
    """A picture that a click makes larger."""
    return _captioned(f'<label><input type="checkbox">{svg(figure)}</label>', caption)


def picture_of(file: Path, caption: str) -> Part:
    """A PNG file as it is."""
    data = base64.b64encode(file.read_bytes()).decode()
    return _captioned(f'<img alt="" src="data:image/png;base64,{data}">', caption)


def _captioned(inner: str, caption: str) -> Part:
    return f"<figure>{inner}<figcaption>{escape(caption)}</figcaption></figure>\n"


def text_part(*texts: str) -> Part:
    """Paragraphs."""
    return "".join(f"<p>{escape(text)}</p>\n" for text in texts)


def table_of(table: Cells) -> Part:
    """A table, with words to the left and numbers to the right."""
    kinds = [' class="word"' if word else "" for word in table.words]

    def line(tag: str, cells: tuple[str, ...]) -> str:
        inner = "".join(
            f"<{tag}{kind}>{escape(text)}</{tag}>" for text, kind in zip(cells, kinds, strict=True)
        )
        return f"<tr>{inner}</tr>"

    rows = "\n".join([line("th", table.headings), *(line("td", row) for row in table.rows)])
    more = text_part(f"and {table.more} more") if table.more else ""
    return f'<div class="wide"><table>\n{rows}\n</table></div>\n{more}'


def folded(name: str, part: Part, *, opened: bool = False) -> Part:
    """A part below its name, which a click shows or hides."""
    start = "<details open>" if opened else "<details>"
    return f"{start}<summary>{escape(name)}</summary>\n{part}</details>\n"


def list_of(lines: Mapping[str, str]) -> Part:
    """Words, each with what it stands for."""
    inner = "".join(
        f"<dt>{escape(word)}</dt><dd>{escape(text)}</dd>\n" for word, text in lines.items()
    )
    return f"<dl>\n{inner}</dl>\n"
