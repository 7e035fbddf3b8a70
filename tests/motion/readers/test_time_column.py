"""The step of printed times: right where one exists within their rounding, else refused."""

import math

import pytest

from eventpound.errors import InputError
from eventpound.motion.readers import Source
from eventpound.motion.readers.time_column import even_step

FILE = Source("a.txt", b"")


def step(texts: list[str], stated: float | None = None, unit: float = 1.0) -> float:
    return even_step(FILE, texts, list(range(1, len(texts) + 1)), stated, unit)


def rounded(h: float, count: int, decimals: int, start: float = 0.0) -> list[str]:
    return [f"{start + i * h:.{decimals}f}" for i in range(count)]


def cut(h: float, count: int, decimals: int, start: float = 0.0) -> list[str]:
    unit = 10**decimals
    return [
        f"{math.floor((start + i * h) * unit + 1e-6) / unit:.{decimals}f}" for i in range(count)
    ]


def test_512_hz_to_four_decimals_at_every_length():
    h = 1.0 / 512.0
    for count in range(75, 501):
        assert step(rounded(h, count, 4)) == h
        assert step(rounded(h, count, 4), stated=h) == h


@pytest.mark.parametrize("written", [rounded, cut])
@pytest.mark.parametrize("start", [0.0, 5.0, 0.0037])
@pytest.mark.parametrize("decimals", [2, 3, 4, 5, 6])
@pytest.mark.parametrize(
    "h", [1 / 3, 3.0, 0.03, 0.005, 1 / 30, 1 / 128, 1 / 256, 0.00244, 0.01, 1 / 1024]
)
def test_steps_of_rounded_and_cut_times(written, h, decimals, start):
    texts = written(h, 600, decimals, start)
    # Six hundred times fix the step to a unit of their last decimal in the sum.
    assert step(texts) == pytest.approx(h, abs=(1.03 * 10.0**-decimals + 2e-3 * h) / 599)
    assert step(texts, stated=h) == h


def test_another_step_than_that_of_the_times_is_not_taken():
    assert step(rounded(0.01, 100, 2), stated=0.02) == 0.01
    assert step(["0.0", "0.1"], stated=0.2) == 0.1


def test_times_in_another_unit():
    assert step(rounded(1000.0 / 512.0, 200, 1), unit=1e-3) == 1.0 / 512.0


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        ([*rounded(0.01, 50, 2), *rounded(0.01, 50, 2, 0.51)], "line 51: .*found 0.02 s, exp"),
        ([*rounded(0.01, 50, 2), *rounded(0.01, 50, 2, 0.49)], "line 51: .*found 0 s, expected"),
        ([*rounded(0.02, 50, 3), *rounded(0.02, 50, 3, 1.013)], "line 51: .*found 0.033 s, exp"),
        ([*rounded(0.01, 50, 2), *rounded(0.012, 50, 2, 0.5)], "the time step is not even"),
        (["0", "1", "3"], "line 3: .*found 2 s, expected 1 s"),
        (["2", "1", "0"], "does not increase"),
    ],
)
def test_uneven_times(texts, message):
    with pytest.raises(InputError, match=message):
        step(texts)
