"""The documentation site: `python -m sphinx -W --keep-going docs build/site`.

Pages are Markdown (MyST). Four parts are written here when the site is built, into
`docs/generated/`: the gallery, a page for each case of `cases/`; the reference of the
commands, which is their own help; the list of quantities; and the notebooks, with the outputs
stored in them.
"""

from __future__ import annotations

import base64
import json
import shutil
import sys
import tomllib
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parent
GENERATED = HERE / "generated"
sys.path.insert(0, str(ROOT))

project = "eventpound"
author = "the authors of eventpound"
copyright = author
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
language = "en"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_design"]
source_suffix = {".md": "markdown"}
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["_build"]
nitpicky = False

html_theme = "furo"
html_title = "eventpound"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_search_scorer = str(HERE / "_static" / "scorer.js")
html_copy_source = False
html_show_sphinx = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_rtype = False


_GROUPS = (
    "Several bodies",
    "The two-segment bridge of the founding paper",
    "One body",
    "Studies and figures of the founding paper",
)
"""Headings of the gallery, in order."""


def _group(name: str, case: dict[str, Any]) -> str:
    """The heading of the gallery that a case stands below."""
    several, bridge, one, studies = _GROUPS
    if "study" in case or "suite" in case["excitation"] or name.startswith("figure"):
        return studies
    if name.startswith("bridge"):
        return bridge
    return one if len(case.get("body", "several")) == 1 else several


def _write_gallery() -> None:
    """A page for each case, and one with all their pictures."""
    from eventpound.report.gallery import about_case

    folder = GENERATED / "cases"
    folder.mkdir()
    cards: dict[str, list[str]] = {}
    for file in sorted((ROOT / "cases").glob("*/case.toml")):
        name, text = file.parent.name, file.read_text(encoding="utf-8")
        case = tomllib.loads(text)
        command = "study" if "study" in case else "run"
        title, picture = case["title"], f"/gallery/{name}.png"
        drawn = f"![what the command draws]({picture})"
        sketch = f"/gallery/{name}-model.png"
        if (HERE / sketch.lstrip("/")).exists():
            # A motion looks like any other in a thumbnail; the structure tells cases apart.
            picture = sketch
            drawn = (
                "::::{grid} 1 1 2 2\n:::{grid-item}\n:columns: 12 12 5 5\n"
                f"![the structure]({sketch})\n:::\n"
                f":::{{grid-item}}\n:columns: 12 12 7 7\n{drawn}\n:::\n::::"
            )
        (folder / f"{name}.md").write_text(
            f"# {title}\n\n{about_case(file.parent)}\n\n"
            f"```sh\neventpound {command} cases/{name}\n```\n\n"
            f"{drawn}\n\n"
            f"## The case file\n\n`cases/{name}/case.toml`:\n\n"
            f"```{{literalinclude}} ../../../cases/{name}/case.toml\n:language: toml\n```\n",
            encoding="utf-8",
        )
        cards.setdefault(_group(name, case), []).append(
            f":::{{grid-item-card}} {title}\n:link: cases/{name}\n:link-type: doc\n"
            f":img-top: {picture}\n:img-alt: {title}\n\n`{name}`\n:::\n"
        )
    grids = [
        f"## {group}\n\n::::{{grid}} 1 2 2 3\n:gutter: 3\n\n" + "\n".join(cards[group]) + "\n::::\n"
        for group in _GROUPS
    ]
    (GENERATED / "gallery.md").write_text(
        "# Gallery: the cases\n\nEvery picture is made by one command from one case file of "
        "`cases/`. Click it to see both, and what is from the paper and what is our choice. Copy a "
        "case that is close to yours and change it.\n\n" + "\n".join(grids) + "\n"
        "```{toctree}\n:hidden:\n:glob:\n\ncases/*\n```\n",
        encoding="utf-8",
    )


def _write_commands() -> None:
    """The help of every command."""
    from eventpound.cli import _parser

    parser = _parser()
    (actions,) = (a for a in parser._actions if hasattr(a, "choices") and a.choices)
    parts = [
        "# Commands\n\nWhat `eventpound COMMAND --help` prints. "
        "All commands exit with 0 when done, 1 when a computation failed, 2 when the input is "
        "wrong, and 130 when interrupted.\n"
    ]
    for name, command in actions.choices.items():
        parts.append(f"## eventpound {name}\n\n```text\n{command.format_help()}```\n")
    (GENERATED / "commands.md").write_text("\n".join(parts), encoding="utf-8")


_OF = {"Bodies": "<body>", "Springs": "<spring>", "Contacts": "<contact>", "All others": ""}
"""Headings of the quantities, and what stands in the paths below each."""


def _write_quantities() -> None:
    """The list of quantities, below what each is one of."""
    from eventpound.quantities.lookup import listing

    rows = list(listing())
    parts = []
    for heading, word in _OF.items():
        here = [row for row in rows if word in row[0]]
        rows = [row for row in rows if row not in here]
        lines = [f"| `{path}` | {' | '.join(others)} |" for path, *others in here]
        parts.append(
            f"### {heading}\n\n| name | unit | what | from |\n| --- | --- | --- | --- |\n"
            + "\n".join(lines)
        )
    (GENERATED / "quantities.txt").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _write_notebook(path: Path) -> None:
    """Cells of a notebook, each with its outputs."""
    name = f"notebook-{path.stem}"
    parts: list[str] = []
    for number, cell in enumerate(json.loads(path.read_text(encoding="utf-8"))["cells"]):
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        for output in cell.get("outputs", ()):
            data = output.get("data", {})
            if "image/png" in data:
                picture = GENERATED / f"{name}-{number}.png"
                picture.write_bytes(base64.b64decode("".join(data["image/png"])))
                parts.append(f"![output]({picture.name})")
            else:
                text = "".join(data.get("text/plain", output.get("text", "")))
                parts.append(f"```text\n{text.rstrip()}\n```")
    parts.append(f"The notebook itself: {{download}}`{path.name} <../notebooks/{path.name}>`.")
    (GENERATED / f"{name}.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _write_generated(app: Any) -> None:
    shutil.rmtree(GENERATED, ignore_errors=True)
    GENERATED.mkdir()
    _write_gallery()
    _write_commands()
    _write_quantities()
    for path in sorted((HERE / "notebooks").glob("*.ipynb")):
        _write_notebook(path)


def setup(app: Any) -> None:
    """Write the generated pages before any page is read."""
    app.connect("builder-inited", _write_generated)
