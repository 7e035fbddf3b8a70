"""A case with a record in every format, from its file to its results."""

import json

import numpy as np
import pytest

from eventpound.case import read_case
from eventpound.cli import main
from tests.motion.readers.writers import WRITERS, motion

SIZE, STEP = 400, 0.02
CASE = """
body = [{{ name = "deck", mass = 1.0 }}]
spring = [{{ between = ["ground", "deck"], law = "linear", period = 0.5 }}]
contact = [{{ between = ["deck", "barrier"], gap = 0.01, restitution = 0.5 }}]
[excitation]
kind = "record"
file = "record.txt"
{keys}

[solver]
name = "fast"
"""


@pytest.mark.parametrize("name", WRITERS)
def test_run_of_a_case_with_every_format(name, tmp_path):
    written = WRITERS[name](motion(SIZE, STEP), STEP)
    keys = [f'units = "{written.units}"'] if written.units else []
    keys += [f"time_step = {written.time_step}"] if written.time_step else []
    keys += [f'component = "{written.components[0]}"'] if len(written.components) > 1 else []
    (tmp_path / "record.txt").write_text(written.text)
    (tmp_path / "case.toml").write_text(CASE.format(keys="\n".join(keys)))
    assert main(["run", str(tmp_path), "--no-figures"]) == 0
    manifest = json.loads((tmp_path / "results" / "manifest.json").read_text())
    assert manifest["record"]["format"] == (written.format or name)
    # What the manifest says was run is a case again, of the same motion.
    understood = read_case(manifest["case"], tmp_path / "case.toml").scene.motion
    a = motion(SIZE, STEP)
    expected = a - np.mean(a) if name == "knet" else a
    sign = -1.0 if written.components[0] == "EW" else 1.0
    np.testing.assert_allclose(
        sign * understood.samples, expected, rtol=0.0, atol=written.resolution * (1.0 + 1e-9)
    )
