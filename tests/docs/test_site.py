"""What the pages show is there: pictures of the cases as they are, files, pages, commands."""

import re
import shlex
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path

import pytest

from eventpound.cli import _parser
from tests.models import ROOT

DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))

from pictures import GALLERY, case_names, hash_of, is_one_run, made  # noqa: E402

WRITTEN_WHEN_BUILT = ("generated/",)
PAGES = [
    path
    for path in sorted(DOCS.rglob("*.md"))
    if not str(path.relative_to(DOCS)).startswith(WRITTEN_WHEN_BUILT)
]
NAMES = [str(path.relative_to(DOCS)) for path in PAGES]


@pytest.mark.parametrize("name", case_names())
def test_the_gallery_shows_the_case_as_it_is(name):
    """`python docs/pictures.py NAME` makes a picture again."""
    assert made().get(name) == hash_of(name)
    assert (GALLERY / f"{name}.png").exists()
    assert (GALLERY / f"{name}-model.png").exists() == is_one_run(name)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_links_lead_to_files(page):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        if "://" in target or target.startswith(WRITTEN_WHEN_BUILT):
            continue
        assert (page.parent / target).exists(), target


FOLDERS = "|".join(sorted(p.name for p in (ROOT / "eventpound").iterdir() if p.is_dir()))
FILE = re.compile(
    rf"`((?:{FOLDERS}|tests|cases|docs|eventpound)/[\w./-]*?[\w-]+\.(?:py|cpp|c|json))`"
)


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=[*NAMES, "README.md"])
def test_files_of_the_checkout_are_there(page):
    for name in FILE.findall(page.read_text(encoding="utf-8")):
        # NAME stands for one of the reader's own; results are written by a run.
        if "NAME" not in name and not name.startswith("results/"):
            assert (ROOT / name).exists() or (ROOT / "eventpound" / name).exists(), name


def test_the_package_names_pages_that_are_there_and_no_files_of_the_checkout():
    """What is installed has no docs; `eventpound.cli.talk` puts in the address of the site."""
    for file in (ROOT / "eventpound").rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        assert "docs/" not in text, file
        for name in re.findall(r"""\bpage ["“]([\w-]+)["”]""", text):
            assert (DOCS / f"{name}.md").exists(), (file, name)


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=[*NAMES, "README.md"])
def test_commands_are_understood(page):
    """Every line of a block that calls eventpound or a module of the tests."""
    for line in _commands(page):
        words = shlex.split(line, comments=True)
        if "eventpound" in Path(words[0]).name:
            arguments = [word for word in words[1:] if word != "..."]
            assert _is_understood(arguments), line
        elif words[1:2] == ["-m"] and words[2].startswith("tests."):
            assert find_spec(words[2]), line


def test_the_citation_has_the_version_of_the_package():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def _is_understood(arguments: list[str]) -> bool:
    try:
        _parser().parse_args(arguments)
    except SystemExit as stop:
        return stop.code == 0
    return True


def _commands(page: Path) -> list[str]:
    blocks = re.findall(r"```sh\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    lines = [part.strip() for block in blocks for part in re.split(r"\n|&&", block)]
    calls = ("eventpound ", "python -m ", ".venv/bin/eventpound ", ".venv/bin/python -m ")
    return [line for line in lines if line.startswith(calls)]
