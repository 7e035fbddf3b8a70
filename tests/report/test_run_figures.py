"""Two runs in one figure, Π-terms, profiles and drifts, loops between rows."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound import InputError, load_case, simulate
from eventpound.case import write_template
from eventpound.cli import main
from eventpound.report.run_figures import figures, view_of_run
from eventpound.report.towers import storeys_of, towers_of
from eventpound.results import gather
from eventpound.scene import GROUND, Body, Linear, Scene, Spring
from tests.models import CASES
from tests.solvers.scenes import pounding_pair


@pytest.fixture(scope="module")
def buildings(tmp_path_factory):
    case = load_case(write_template(tmp_path_factory.mktemp("b") / "case", "buildings"))
    return simulate(case, "fast", rtol=1e-6)


def panel(figure: Figure, word: str) -> Axes:
    return next(axes for axes in figure.axes if word in axes.get_ylabel())


def test_without_contact_in_one_figure(buildings):
    free = buildings.without_contact
    drawn = figures(buildings, (free, "without contact"))
    assert list(drawn) == ["displacements.png", "loops.png", "profiles.png"]
    axes = panel(drawn["displacements.png"], "displacement")
    pale = [line for line in axes.get_lines() if line.get_alpha() == 0.45]
    assert len(pale) == len(buildings.scene.bodies)
    size = 100.0 * free.history["u.A1"].to_numpy()
    assert np.asarray(pale[0].get_ydata()) == pytest.approx(size)
    assert "without contact" in [t.get_text() for t in axes.get_legend().get_texts()]
    (left, right) = drawn["profiles.png"].axes
    # A polyline of both extremes for each structure and run; steps for drifts.
    towers = towers_of(view_of_run(buildings))
    assert len([line for line in left.get_lines() if line.get_marker() == "."]) == 4 * len(towers)
    assert len(right.patches) == 4 * len(towers)


def test_another_scene_is_refused(buildings):
    other = simulate(pounding_pair(), "fast", rtol=1e-6, duration=0.5)
    with pytest.raises(InputError, match="none of its bodies"):
        figures(buildings, (other, "elsewhere"))


def test_pi_terms(buildings):
    scales = buildings.scene.motion.scales()
    drawn = figures(buildings, (buildings.without_contact, "x"), pi=True)
    axes = panel(drawn["displacements.png"], "displacement")
    assert axes.get_ylabel() == "displacement ($L_e$)"
    (line,) = [x for x in axes.get_lines() if x.get_label() == "A1"]
    history = buildings.history
    assert np.asarray(line.get_ydata()) == pytest.approx(history["u.A1"] / scales.length)
    assert np.asarray(line.get_xdata()) == pytest.approx(history["t"] * scales.omega_g)
    assert panel(drawn["displacements.png"], "ground").get_ylabel().endswith("($a_g$)")
    loop = drawn["loops.png"].axes[0]
    assert (loop.get_xlabel(), loop.get_ylabel()) == ("elongation ($L_e$)", r"force ($m\,a_g$)")
    still = Scene((Body("a", 1.0, 0.1),), (Spring("s", (GROUND, "a"), Linear(9.0)),))
    with pytest.raises(InputError, match="Π-terms need a ground motion"):
        figures(simulate(still, "fast", duration=1.0), pi=True)


def test_towers(buildings):
    view = view_of_run(buildings)
    towers = towers_of(view)
    assert [tower.bodies[0] for tower in towers] == ["A1", "B1"]
    assert all(len(tower.storeys) == len(tower.bodies) for tower in towers)
    assert "drift" in "".join(a.get_ylabel() for a in figures(buildings)["displacements.png"].axes)
    # Decks that each stand on the ground, with a cable between them, have no storeys.
    pair = view_of_run(simulate(pounding_pair(), "fast", rtol=1e-6, duration=0.5))
    assert towers_of(pair) == []
    assert storeys_of(pair) == []
    assert "profiles.png" not in figures(pair.results)


def test_heights_make_drift_ratios(buildings):
    springs = tuple(replace(spring, height=3.0) for spring in buildings.scene.springs)
    scene = replace(buildings.scene, springs=springs)
    response = simulate(scene, "fast", rtol=1e-6, duration=buildings.task.end)
    drawn = figures(response)
    drifts = panel(drawn["displacements.png"], "drift").get_lines()
    assert {spring.name for spring in springs} <= {line.get_label() for line in drifts}
    left, right = drawn["profiles.png"].axes
    assert (left.get_ylabel(), right.get_xlabel()) == ("height (m)", "drift ratio (%)")
    first = right.patches[1].get_data()
    ratio = response.quantity(f"springs.{springs[0].name}.max_elongation")
    assert ratio is not None
    assert first.values[0] == pytest.approx(100.0 * ratio / 3.0)
    assert first.edges[:3] == pytest.approx([0.0, 3.0, 6.0])


def test_isolators_have_no_drift_ratio(tmp_path):
    case = load_case(write_template(tmp_path / "case", "isolated"))
    response = simulate(case, "fast", rtol=1e-6, duration=2.0)
    (tower,) = towers_of(view_of_run(response))
    assert tower.heights[0] == 0.0
    assert tower.levels[:2] == (0.0, 0.0)
    _, right = figures(response)["profiles.png"].axes
    assert right.get_xlabel() == "drift ratio (%)"
    values = right.patches[1].get_data().values
    assert np.isnan(values).tolist() == [True, *[False] * (len(tower.storeys) - 1)]
    drift = response.springs.loc[tower.storeys[1].name, "max_elongation"]
    assert values[1] == pytest.approx(100.0 * drift / tower.heights[1])


def far(points: np.ndarray, line: np.ndarray) -> float:
    """Largest distance of points from a polyline."""
    start, along = line[:-1], np.diff(line, axis=0)
    length = (along**2).sum(axis=1) + 1e-300
    worst = 0.0
    for point in points:
        part = np.clip(((point - start) * along).sum(axis=1) / length, 0.0, 1.0)
        away = start + part[:, None] * along - point
        worst = max(worst, float(np.sqrt((away**2).sum(axis=1).min())))
    return worst


PAIR, SOIL = pounding_pair(), load_case(CASES / "deck-on-backfill").scene


@pytest.mark.parametrize(
    ("scene", "spring", "solver"), [*((PAIR, i, "fast") for i in range(3)), (SOIL, 2, "cvode")]
)
def test_loops_between_coarse_rows(scene, spring, solver):
    coarse = simulate(scene, solver, 1e-9, duration=5.0, output_step=0.05)
    fine = simulate(scene, solver, 1e-9, duration=5.0, output_step=0.001)
    view, dense = view_of_run(coarse), view_of_run(fine)
    drawn = view.springs[spring]
    true = np.stack([dense.elongation(drawn), dense.column(f"force.{drawn.name}")], axis=1)
    size = np.ptp(true, axis=0)
    loop = np.stack(view.loop(drawn), axis=1)
    polygon = np.stack([view.elongation(drawn), view.column(f"force.{drawn.name}")], axis=1)
    # A twentieth of a second between rows cuts knees by two hundredths of the loop, soil by one.
    assert far(true[::7] / size, polygon / size) > 5e-3
    assert far(true[::7] / size, loop / size) < 1e-3
    assert far(loop / size, true / size) < 1e-3


def test_commands(tmp_path, capsys):
    folder = tmp_path / "pair"
    shutil.copytree(CASES / "pair", folder)
    assert main(["run", str(folder), "--no-figures"]) == 0
    out, seen = folder / "results", set()
    for words in ([], ["--without-contact"], ["--pi"], ["--beside", str(out), "--xlim", "0.5,2"]):
        assert main(["plot", str(folder), "--dpi", "30", *words]) == 0
        seen.add((out / "displacements.png").read_bytes())
    assert len(seen) == 4
    assert main(["plot", str(folder), "--beside", str(out), "--without-contact"]) == 2
    assert "accepted: one of them" in capsys.readouterr().err
    assert main(["plot", str(folder), "--beside", str(tmp_path)]) == 2


def test_run_draws_what_it_computed_without_contact(tmp_path):
    folder = tmp_path / "pair"
    shutil.copytree(CASES / "pair", folder)
    case = folder / "case.toml"
    text = case.read_text()
    assert main(["run", str(folder)]) == 0
    before = (folder / "results" / "displacements.png").read_bytes()
    assert "[run]" not in text
    case.write_text(text + "\n[run]\nwithout_contact = true\n")
    assert main(["run", str(folder)]) == 0
    assert (folder / "results" / "displacements.png").read_bytes() != before


def test_stored_results_have_the_loops_of_the_response(buildings):
    case = load_case(CASES / "pair")
    response = simulate(case, "fast", rtol=1e-6)
    stored = view_of_run(gather(response, case))
    assert stored.scene is not None
    own = view_of_run(response)
    for spring in own.springs:
        assert stored.loop(spring)[1] == pytest.approx(own.loop(spring)[1])
