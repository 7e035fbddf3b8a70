"""Pages that are whole in themselves: their head, sections, pictures and tables.

Pictures are SVG within the page (a click makes one larger), nothing is loaded from elsewhere and
no script runs, so that a page can be kept and sent as it is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from eventpound.case.case import Case
from eventpound.report.model_figure import model_figure
from eventpound.report.style import svg
from eventpound.results.input_tables import Cells, input_lines, input_tables
from eventpound.results.inputs import inputs_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = "report.html"
"""Name of the file."""
_HEAD = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font: 15px/1.5 sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; }}
h1 {{ font-size: 1.5em; }}
h2 {{ font-size: 1.2em; border-bottom: 1px solid #ccc; margin-top: 2em; }}
table {{ border-collapse: collapse; margin: 0.8em 0; font-size: 0.85em; }}
th, td {{ padding: 0.15em 0.6em; text-align: right; border-bottom: 1px solid #eee; }}
td {{ white-space: nowrap; }}
th {{ border-bottom: 1px solid #888; }}
.word {{ text-align: left; }}
.wide {{ overflow-x: auto; }}
nav a {{ margin-right: 1em; }}
dl {{ display: grid; grid-template-columns: max-content 1fr; column-gap: 1em; }}
dt {{ font-weight: bold; }}
dd {{ margin: 0; overflow-wrap: anywhere; }}
figure {{ margin: 1em 0; overflow: auto; }}
figure input {{ display: none; }}
figure svg {{ max-width: 100%; height: auto; cursor: zoom-in; }}
figure input:checked + svg {{ max-width: none; width: 250%; cursor: zoom-out; }}
figcaption {{ font-size: 0.85em; color: #555; }}
</style>
</head>
<body>
"""


def page(title: str, sections: Sequence[tuple[str, Iterable[str]]]) -> bytes:
    """A page with links to its sections, of which empty ones are left out.

    Parameters
    ----------
    title : str
        Of the page.
    sections : sequence of (str, iterable of str)
        Their names and their HTML.

    Returns
    -------
    bytes
        HTML, UTF-8.
    """
    parts = [_HEAD.format(title=escape(title)), f"<h1>{escape(title)}</h1>\n<nav>"]
    there = [(name, "".join(content)) for name, content in sections]
    there = [(name, content) for name, content in there if content]
    parts += [f'<a href="#{_anchor(name)}">{name}</a>' for name, _ in there]
    parts.append("</nav>\n")
    parts += [f'<h2 id="{_anchor(name)}">{name}</h2>\n{content}' for name, content in there]
    return ("".join(parts) + "</body>\n</html>\n").encode()


def _anchor(name: str) -> str:
    return name.lower().replace(" ", "-")


def model_section(case: Case) -> Iterator[str]:
    """The scene as a picture, and everything that was understood of it."""
    yield figure_of(
        model_figure(case.scene), "The scene; nothing is to scale but given heights of storeys."
    )
    inputs = inputs_of(case)
    for table in input_tables(inputs):
        yield table_of(table)
    yield list_of(dict(input_lines(inputs)))


def origin_section(manifest: Mapping[str, Any]) -> Iterator[str]:
    """What was run, by what, and the hashes that say so."""
    lines = {"started": manifest["started"], "case": manifest["case_sha256"]}
    lines |= {name: version for name, version in manifest["versions"].items() if version}
    lines |= manifest["files"]
    record = manifest.get("record") or {}
    lines |= {key: record[key] for key in ("file", "file_sha256") if key in record}
    lines["machine"] = ", ".join(map(str, manifest["machine"].values()))
    yield list_of({key: str(value) for key, value in lines.items() if value})


def figure_of(figure: Figure, caption: str) -> str:
    """A picture that a click makes larger."""
    return (
        f'<figure><label><input type="checkbox">{svg(figure)}</label>'
        f"<figcaption>{escape(caption)}</figcaption></figure>\n"
    )


def table_of(table: Cells) -> str:
    """A table, with words to the left and numbers to the right."""
    kinds = [' class="word"' if word else "" for word in table.words]

    def line(tag: str, cells: tuple[str, ...]) -> str:
        inner = "".join(
            f"<{tag}{kind}>{escape(text)}</{tag}>" for text, kind in zip(cells, kinds, strict=True)
        )
        return f"<tr>{inner}</tr>"

    rows = "\n".join([line("th", table.headings), *(line("td", row) for row in table.rows)])
    more = f"<p>and {table.more} more</p>\n" if table.more else ""
    return f'<div class="wide"><table>\n{rows}\n</table></div>\n{more}'


def list_of(lines: Mapping[str, str]) -> str:
    """Words, each with what it stands for."""
    inner = "".join(
        f"<dt>{escape(word)}</dt><dd>{escape(text)}</dd>\n" for word, text in lines.items()
    )
    return f"<dl>\n{inner}</dl>\n"


def text_of(value: object) -> str:
    """A cell of a table."""
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
