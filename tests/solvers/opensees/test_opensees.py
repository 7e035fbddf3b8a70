"""OpenSees against the fast solver, where it is installed and imports."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from eventpound import ComputationError, Cosine, InputError, load_case, simulate
from eventpound.scene import (
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    ContactLaw,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from eventpound.scene.contact_law import BY_WORD
from eventpound.solvers import available, solver_named
from eventpound.solvers.base import EventKind
from tests.benchmarks import opensees_laws
from tests.models import CASES


def _missing() -> str:
    """Why OpenSees cannot run; empty where it can."""
    try:
        importlib.import_module("openseespy.opensees")
    except (ImportError, RuntimeError) as error:
        return str(error)
    return ""


needed = pytest.mark.skipif(bool(_missing()), reason=f"openseespy: {_missing()}")


def test_without_it_the_name_is_explained():
    if "opensees" in available():
        pytest.skip("openseespy is installed")
    with pytest.raises(InputError, match="solver = 'opensees' needs openseespy"):
        solver_named("opensees")


@pytest.fixture
def smooth():
    """Everything but contacts: hysteresis, a kink, dashpots, an initial velocity, jumps of a_g."""
    return Scene(
        bodies=(Body("a", 1.0, velocity=0.1), Body("b", 2.0)),
        springs=(
            Spring("s", (GROUND, "a"), BoucWen(0.5, 0.4, 0.3, exponent=2.0)),
            Spring("t", ("a", "b"), Linear(3.0)),
            Spring("w", ("b", GROUND), BilinearElastic(4.0, 1.0, 0.05)),
        ),
        dashpots=(Dashpot((GROUND, "a"), 0.1), Dashpot(("a", "b"), 0.05)),
        motion=Cosine(1.0, 4.0),
    )


@needed
def test_second_order_where_nothing_collides(smooth):
    true = simulate(smooth, "fast", 1e-11, duration=8.0)
    errors = []
    for step in (0.02, 0.01, 0.005):
        found = simulate(smooth, "opensees", settings={"time_step": step}, duration=8.0)
        r = found.recording
        state = np.concatenate((r.u, r.v, r.z))
        t = true.recording
        errors.append(np.abs(state - np.concatenate((t.u, t.v, t.z))).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # Its Bouc-Wen steps by backward Euler in z, which is of first order.
    assert np.all(orders > 0.8)
    elastic = replace(smooth, springs=smooth.springs[1:])
    true = simulate(elastic, "fast", 1e-11, duration=8.0).recording
    errors = [
        np.abs(
            simulate(elastic, "opensees", settings={"time_step": h}, duration=8.0).recording.u
            - true.u
        ).max()
        for h in (0.02, 0.01, 0.005)
    ]
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(2.0, abs=0.3)


@needed
@pytest.mark.parametrize("name", ["elastic-barrier", "pair"])
def test_impacts_come_closer_with_the_step(name):
    case = load_case(CASES / name)
    true = simulate(case, "fast", 1e-9).recording
    (first, *_) = [e for e in true.events if e.kind is EventKind.IMPACT and e.t > 0.05]
    late = []
    for step in (1e-3, 2.5e-4):
        found = simulate(case, "opensees", settings={"time_step": step})
        assert found.work.rhs >= found.work.steps > 0
        impacts = [e for e in found.recording.events if -e.gap_velocity_before > 0.02]
        late.append(min(abs(e.t - first.t) for e in impacts))
        peak = found.recording.displacement.minimum
        scale = np.abs(true.displacement.minimum)
        assert np.all(np.abs(peak - true.displacement.minimum) < 0.1 * scale)
    # The first closing comes before any contact force: of second order in the step.
    assert late[1] < late[0] / 4.0


@needed
def test_a_record_and_results(tmp_path):
    case = load_case(CASES / "elastic-barrier")
    short = replace(case, run=replace(case.run, duration=0.5, output_step=0.01))
    found = simulate(short, "opensees", settings={"time_step": 1e-3, "contact": "linear"})
    history = found.history
    assert {0.0, 0.25, 0.5} <= set(np.round(history["t"], 12))
    assert np.all(np.diff(history["t"]) >= 0.0)


@needed
def test_no_convergence_is_said():
    """A contact so stiff that Newton's iterations go to and fro between open and closed."""
    case = load_case(CASES / "elastic-barrier")
    settings = {"time_step": 0.05, "contact_stiffness": 1e20}
    message = "did not converge; try a smaller time_step"
    with pytest.raises(ComputationError, match=message) as caught:
        simulate(case, "opensees", settings=settings)
    assert not caught.value.recording.success
    # The reference closes its gap at 0.3636 s.
    assert 0.3 <= caught.value.recording.t < 0.37


@needed
@pytest.mark.parametrize("settings", [{}, {"time_step": 0.0}, {"time_step": "short"}])
def test_a_step_is_needed(smooth, settings):
    with pytest.raises(InputError, match=r"time_step.*; accepted: a positive time"):
        simulate(smooth, "opensees", settings=settings, duration=1.0)


@needed
@pytest.mark.parametrize("word", list(BY_WORD))
def test_a_contact_law_comes_to_ours_with_the_step(word, monkeypatch):
    """Its material and our law are one model: the error of its steps alone is left."""
    monkeypatch.setattr(opensees_laws, "STEPS", (4e-4, 2.5e-5))
    coarse, fine = opensees_laws.errors(word)
    # Of first order where the force jumps, some hundredth of the motion's own part of a step.
    assert fine < 4e-5
    assert fine < 0.3 * coarse


@needed
@pytest.mark.parametrize(
    ("changes", "message"),
    [({"law": ContactLaw("kelvin-voigt", 1e4, 0.2, False)}, "may pull"),
     ({"gap": -0.1}, "starts from an open gap")],
)  # fmt: skip
def test_laws_that_are_refused(changes, message):
    scene = opensees_laws.pair("linear")
    contacts = (replace(scene.contacts[0], **changes), *scene.contacts[1:])
    with pytest.raises(InputError, match=f"contact joint: .*{message}"):
        simulate(
            replace(scene, contacts=contacts), "opensees", settings={"time_step": 1e-3},
            duration=0.1,
        )  # fmt: skip
