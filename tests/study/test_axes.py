"""Axes of a study, and what they are called."""

import csv
import io

from eventpound.report.symbols import axis_label
from eventpound.study.reading import load_study
from eventpound.study.table import compute, header
from tests.models import CASES


def test_an_axis_of_a_delay(tmp_path):
    """With units, a label, and every quantity of the support from no delay on."""
    case = (CASES / "passing-wave" / "case.toml").read_text()
    (tmp_path / "case.toml").write_text(
        case
        + """
[study]
quantities = ["supports.pier2.abs_max_shear", "supports.pier2.work"]
[[study.axis]]
key = "support.pier2.delay"
values = ["0 s", "60 ms", 0.12]
"""
    )
    study = load_study(tmp_path).study
    (axis,) = study.bases[0].axes
    assert axis.values.tolist() == [0.0, 0.06, 0.12]
    assert axis_label("support.pier2.delay") == "delay of pier2 (s)"
    table = [header(study), *(compute(study, chunk) for chunk in study.chunks())]
    rows = list(csv.DictReader(io.StringIO(b"".join(table).decode())))
    shear, work = (
        [float(row[f"supports.pier2.{key}"]) for row in rows] for key in ("abs_max_shear", "work")
    )
    assert min(shear) > 0.0
    assert work[0] == 0.0
    assert min(map(abs, work[1:])) > 0.0
