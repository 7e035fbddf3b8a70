"""Processing of a record in a case: what is done, what is recorded, what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from eventpound.case import read_case
from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.processing import Processing
from tests.motion.readers.writers import WRITERS, motion


def write_case(directory: Path, processing: str) -> Path:
    (directory / "a.at2").write_text(WRITERS["at2"](motion(400, 0.02), 0.02).text)
    (directory / "case.toml").write_text(
        f'[excitation]\nkind = "record"\nfile = "a.at2"\npga = "0.3 g"\n{processing}\n'
        '[[body]]\nname = "a"\nmass = 1.0\n'
        '[[spring]]\nbetween = ["ground", "a"]\nlaw = "linear"\nperiod = 0.5\n'
        '[solver]\nname = "fast"\n'
    )
    return directory


def test_samples_are_processed_then_scaled_and_the_manifest_says_so(tmp_path):
    keys = '{ baseline = 1, highpass = "0.2 Hz", lowpass = 20 }'
    write_case(tmp_path, f"processing = {keys}")
    assert main(["run", str(tmp_path), "--no-figures"]) == 0
    manifest = json.loads((tmp_path / "results" / "manifest.json").read_text())
    assert manifest["case"]["excitation"]["processing"] == {
        "baseline": 1,
        "highpass": 0.2,
        "lowpass": 20.0,
        "order": 4,
    }
    again = read_case(manifest["case"], tmp_path / "case.toml")
    processed = Processing(1, 0.2, 20.0).apply(read_record(tmp_path / "a.at2"))
    np.testing.assert_array_equal(again.scene.motion.samples, processed.acceleration)
    assert again.scene.motion.scales().a_g == pytest.approx(0.3 * 9.80665, rel=1e-15)
    assert any("processed: baseline of degree 1" in warning for warning in again.warnings)


def test_without_it_nothing_is_done_and_nothing_is_said(tmp_path):
    write_case(tmp_path, "")
    assert main(["run", str(tmp_path), "--no-figures"]) == 0
    manifest = json.loads((tmp_path / "results" / "manifest.json").read_text())
    assert "processing" not in manifest["case"]["excitation"]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("{ baseline = 1.5 }", r"processing.baseline: found 1.5; accepted: a whole number"),
        ("{ baseline = 9 }", r"baseline = 9; accepted: a whole number from 0 to 6"),
        ("{ order = true }", r"processing.order: found True; accepted: a whole number"),
        ('{ highpass = "1 s" }', r"processing.highpass: .*'s' is no unit of frequency"),
        ('{ highpass = "1 rad/s" }', r"rad/s is an angular frequency; write it in Hz"),
        ("{ highpass = 30 }", r"a corner of 30 Hz; .* below 25 Hz"),
        ("{ highpass = 3, lowpass = 2 }", r"the lower corner is that of highpass"),
        ("{ hipass = 3 }", r"processing.hipass: unknown key, did you mean 'highpass'"),
        ("4", r"processing: found 4; accepted: a table"),
    ],
)
def test_refusals(tmp_path, keys, message):
    from eventpound.case import load_case

    with pytest.raises(InputError, match=message):
        load_case(write_case(tmp_path, f"processing = {keys}"))
