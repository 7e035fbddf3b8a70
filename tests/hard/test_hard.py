"""The catalogue of hard scenes: known answers are met, and the solvers agree or refuse alike."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound.accuracy.estimate import estimate_errors
from eventpound.simulation import response_of
from eventpound.solvers.base import EventKind
from tests.hard.catalogue import LONG, REFUSED, SOLVERS, WARNED, Hard, catalogue
from tests.hard.generated import GENERATED
from tests.hard.outcome import OWN, outcome, tally, unsaid, verdict, wrong_values

CATALOGUE = catalogue()
SCALES = [hard for hard in CATALOGUE if hard.name.startswith("scale-")]


def named(name: str) -> Hard:
    return next(hard for hard in CATALOGUE if hard.name == name)


@pytest.mark.parametrize(
    "hard",
    [
        pytest.param(hard, id=hard.name, marks=[pytest.mark.sweep] if hard.name in LONG else [])
        for hard in CATALOGUE
    ],
)
def test_right_or_refused(hard):
    found = verdict(hard, [outcome(hard, solver) for solver in hard.solvers])
    allowed = ("agree", "warns") if hard.name in WARNED else ("agree", "refused")
    assert found.word in allowed, found.remark


@pytest.mark.parametrize("solver", ["cvode", "fast", pytest.param("ida", marks=pytest.mark.sweep)])
def test_stiff_beside_soft(solver):
    """Changes of 1e-10 in masses and forces leave 15 or 16 rests, of 1e-12 always 16."""
    found = outcome(named("stiff-beside-soft"), solver, 1e-12).response
    events = found.recording.events
    assert sum(event.kind is EventKind.REST for event in events) == 16
    assert sum(event.kind is EventKind.DETACHMENT for event in events) == 16
    assert found.impacts == pytest.approx(611, rel=0.02)
    assert found.recording.resting_time[0] == pytest.approx(0.197158, rel=1e-3)


def test_counts_that_differ_are_said():
    """At 1e-9 the same scene rests two to eight times as often, and says so."""
    hard = named("stiff-beside-soft")
    found = [outcome(hard, solver).response for solver in ("cvode", "fast")]
    both = [response for response in found if response is not None]
    assert tally(both[0]) != tally(both[1])
    assert unsaid(hard, both) == []
    assert "contact 'a-b' comes to rest" in estimate_errors(both[0])["warnings"][0]


@pytest.mark.parametrize("solver", SOLVERS)
def test_scales(solver):
    """Peaks in parts of L_e do not depend on the units of length and time."""
    peaks = []
    for hard in SCALES:
        response = response_of(hard.case, solver=solver)
        scales = hard.case.scene.motion.scales()
        peaks.append(response.peaks["abs_max"].iloc[0] * scales.omega_g**2 / scales.a_g)
    np.testing.assert_allclose(peaks, peaks[0], rtol=1e3 * SCALES[0].case.solver.rtol)


@pytest.mark.parametrize("solver", SOLVERS)
def test_error_follows_the_tolerance(solver):
    """From 1e-4 to 1e-13: twelve slips of a slider, each begun and ended by an event."""
    hard = named("slider-sticks-and-slips")
    for rtol in 10.0 ** -np.arange(4.0, 14.0):
        found = outcome(hard, solver, float(rtol)).response
        assert found is not None
        assert not wrong_values(replace(hard, within=OWN * float(rtol)), found)


def test_few_are_refused():
    assert REFUSED.keys() <= {hard.name for hard in CATALOGUE}
    assert len(REFUSED) <= 0.05 * len(CATALOGUE)
    assert GENERATED.keys() <= {hard.name for hard in CATALOGUE}
