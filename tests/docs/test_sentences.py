"""Sentences of the pages for users are short enough to be read once."""

import re

import pytest

from tests.models import DOCS

LONGEST = 40
"""Words."""
EVIDENCE = {"changelog", "league", "problems", "promises"}
"""Lists of what was done, found and tested; docs/measured is evidence, too."""
PAGES = sorted(
    page
    for page in [*DOCS.glob("*.md"), *DOCS.glob("tutorials/*.md"), DOCS.parent / "README.md"]
    if page.stem not in EVIDENCE
)


def sentences(text: str) -> list[str]:
    """Those of the running text: no code, tables, headings, comments."""
    text = re.sub(r"```.*?```|<!--.*?-->", "\n\n", text, flags=re.DOTALL)
    text = re.sub(r"^(\||#| {4,}\S).*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    paragraphs = re.split(r"\n\s*\n|\n\s*(?:[*-]|\d+\.|:)\s", text)
    return [
        sentence
        for paragraph in paragraphs
        for sentence in re.split(r"(?<=[.!?])\s+(?=[A-Z`*\"(])", " ".join(paragraph.split()))
        if sentence
    ]


@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_sentences_are_short(page):
    found = sentences(page.read_text(encoding="utf-8"))
    assert [each for each in found if len(each.split()) > LONGEST] == []
