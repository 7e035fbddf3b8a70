"""Workers, chunks and room for events change no number of a sweep."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound import InputError, Sine, load_case, simulate, simulate_many
from eventpound.case.solver_options import SolverOptions
from eventpound.scene import GROUND, Body, Contact, Linear, Scene, Spring, Support
from eventpound.study import sweep
from eventpound.study.axes import given_axes
from eventpound.study.base import base_of
from eventpound.study.variants import axis_values, rows_with
from tests.models import CASES
from tests.study.test_many import SCENES, assert_identical, variant


@pytest.mark.parametrize(("workers", "most"), [(1, 256), (1, 1), (2, 7), (3, 16), (None, 256)])
def test_workers_and_chunks_change_nothing(monkeypatch, workers, most):
    scene, duration, parameters = SCENES["everything of a pair"]
    expected = simulate_many(scene, parameters, duration=duration, workers=1).table
    monkeypatch.setattr(sweep, "MOST_IN_CHUNK", most)
    found = simulate_many(scene, parameters, duration=duration, workers=workers).table
    assert found.equals(expected)


def test_a_run_with_more_instants_than_events_needs_no_second_one(monkeypatch):
    # The springs of the bridge yield and turn back 300 times and more, at 49 impacts.
    monkeypatch.setattr(sweep.Sweep, "alone", lambda _self, i: pytest.fail(f"variant {i} again"))
    case = load_case(CASES / "bridge-el-centro")
    gaps = np.array([0.0127, 0.0128])
    result = simulate_many(case, {"contact.joint.gap": gaps})
    alone = simulate(
        replace(case, scene=variant(case.scene, {"contact.joint.gap": gaps}, 0)), "fast"
    )
    assert alone.history["t"].duplicated().sum() > 256
    assert_identical(result, 0, alone)


SUPPORTED = Scene(
    (Body("deck", 5e5),),
    (Spring("s", (GROUND, "deck"), Linear(2e7)),),
    contacts=(Contact("joint", "deck", "pier", 0.02, 0.5),),
    motion=Sine(3.0, 0.8, start=-0.85),
    supports=(Support("pier", delay=0.1),),
)


@pytest.mark.parametrize(
    ("key", "fine", "wrong"),
    [
        ("contact.joint.gap", 1.0, -1.0),
        ("body.deck.displacement", -1.0, 1.0),
        # Where the pier is at the start the delay and the motion say.
        ("support.pier.delay", 0.0, 0.4),
        ("excitation.amplitude", 1.0, 1e3),
    ],
)
def test_a_contact_at_a_support_is_checked_in_every_variant(key, fine, wrong):
    def checked(*values: float) -> None:
        axes = given_axes("parameters", {key: values})
        base = base_of(SUPPORTED, axes, (), SolverOptions("fast", 1e-6))
        rows = rows_with(base, axis_values(base, 0, 2), range(2))
        sweep.variants_of(rows, sweep.WantedRuns("fast", 1e-6))

    checked(fine, fine)
    with pytest.raises(InputError, match=r"variant 1 .*gap: found 0?-?[.\d]+; .* not penetrated"):
        checked(fine, wrong)
