"""The package as a notebook has it: names, short texts, tables, units, solvers of one's own."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

import eventpound
from eventpound import (
    Body,
    BoucWen,
    Contact,
    ContactLaw,
    Cosine,
    Dashpot,
    InputError,
    Linear,
    MavroeidisPapageorgiou,
    Record,
    Response,
    Ricker,
    Scene,
    Spring,
    Support,
    compare,
    load_case,
    rayleigh,
    simulate,
    simulate_many,
)
from eventpound.scene.bouc_wen_parameters import Parameter, bouc_wen_parameters
from eventpound.scene.modes import modes_of
from eventpound.solvers.from_samples import sampled_recording
from tests.models import ROOT

CASE = ROOT / "cases" / "bilinear-barrier"


class Still:
    """A solver that finds that nothing ever moves."""

    name = "motionless"
    summary = "nothing moves"
    settings: ClassVar = {"time_step": "distance of its rows (s)"}

    def solve(self, task):
        t = np.linspace(task.start, task.end, 11)
        bodies, springs = len(task.scene.bodies), len(task.scene.hysteretic_springs)
        rows = np.zeros((t.size, bodies))
        return sampled_recording(task, t, rows, rows, np.zeros((t.size, springs)))


@pytest.fixture(scope="module")
def response() -> Response:
    return simulate(load_case(CASE), energy=True)


def test_every_public_name_is_listed_and_there() -> None:
    named = [name for name in dir(eventpound) if not name.startswith("__")]
    assert named == eventpound.__all__
    for name in eventpound.__all__:
        assert getattr(eventpound, name) is not None
    assert files("eventpound").joinpath("py.typed").is_file()


def test_texts_are_short(response: Response) -> None:
    case = load_case(CASE)
    many = simulate_many(case, {"contact.joint.gap": [0.01, 0.02, 0.03]})
    for thing, words in (
        (response, ("cvode", f"{response.impacts} impacts", "largest |u|")),
        (case, (case.title, "1 bodies", "rtol 1e-09")),
        (many, ("3 runs over contact.joint.gap", "0 failed")),
    ):
        assert len(repr(thing)) < 200
        assert all(word in repr(thing) for word in words), repr(thing)
    assert "&lt;Response" in response._repr_html_()
    assert response._repr_html_().count("<table") == 2
    assert many._repr_html_().count("<table") == 1


def test_tables_have_units_and_the_numbers_of_the_summary(response: Response) -> None:
    spring, contact = response.springs, response.contacts
    name = response.scene.springs[0].name
    assert spring.loc[name, "ductility"] == response.summary[f"springs.{name}.ductility"]
    assert spring.attrs["units"]["abs_max_elongation"] == "m"
    assert contact.loc["joint", "sum_impulse"] == response.summary["contacts.joint.sum_impulse"]
    assert contact.attrs["units"]["energy_lost"] == "J"
    assert response.peaks.attrs["units"]["t_max"] == "s"
    assert set(response.history.attrs["units"]) == set(response.history.columns)
    body = response.scene.bodies[0].name
    assert response.pi[f"peaks.{body}.abs_max"] == pytest.approx(
        response.peaks.loc[body, "abs_max"] / response.scene.motion.scales().length, rel=1e-14
    )
    assert response.pi["epsilon"] == response.scene.contacts[0].restitution


def test_rows_without_jumps_are_those_after_them(response: Response) -> None:
    rows = response.rows(jumps=False)
    assert (np.diff(rows["t"]) > 0.0).all()
    whole = response.history
    assert len(whole) > len(rows)
    for t in whole["t"][whole["t"].duplicated()].unique():
        after = whole[whole["t"] == t].iloc[-1]
        assert (rows[rows["t"] == t].iloc[0] == after).all()


def test_plot_draws_into_given_axes(response: Response) -> None:
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    assert response.plot(ax=axes) is axes
    line, circles = axes.lines
    assert np.array_equal(line.get_ydata(), response.recording.history.u[:, 0])
    assert len(circles.get_xdata()) == (response.events["kind"] == "impact").sum()


def test_a_response_with_further_runs_can_be_pickled(response: Response) -> None:
    body = response.scene.bodies[0].name
    value = response.quantity(f"velocity.{body}.abs_max")
    copy = pickle.loads(pickle.dumps(response))
    assert copy.quantity(f"velocity.{body}.abs_max") == value
    assert repr(copy) == repr(response)
    assert response == response != copy


def test_a_solver_of_ones_own_is_an_object() -> None:
    case = load_case(CASE)
    response = simulate(case, Still(), settings={"time_step": 0.1})
    assert response.solver == "motionless"
    assert response.peaks["abs_max"].iloc[0] == 0.0
    assert response.quantity(f"free.peaks.{response.scene.bodies[0].name}.max") == 0.0
    table = compare(case, [Still(), "fast"], rtol=[1e-7], steps=[0.05], repeats=1)
    errors = table.set_index("solver")["peak_error"]
    # All of the largest displacement is missing, to which errors are parts.
    assert errors["motionless"] > 0.5 > 1e-5 > errors["fast"]


@pytest.mark.parametrize("solver", [5, object(), type("Short", (), {"name": "short"})()])
def test_what_is_no_solver(solver: object) -> None:
    with pytest.raises(InputError, match=r"has no .*solve"):
        simulate(load_case(CASE), solver)  # type: ignore[arg-type]


def test_a_name_that_is_taken() -> None:
    taken = Still()
    taken.name = "fast"
    with pytest.raises(InputError, match="another solver is called 'fast'"):
        simulate(load_case(CASE), taken)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"rtol": "1e-6 m"}, "rtol: found '1e-6 m'"),
        ({"rtol": [1e-6]}, "rtol: found [1e-06]"),
        ({"duration": "12 kN"}, "duration: found '12 kN'"),
        ({"duration": -1.0}, "duration: found -1.0; accepted: a positive time (s)"),
        ({"output_step": None, "duration": True}, "duration: found True"),
    ],
)
def test_wrong_arguments_are_named(options: dict, said: str) -> None:
    with pytest.raises(InputError) as caught:
        simulate(load_case(CASE), **options)
    assert said in str(caught.value)


def test_units_in_arguments_and_parts() -> None:
    case = load_case(CASE)
    said = simulate(case, "fast", "1e-6", duration="1500 ms", output_step="0.5 s")
    meant = simulate(case, "fast", 1e-6, duration=1.5, output_step=0.5)
    assert said.peaks.equals(meant.peaks)
    scene = Scene(
        (Body("deck", "1301 t", velocity="5 cm/s"),),
        (Spring("pier", ("ground", "deck"), Linear("12 kN/mm")),),
        (Dashpot(("ground", "deck"), "1743 kN s/m"),),
        (Contact("joint", "deck", "barrier", "1.27 cm", "70 %"),),
    )
    assert scene.bodies[0] == Body("deck", 1.301e6, 0.0, 0.05)
    assert scene.springs[0].law == Linear(1.2e7)
    assert scene.dashpots[0].coefficient == 1.743e6
    assert scene.contacts[0] == Contact("joint", "deck", "barrier", 0.0127, 0.7)
    assert Cosine("0.4 g", "0.8 s") == Cosine(0.4 * 9.80665, 0.8)
    assert Ricker("4 m/s^2", 0.7, center="700 ms") == Ricker(4.0, 0.7, center=0.7)
    record = Record([0.0, 1.0], "0.01 s", pga="0.3 g", start="1 s")
    assert (record.time_step, record.pga, record.start) == (0.01, 0.3 * 9.80665, 1.0)
    assert MavroeidisPapageorgiou(1.0, 1.0, phase="90 deg").phase == pytest.approx(math.pi / 2)
    assert Support("pier", "120 ms").delay == 0.12
    assert ContactLaw("hertz", "2 kN/mm^1.5").stiffness == pytest.approx(2e3 / 0.001**1.5)
    lists = Scene(list(scene.bodies), [replace(scene.springs[0], between=["ground", "deck"])])
    assert lists == Scene(scene.bodies, scene.springs)
    with pytest.raises(InputError, match=r"Body: mass: found '1301 m'"):
        Body("deck", "1301 m")


def test_laws_from_what_engineers_know() -> None:
    law = BoucWen.from_yield("233443 kN/m", "3621 kN", "5 %")
    given = {
        Parameter.INITIAL_STIFFNESS: 233443e3,
        Parameter.YIELD_FORCE: 3621e3,
        Parameter.HARDENING: 0.05,
    }
    found = bouc_wen_parameters(given)
    assert (law.stiffness, law.strength) == (found[Parameter.STIFFNESS], found[Parameter.STRENGTH])
    assert law.yield_displacement == found[Parameter.YIELD_DISPLACEMENT]
    assert Dashpot.from_ratio(("ground", "a"), "5 %", 4.0, 9.0).coefficient == pytest.approx(0.6)


def test_rayleigh_damping_of_a_building() -> None:
    bodies = tuple(Body(name, 1e5) for name in "abc")
    ends = ("ground", "a", "b", "c")
    springs = tuple(Spring(b, (a, b), Linear(9e7)) for a, b in pairwise(ends))
    names = list("abc")
    dashpots = rayleigh(bodies, springs, "4 %", modes=(1, 2))
    modes = modes_of(Scene(bodies, springs, dashpots), names)
    assert modes.damping[:2] == pytest.approx(0.04, rel=1e-12)
    again = rayleigh(bodies, springs, 0.04, periods=(modes.period[0], modes.period[1]))
    for one, other in zip(dashpots, again, strict=True):
        assert one.coefficient == pytest.approx(other.coefficient, rel=1e-12)
    with pytest.raises(InputError, match="one of modes and periods"):
        rayleigh(bodies, springs, 0.04)
    with pytest.raises(InputError, match="numbers from 1 to 3"):
        rayleigh(bodies, springs, 0.04, modes=(1, 4))


def test_progress_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    response = simulate(load_case(CASE), "fast", progress=True)
    assert capsys.readouterr().err.endswith(f"{response.recording.t:.6g} s\n")
    pickle.dumps(response)


@pytest.mark.parametrize("path", sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")))
def test_notebooks_of_the_docs_run(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib

    monkeypatch.setattr(matplotlib, "get_backend", lambda: "agg")
    matplotlib.use("agg")
    notebook = json.loads(path.read_text(encoding="utf-8"))
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) >= 5
    for cell in cells:
        exec(compile("".join(cell["source"]), "notebook", "exec"), names)
    assert isinstance(names["response"], Response)
    assert names["response"].impacts > 0
