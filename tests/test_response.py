"""The package as a notebook has it: names, short texts, tables, units, solvers of one's own."""

import json
import pickle
from importlib.resources import files
from itertools import pairwise

import numpy as np
import pytest

import eventpound
from eventpound import (
    Body,
    BoucWen,
    Dashpot,
    InputError,
    Linear,
    Response,
    Scene,
    Spring,
    load_case,
    rayleigh,
    simulate,
    simulate_many,
)
from eventpound.scene.bouc_wen_parameters import Parameter, bouc_wen_parameters
from eventpound.scene.modes import modes_of
from tests.models import ROOT

CASE = ROOT / "cases" / "bilinear-barrier"


@pytest.fixture(scope="module")
def response():
    return simulate(load_case(CASE), energy=True)


def test_every_public_name_is_listed_and_there():
    named = [name for name in dir(eventpound) if not name.startswith("__")]
    assert named == eventpound.__all__
    for name in eventpound.__all__:
        assert getattr(eventpound, name) is not None
    assert files("eventpound").joinpath("py.typed").is_file()


def test_texts_are_short(response):
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


def test_tables_have_units_and_the_numbers_of_the_summary(response):
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


def test_rows_without_jumps_are_those_after_them(response):
    rows = response.rows(jumps=False)
    assert (np.diff(rows["t"]) > 0.0).all()
    whole = response.history
    assert len(whole) > len(rows)
    for t in whole["t"][whole["t"].duplicated()].unique():
        after = whole[whole["t"] == t].iloc[-1]
        assert (rows[rows["t"] == t].iloc[0] == after).all()


def test_plot_draws_into_given_axes(response):
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    assert response.plot(ax=axes) is axes
    line, circles = axes.lines
    assert np.array_equal(line.get_ydata(), response.recording.history.u[:, 0])
    assert len(circles.get_xdata()) == (response.events["kind"] == "impact").sum()


def test_a_response_with_further_runs_can_be_pickled(response):
    body = response.scene.bodies[0].name
    value = response.quantity(f"velocity.{body}.abs_max")
    copy = pickle.loads(pickle.dumps(response))
    assert copy.quantity(f"velocity.{body}.abs_max") == value
    assert repr(copy) == repr(response)
    assert response == response != copy


def test_laws_from_what_engineers_know():
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


def test_rayleigh_damping_of_a_building():
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


def test_progress_on_stderr(capsys):
    response = simulate(load_case(CASE), "fast", progress=True)
    assert capsys.readouterr().err.endswith(f"{response.recording.t:.6g} s\n")
    pickle.dumps(response)


@pytest.mark.pages
@pytest.mark.parametrize("path", sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")))
def test_notebooks_of_the_docs_run(path, tmp_path, monkeypatch):
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
