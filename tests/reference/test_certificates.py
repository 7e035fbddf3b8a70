"""Certificates of solved problems hold against 28 digits."""

import numpy as np
import pytest

from eventpound.accuracy.certificate import SENSITIVE
from eventpound.accuracy.verify import verify
from tests.reference.certificates import check, stated_amplification
from tests.reference.problems import load

PROBLEMS = load()
# Undamped, it ends on its barrier with no speed: v² errs as the energy does, and the routes'
# tolerances of 1e-12 leave half as many digits of v; none gives seven.
TOUCHED = {("A10", "final.b0.v")}
SAMPLE = ("A07", "A10", "B12", "D07", "D11", "E04")
SLACK = 1e4
"""Median of bound over true error, at most; of all problems together half are below 1000."""
SLACKER = {"A10": 1e6, "C01": 1e6, "C03": 5e4, "D06": 5e4}
"""The same where it is more: the runs err less than the routes' differences can show."""


def _judge(name: str) -> None:
    problem = PROBLEMS[name]
    certificate = verify(problem.scene, duration=problem.end)
    checked = check(problem, certificate)
    assert len(checked) >= 6 * len(problem.scene.bodies)
    assert [c.quantity.quantity for c in checked if c.violated] == []
    if stated_amplification(problem) < SENSITIVE:
        assert certificate.certified
        values = [q for q in certificate.quantities if not q.quantity.startswith("events.")]
        assert min(q.digits for q in values if (name, q.quantity) not in TOUCHED) >= 7.0
    else:
        assert certificate.largest_amplification >= SENSITIVE
    slack = [c.slack for c in checked if c.slack is not None]
    if len(slack) > 10 and certificate.certified:
        assert np.median(slack) < SLACKER.get(name, SLACK)


@pytest.mark.parametrize("name", SAMPLE)
def test_certificate_holds(name):
    _judge(name)


@pytest.mark.sweep
@pytest.mark.parametrize("name", PROBLEMS)
def test_every_certificate_holds(name):
    _judge(name)
