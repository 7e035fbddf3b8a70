"""The bridge under real records: the fast solver beside CVODE on some of every kind."""

import pytest

from eventpound import InputError, load_case, simulate
from eventpound.case.case import member_case
from tests.benchmarks.real_records import INDEX
from tests.models import CASES

CASE = CASES / "bridge-record"
pytestmark = pytest.mark.skipif(
    not INDEX.is_file(), reason="the folder of real records is not beside the checkout"
)


def test_peaks_agree_with_the_reference():
    case = load_case(CASE, str(INDEX))
    members = case.suite.members(case.directory)
    assert len(members) > 100
    compared = 0
    for member in members[::30]:
        try:
            one = member_case(case, member, member.read())
        except InputError:
            continue
        fast = simulate(one).peaks["abs_max"]
        reference = simulate(one, "cvode", 1e-10).peaks["abs_max"]
        assert (fast - reference).abs().max() <= 1e-6 * reference.max()
        compared += 1
    assert compared >= 3
