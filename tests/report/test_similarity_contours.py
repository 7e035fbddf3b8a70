"""Contours over the Π-terms of records."""

import numpy as np
import pytest

from eventpound.case.figure import Figure, FigureKind, LengthRange
from eventpound.report.similarity_contours import similarity_contours_figure


def test_contours_have_their_value_and_records_their_height():
    wanted = Figure(
        FigureKind.SIMILARITY_CONTOURS,
        contours=(0.1, 1.0),
        joints=(LengthRange("joint", 0.006, 0.013),),
        isolators=(LengthRange("isolator", 0.01, 0.01),),
    )
    lengths = np.array([0.002, 0.02])
    figure = similarity_contours_figure(lengths, ["a", "b"], wanted, "title")
    for axes in figure.axes:
        falling = [line for line in axes.get_lines() if len(line.get_xydata()) == 200]
        for line, value in zip(falling, wanted.contours, strict=True):
            x, y = line.get_xydata().T
            assert x / 100.0 * y == pytest.approx(np.full(200, value))
        level = {float(line.get_ydata()[0]) for line in axes.get_lines()}
        assert level >= {50.0, 500.0}
