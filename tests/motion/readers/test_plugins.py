"""Formats of other packages: found, named where broken, harmless to the rest."""

import re
import sys
import tomllib

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.readers import format_names, registry
from tests.models import ROOT
from tests.plugged import plug_in

GROUP = "eventpound.readers"


@pytest.fixture(autouse=True)
def _look_again():
    """Entry points are looked for once a process; here once a test."""
    registry._plugged_in.cache_clear()
    known = set(sys.modules)
    yield
    registry._plugged_in.cache_clear()
    for name in set(sys.modules) - known:
        if name in ("mynet_reader", "broken"):
            del sys.modules[name]


def test_the_documented_example(monkeypatch, tmp_path):
    text = (ROOT / "docs" / "your-format.md").read_text(encoding="utf-8")
    files = dict(re.findall(r"<!-- example: (\S+) -->\n```\w+\n(.*?)```", text, re.DOTALL))
    project = tomllib.loads(files["pyproject.toml"])["project"]
    sources = {"mynet_reader.py": files["mynet_reader.py"]}
    plug_in(monkeypatch, tmp_path, sources, project["entry-points"][GROUP], project["name"], GROUP)
    assert format_names()[-4:] == ["mynet", "count-and-step", "opensees", "columns"]
    path = tmp_path / "record"
    path.write_text("MYNET ATH N-S\n3 samples every 0.01 s\n 1.0 -2.0\n 3.5\n")
    data = read_record(path)
    np.testing.assert_array_equal(data.acceleration, 0.01 * np.array([1.0, -2.0, 3.5]))
    assert (data.format, data.station, data.component) == ("mynet", "ATH", "N-S")
    assert data.time_step == 0.01
    path.write_text("MYNET ATH N-S\n4 samples every 0.01 s\n 1.0 -2.0\n 3.5\n")
    with pytest.raises(InputError, match="3 numbers found up to line 4; line 2 states samples = 4"):
        read_record(path)
    path.write_text("MYNET ATH N-S\nmany samples\n 1.0 -2.0\n 3.5\n")
    with pytest.raises(InputError, match="the header has no line 'samples'"):
        read_record(path)


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("1 / 0", "cannot be loaded: ZeroDivisionError"),
        ("READER = 1", "no eventpound.motion.readers.Reader"),
        (
            "from eventpound.motion.readers import Reader\nREADER = Reader('at2', bool, list)",
            "another format is called 'at2'",
        ),
    ],
)
def test_broken_ones_are_named_and_left_out(monkeypatch, tmp_path, source, words):
    entries = {"broken": "broken:READER"}
    plug_in(monkeypatch, tmp_path, {"broken.py": source}, entries, "bad-package", GROUP)
    path = tmp_path / "record"
    path.write_text("0.0\n0.1\n0.2\n")
    assert read_record(path, units="g", time_step=0.01).format == "columns"
    with pytest.raises(InputError, match=r"format 'broken': .* of bad-package") as caught:
        read_record(path, format="broken")
    assert words in str(caught.value)
