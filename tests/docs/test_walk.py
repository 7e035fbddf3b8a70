"""The walk through the code names files that are there, each once."""

import re

from tests.models import ROOT


def test_files_of_the_walk():
    page = (ROOT / "docs" / "walk.md").read_text(encoding="utf-8")
    named = re.findall(r"`([\w/]+\.py)`", page)
    assert len(named) > 30
    assert len(named) == len(set(named))
    assert all((ROOT / "eventpound" / name).is_file() for name in named)
