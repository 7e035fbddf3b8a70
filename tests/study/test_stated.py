"""Options of ``[run]`` times ways to run a case: each holds, is refused by name, or is said."""

import json
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eventpound import (
    Case,
    Study,
    compare,
    load_case,
    simulate,
    simulate_many,
    simulate_suite,
    verify,
)
from eventpound.basics.told import OptionWarning
from eventpound.case.run_options import Way, options
from eventpound.cli import main
from eventpound.errors import InputError
from eventpound.results import export
from eventpound.study.fragility import fragility_table
from eventpound.study.reading import load_study
from tests.models import ROOT
from tests.study.test_suite import CASE, time_series

DASHPOT = """\
[[dashpot]]
between = ["ground", "deck"]
coefficient = "100 kN s/m"
"""
OPTIONS = {
    "start_time": ('start_time = "2 s"', "peaks.deck.abs_max"),
    "duration": ('duration = "4.5 s"', "t_final"),
    "energy": ("energy = true", "energy.impact"),
    "quantities": ('quantities = ["velocity.deck.abs_max"]', "velocity.deck.abs_max"),
    "without_contact": ("without_contact = true", "amplification.deck"),
    "contact_stiffness": ('contact_stiffness = "50 MN/m"', "contacts.joint.estimated_force"),
    "threshold_speed": ('threshold_speed = "20 cm/s"', "contacts.joint.impacts_faster"),
    "avoiding_gap": ("avoiding_gap = true", "contacts.joint.avoiding_gap"),
}
"""Each with a column that tells whether it held."""
KEY, GAPS = "contact.joint.gap", [0.0127, 0.02]
ALSO = ["peaks.deck.abs_max", "t_final"]
AXIS = f'[[study.axis]]\nkey = "{KEY}"\nvalues = {GAPS}\n'
RTOL = 1e-9


def written(folder: Path, option: str, record: str = 'file = "a.txt"', tables: str = "") -> Path:
    (folder / "a.txt").write_text(time_series(0.5))
    read = f'{record}\nunits = "g"\ntime_step = "0.02 s"'
    more = f'[solver]\nname = "fast"\n{tables}\n[run]\n{option}\n'
    (folder / "case.toml").write_text(CASE.format(read) + DASHPOT + more)
    return folder


def study(tables: str = AXIS) -> str:
    return f"[study]\nquantities = {json.dumps(ALSO)}\n{tables}"


def by_command(folder: Path, option: str, column: str) -> list[float]:
    assert main(["run", str(written(folder, option)), "--no-figures"]) == 0
    found = json.loads((folder / "results" / "summary.json").read_text())
    before, _, last = column.rpartition(".")
    for key in [*before.split("."), last] if before else [last]:
        found = found[key]
    return [found]


def by_study(folder: Path, option: str, column: str, tables: str) -> list[float]:
    assert main(["study", str(written(folder, option, tables=tables)), "--no-figures"]) == 0
    return list(pd.read_csv(folder / "results" / "study.csv")[column])


def by_product(folder: Path, option: str, column: str) -> list[float]:
    return by_study(folder, option, column, study())


def by_zip(folder: Path, option: str, column: str) -> list[float]:
    other = '[[study.axis]]\nkey = "contact.joint.restitution"\nvalues = [0.7, 0.7]\nzip = "j"\n'
    return by_study(folder, option, column, study(f'{AXIS}zip = "j"\n{other}'))


def by_records(folder: Path, option: str, column: str) -> list[float]:
    return by_study(folder, option, column, study(f'records = "a.txt"\n{AXIS}'))


def by_study_in_python(folder: Path, option: str, column: str) -> list[float]:
    case = load_case(written(folder, option))
    return list(Study(case, {KEY: GAPS}, quantities=ALSO, rtol=RTOL).run()[column])


def by_many(folder: Path, option: str, column: str) -> list[float]:
    case = load_case(written(folder, option))
    return list(simulate_many(case, {KEY: GAPS}, rtol=RTOL).table[column])


def by_suite(folder: Path, option: str, column: str) -> list[float]:
    assert main(["run", str(written(folder, option, 'suite = "a.txt"')), "--no-figures"]) == 0
    return list(pd.read_csv(folder / "results" / "suite.csv")[column])


def by_suite_in_python(folder: Path, option: str, column: str) -> list[float]:
    case = load_case(written(folder, option, 'suite = "a.txt"'))
    kept: list[float] = []
    table = simulate_suite(case, keep=lambda _n, _c, r: kept.append(r.summary[column]))
    assert kept == list(table[column])
    return kept


def by_simulate(folder: Path, option: str, column: str) -> list[float]:
    case = load_case(written(folder, option))
    return [simulate(case, error_estimate=False).summary[column]]


Ran = Callable[[Path, str, str], list[float]]
WAYS: dict[str, tuple[Ran, ...]] = {
    "run": (by_command,),
    "suite": (by_suite, by_suite_in_python),
    "study": (by_product, by_zip, by_records, by_study_in_python),
    "simulate": (by_simulate,),
    "simulate_many": (by_many,),
}
"""By the heads of the columns of the page."""


def cells() -> dict[tuple[str, str], str]:
    """What the page says of each option in each way to run."""
    page = (ROOT / "docs" / "case-format.md").read_text()
    table = page.partition("| option | `run` |")[2].partition("\n\n")[0].splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table[2:]]
    return {
        (option, way): word
        for options, *words in rows
        for option in re.findall(r"\w+", options)
        for way, word in zip(WAYS, words, strict=True)
    }


CELLS = cells()


def with_word(word: str, options: Iterable[str]) -> list[tuple[str, Ran]]:
    pairs = [pair for pair, said in CELLS.items() if said == word and pair[0] in options]
    return [(option, way) for option, name in pairs for way in WAYS[name]]


@pytest.mark.parametrize(("option", "way"), with_word("same", OPTIONS))
def test_an_option_is_the_same_in_every_way_to_run(tmp_path, way, option):
    line, column = OPTIONS[option]
    found = way(tmp_path, line, column)
    case = load_case(written(tmp_path, line))
    for gap, value in zip(GAPS, found, strict=False):
        contacts = tuple(replace(each, gap=gap) for each in case.scene.contacts)
        one = replace(case, scene=replace(case.scene, contacts=contacts))
        alone = simulate(one, rtol=RTOL, error_estimate=False).summary[column]
        # A ratio of two peaks may be one of their Π-terms.
        assert value == pytest.approx(alone, rel=1e-14)
    plain = simulate(load_case(written(tmp_path, "")), rtol=RTOL, error_estimate=False)
    assert column not in plain.summary or plain.summary[column] != found[0]


UNITS = 'units = ["MN", "cm"]'
PUSHED = '\n[[force]]\nbody = "deck"\nvalue = "500 kN"'
OF_A_RUN = {
    "start": (f'start = "equilibrium"{PUSHED}', f'start = "initial"{PUSHED}'),
    "output_step": ('output_step = "0.1 s"', ""),
    "error_estimate": ("error_estimate = true", "error_estimate = false"),
}
"""Options without a column, each beside another value of its own."""


def told(name: str, folder: Path, option: str) -> dict[str, object]:
    """What a run tells of each of those options."""
    if name == "run":
        by_command(folder, option, "t_final")
        history = pd.read_csv(folder / "results" / "history.csv")
        estimate = json.loads((folder / "results" / "summary.json").read_text())["error_estimate"]
    elif name == "simulate":
        response = simulate(load_case(written(folder, option)))
        history, estimate = response.history, response.error_estimate
    else:
        kept: list[pd.DataFrame] = []
        case = load_case(written(folder, option, 'suite = "a.txt"'))
        table = simulate_suite(case, keep=lambda _n, _c, r: kept.append(r.history))
        history, estimate = kept[0], table.get("error_estimate")
    start = history["u.deck"].iloc[0]
    return {"start": start, "output_step": len(history), "error_estimate": estimate is not None}


@pytest.mark.parametrize(
    ("option", "name"), [p for p, said in CELLS.items() if p[0] in OF_A_RUN and said == "same"]
)
def test_an_option_without_a_column_is_the_same_in_every_way(tmp_path, name, option):
    found, other = (told(name, tmp_path, lines)[option] for lines in OF_A_RUN[option])
    expected = {"start": 5e5 / 233443e3, "output_step": found, "error_estimate": True}[option]
    assert found == pytest.approx(expected, rel=1e-9)
    assert other != found


@pytest.mark.parametrize(("option", "way"), with_word("refused", OF_A_RUN))
def test_an_option_is_refused_before_anything_runs(tmp_path, way, option, capsys):
    try:
        way(tmp_path, OF_A_RUN[option][0], "t_final")
    except InputError as error:
        said = str(error)
    except AssertionError:
        said = capsys.readouterr().err
    assert f"[run]: {option}: not for " in said
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize(("option", "way"), with_word("none", OF_A_RUN))
def test_an_option_changes_nothing(tmp_path, way, option):
    found, other = (way(tmp_path, lines, "peaks.deck.abs_max") for lines in OF_A_RUN[option])
    assert found == other


def test_a_study_in_pi_terms_has_their_columns_too(tmp_path):
    text = '[excitation]\nkind = "sine"\n[pi]\nstructure = "elastic"\ndelta = 0.1\nepsilon = 0.5\n'
    axis = 'quantities = ["pi_um"]\n[[study.axis]]\nkey = "pi.omega_s"\nvalues = [0.5, 1.5]\n'
    (tmp_path / "case.toml").write_text(f"{text}[study]\n{axis}[run]\navoiding_gap = true\n")
    assert main(["study", str(tmp_path)]) == 0
    table = pd.read_csv(tmp_path / "results" / "study.csv")
    gaps = table.filter(like="avoiding_gap").to_numpy()[:, 0]
    for omega, gap in zip([0.5, 1.5], gaps, strict=True):
        alone = text.replace("delta", f"omega_s = {omega}\ndelta")
        (tmp_path / "case.toml").write_text(alone)
        scene = load_case(tmp_path).scene
        names = scene.contacts[0].name
        one = simulate(load_case(tmp_path), "fast", error_estimate=False)
        assert gap == pytest.approx(one.quantity(f"contacts.{names}.avoiding_gap"), rel=1e-12)
        assert gap > 0.1


def test_a_curve_of_fragility_over_the_gap_that_avoids_contact(tmp_path):
    folder = written(tmp_path, "avoiding_gap = true", 'suite = "?.txt"')
    for name, amplitude in zip("abcdef", (0.2, 0.25, 0.4, 0.35, 0.6, 0.8), strict=True):
        (folder / f"{name}.txt").write_text(time_series(amplitude))
    table, column = simulate_suite(load_case(folder)), "contacts.joint.avoiding_gap"
    curve = fragility_table(table, "PGA", column, [table[column].median()], None)
    assert curve["exceeded"].tolist() == [3]


def test_an_equilibrium_that_no_number_moves_holds_in_a_study(tmp_path):
    case = load_case(written(tmp_path, 'start = "equilibrium"'))
    assert Study(case, {"excitation.scale": [1.0, 2.0]}).plan.size == 2


def test_a_study_says_that_it_keeps_no_rows_and_tells_nothing_in_units(tmp_path):
    folder = written(tmp_path, f'output_step = "0.1 s"\n{UNITS}', tables=study())
    said = "output_step, units: no part of a study"
    assert any(said in text for text in load_study(folder).warnings)


@pytest.mark.parametrize(
    "option", [*(name for name in OPTIONS if name not in ("start_time", "duration")), "units"]
)
@pytest.mark.parametrize("way", [Way.VERIFY, Way.COMPARE, Way.EXPORT, Way.FLOOR])
def test_what_other_commands_leave_out_is_said(tmp_path, way, option):
    """Here a warning is an error, so that nothing is computed."""
    case = load_case(written(tmp_path, UNITS if option == "units" else OPTIONS[option][0]))
    calls: dict[Way, Callable[[], object]] = {
        Way.VERIFY: lambda: verify(case),
        Way.COMPARE: lambda: compare(case, ["fast"]),
        Way.EXPORT: lambda: export(case, tmp_path / "export"),
        Way.FLOOR: lambda: main(["floor-spectrum", str(tmp_path), "deck"]),
    }
    with pytest.raises(OptionWarning, match=rf"\[run\]: {option}: no part of {way}"):
        calls[way]()
    assert way not in dict(options())[option].holds


@pytest.mark.parametrize("option", ["contact_stiffness", "avoiding_gap", "threshold_speed"])
def test_an_option_of_contacts_is_refused_where_there_are_none(tmp_path, option, capsys):
    folder = written(tmp_path, OPTIONS[option][0])
    text = (folder / "case.toml").read_text()
    before, after = text.split("[[contact]]")
    (folder / "case.toml").write_text(before + "[solver]" + after.partition("[solver]")[2])
    assert main(["run", str(folder)]) == 2
    said = capsys.readouterr().err
    assert f"case.toml: [run]: {option}: needs a contact, and there is none" in said
    assert not (folder / "results").exists()
    with pytest.raises(InputError, match=f"^{option}: needs a contact"):
        simulate(load_case(folder))


def test_an_estimated_force_needs_the_stiffness(tmp_path):
    name = "contacts.joint.estimated_force"
    case = load_case(written(tmp_path, ""))
    calls: list[Callable[[Case], object]] = [
        lambda case: simulate(case, "fast", error_estimate=False).quantity(name),
        lambda case: simulate_many(case, {KEY: GAPS}, quantities=[name]),
        lambda case: Study(case, {KEY: GAPS}, quantities=[name]),
    ]
    for call in calls:
        with pytest.raises(InputError, match=f"'{name}' needs contact_stiffness"):
            call(case)
    tables = study().replace(ALSO[0], name)
    with pytest.raises(InputError, match=rf"\[study\]: quantities: '{name}' needs contact_stiff"):
        load_study(written(tmp_path, "", tables=tables))


def test_without_contact_goes_with_quantities_of_contacts(tmp_path):
    """The same without contact has no such quantities: it was refused when all was computed."""
    option = 'without_contact = true\ncontact_stiffness = "50 MN/m"\n'
    option += 'quantities = ["contacts.joint.largest_gap"]'
    folder = written(tmp_path, option)
    assert main(["run", str(folder)]) == 0
    assert (folder / "results" / "displacements.png").is_file()
    assert main(["plot", str(folder), "--without-contact"]) == 0
    free = simulate(load_case(folder), error_estimate=False).without_contact
    assert np.isfinite(free.summary["peaks.deck.max"])


def test_columns_of_parts_that_differ_in_their_contacts(tmp_path):
    """An option holds where one part has something for it; the cells of the others are empty."""
    part = '[[study.part]]\nname = "{}"\n{}\n'
    parts = part.format("with", "") + part.format("without", "contact = []")
    axis = '[[study.part.axis]]\nkey = "excitation.scale"\nvalues = [1.0]\n'
    tables = study(parts.replace("\n\n", f"\n{axis}") + axis)
    folder = written(tmp_path, OPTIONS["avoiding_gap"][0], tables=tables)
    assert main(["study", str(folder)]) == 0
    gaps = pd.read_csv(folder / "results" / "study.csv")["contacts.joint.avoiding_gap"]
    assert gaps.isna().tolist() == [False, True]
