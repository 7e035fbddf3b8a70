"""Histories of other programs: columns by name or number, units of titles, rounded times."""

import numpy as np
import pytest

from eventpound.accuracy.foreign_history import read_foreign
from eventpound.case import load_case
from tests.models import CASES

CASE = load_case(CASES / "elastic-barrier")
T = np.arange(200) / 512.0
U, V = np.sin(T), np.cos(T)


@pytest.mark.parametrize(
    ("form", "columns"),
    [
        ("{0!r} {1!r} {2!r}\n", {"t": 1, "u.deck": 2, "v.deck": "3"}),
        ("{0!r},{2!r},{1!r}\n", {"t": 1, "u.deck": 3, "v.deck": 2}),
        ("# time x speed\n{0!r} {1!r} {2!r}\n", {"t": "time", "u.deck": "x", "v.deck": 3}),
        ("% by a program\n{0!r}\t{1!r}\t{2!r}\n", {"t": 1, "u.deck": 2, "v.deck": 3}),
        ("time;x;speed\n{0!r};{1!r};{2!r}\n", {"t": "time", "u.deck": 2, "v.deck": "speed"}),
        (
            "t [ms]\tx (mm)\tspeed (cm/s)\n{3!r}\t{4!r}\t{5!r}\n",
            {"t": "t [ms]", "u.deck": 2, "v.deck": 3},
        ),
        ("t_ms,x_mm,speed_cm/s\n{3!r},{4!r},{5!r}\n", {"t": 1, "u.deck": 2, "v.deck": 3}),
        ("t,u.deck,v.deck\n{0:.4f},{1!r},{2!r}\n", {}),
        ("{0:.4f} {1!r} {2!r}\n", {"t": 1, "u.deck": 2, "v.deck": 3}),
    ],
)
def test_the_same_motion_in_many_dresses(tmp_path, form, columns):
    *title, row = form.splitlines(keepends=True)
    table = np.column_stack([T, U, V, 1e3 * T, 1e3 * U, 1e2 * V]).tolist()
    (tmp_path / "x.out").write_text("".join([*title, *(row.format(*cells) for cells in table)]))
    motion = read_foreign(CASE, tmp_path / "x.out", columns).motion
    for found, expected in ((motion.t, T), (motion.u[:, 0], U), (motion.v[:, 0], V)):
        np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-15)


def test_uneven_times_stay_as_they_are(tmp_path):
    (tmp_path / "x.csv").write_text("t,u.deck\n0,0\n0.1,1\n0.1,1\n0.25,2\n")
    motion = read_foreign(CASE, tmp_path / "x.csv", {}).motion
    assert motion.t.tolist() == [0.0, 0.1, 0.1, 0.25]
