"""What was understood of a case, as tables and lines to be read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from eventpound.results.shown_units import HEAVY, PERCENT, Unit, Units
from eventpound.results.tables import Cells, headed
from eventpound.scene.point import Point
from eventpound.units import Dimension

_MOST_ROWS, _MOST_DASHPOTS = 40, 12
"""Rows of a table that are shown; modal damping alone makes a dashpot for every two bodies."""
_MOST_MODES = 5
"""Modes of a structure that are shown."""
_APART = "compression", "friction", "F_ult"
"""Numbers of springs that have a table of their own: they share hardly one with others."""
_AT_REST = {
    "counts": "springs that count in modes, T1 and damping: {}",
    "not": "springs that do not: {}",
    "at_kink": "at a kink (the smaller stiffness counts, so that no period is too short): {}",
    "at_yield": "at yield (as they unload, with which a small motion goes on): {}",
}
"""What is said of springs at rest, by the keys of the inputs."""
_Column = tuple[str, str, str]
"""Key, heading and kind of unit of a column."""


def _columns(text: str) -> tuple[_Column, ...]:
    """Columns of a table, ``key=heading:kind of unit`` each; the key is the heading by default."""
    found = []
    for word in text.split("; "):
        named, _, unit = word.partition(":")
        key, _, heading = named.partition("=")
        found.append((key, heading or key, unit))
    return tuple(found)


_TABLES: dict[str, tuple[_Column, ...]] = {
    kind: _columns(text)
    for kind, text in (
        (
            "decks",
            "name=deck; mass:mass; weight:force; long=length (m); wide=width (m); "
            "skew=skew (degrees); x=x (m); y=y (m); inertia=J (kg m^2); radius=r (m)",
        ),
        ("bodies", "name=body; mass:mass; weight:force; source"),
        (
            "springs",
            "name=spring; between; law; height:length; weight=P:force; theta; K0:stiffness; "
            "K_s:stiffness; F_y:force; Q:force; u_y:length; alpha; friction; N:force; "
            "T_slip=T slip:s; F_ult:force; R_f; y_ult=y at F_ult:length; gap:length; "
            "compression:stiffness; extension:stiffness; offset:length; "
            "at_rest=k at rest:stiffness; mass=mass on it:mass; F_y/W; T_initial=T initial:s; "
            "T_post_yield=T post-yield:s; source",
        ),
        ("frames", "name=frame; couplings; held=to what it stands on"),
        (
            "dashpots",
            "between=dashpot; coefficient=c:damping; ratio_initial=of critical, initial:%; "
            "ratio_post_yield=post-yield:%",
        ),
        (
            "contacts",
            "name=contact; between; gap:length; law; stiffness=k (SI); restitution; "
            "friction; damping; "
            "c:damping; effective_mass=mass:mass; source",
        ),
        (
            "supports",
            "name=support; kind=motion; delay:s; suite=records; a_g:m/s^2; period=T_g:s; "
            "s_end=s at the end:length; sv_end=s' at the end:m/s",
        ),
        ("forces", "body=force on; kind; peak=largest:force; peak/m=over the mass:m/s^2"),
    )
}


def input_tables(inputs: Mapping[str, Any], chosen: tuple[str, ...] = ()) -> Iterator[Cells]:
    """Tables of the parts of a case and of its modes; those that it does not have are left out.

    Parameters
    ----------
    inputs : mapping
        As `eventpound.results.inputs.inputs_of` gives them.
    chosen : tuple of str
        Units of a `Units`.
    """
    massive = [*inputs["bodies"], *inputs.get("decks", [])]
    heavy = max((row["mass"] for row in massive), default=0.0) >= HEAVY
    units = _units(Units(heavy, chosen))
    for kind, columns in _TABLES.items():
        given = inputs.get(kind, [])
        if kind == "springs":
            # Numbers without a unit that a law alone has, by their names.
            known = {key for key, _, _ in columns}
            own = dict.fromkeys(key for row in given for key in row if key not in known)
            columns += tuple((key, key, "") for key in own)
        tables: dict[str, list[Mapping[str, Any]]] = {own: [] for own in ("", *_APART)}
        for row in given:
            tables[next((own for own in _APART if own in row), "")].append(row)
        most = _MOST_DASHPOTS if kind == "dashpots" else _MOST_ROWS
        yield from (_cells(rows, columns, units, most) for rows in tables.values() if rows)
    for structure in inputs["structures"]:
        if "initial" in structure:
            yield _modes(structure)


def _units(shown: Units) -> dict[str, Unit]:
    """Units by their kinds; where none is chosen, lengths of what is light are in m."""
    kinds = {"mass": Dimension.MASS, "force": Dimension.FORCE, "stiffness": Dimension.STIFFNESS}
    kinds |= {"damping": Dimension.DAMPING}
    if shown.heavy or shown.chosen:
        kinds["length"] = Dimension.LENGTH
    if shown.chosen:
        kinds["m/s^2"] = Dimension.ACCELERATION
    found = {kind: shown.unit(dimension.unit) for kind, dimension in kinds.items()}
    return {"length": Unit("m", 1.0), "%": PERCENT} | found


def _cells(
    rows: Sequence[Mapping[str, Any]],
    columns: Sequence[_Column],
    units: Mapping[str, Unit],
    most: int = _MOST_ROWS,
) -> Cells:
    """A table without the columns that no row has."""
    there = [column for column in columns if any(row.get(column[0]) is not None for row in rows)]
    shown = [units.get(unit, Unit(unit, 1.0)) for _, _, unit in there]
    heads = [headed(head, unit.name) for (_, head, _), unit in zip(there, shown, strict=True)]
    cells = tuple(
        tuple(_cell(row.get(key), of.size) for (key, *_), of in zip(there, shown, strict=True))
        for row in rows[:most]
    )
    words = tuple(
        all(isinstance(row.get(key), str | list | None) for row in rows) for key, _, _ in there
    )
    return Cells(tuple(heads), cells, words, max(0, len(rows) - most))


def _cell(value: object, size: float) -> str:
    if value is None:
        return ""
    if isinstance(value, list):
        return " - ".join(map(_end, value))
    return f"{value / size:.5g}" if isinstance(value, float | int) else str(value)


def _end(end: object) -> str:
    """An end, as `eventpound.scene.ends.written` has it."""
    if not isinstance(end, dict):
        return str(end)
    if "deck" not in end:
        return f"({Point(end)})"
    x, y = end["at"]
    return f"{end['deck']} at ({x:.5g}, {y:.5g}) m"


def _modes(structure: Mapping[str, Any]) -> Cells:
    """Modes of a structure before and after its springs yield, side by side."""
    initial, later = structure["initial"], structure.get("post_yield")
    rows = []
    for number, mode in enumerate(initial[:_MOST_MODES], 1):
        row = {"number": str(number), **mode}
        if later:
            row |= {f"{key}.later": value for key, value in later[number - 1].items()}
        rows.append(row)
    along = "mass along" if "share_across" in initial[0] else "mass"
    columns: list[_Column] = [("number", "mode of " + _some(structure["bodies"]), "")]
    for suffix, head in (("", "T initial"), (".later", "T post-yield")):
        columns += [
            (f"period{suffix}", head, "s"),
            (f"share{suffix}", along, "%"),
            (f"share_across{suffix}", "mass across", "%"),
            (f"damping{suffix}", "damping", "%"),
        ]
    cells = _cells(rows, columns, {"%": PERCENT})
    return Cells(cells.headings, cells.rows, cells.words, max(0, len(initial) - _MOST_MODES))


def _some(names: Sequence[str]) -> str:
    return ", ".join(names if len(names) <= 4 else [*names[:2], "...", names[-1]])


def input_lines(inputs: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What is no table: springs at rest, motion, run, Π-terms, solver; each with its word."""
    if said := rest_words(inputs["at_rest"]):
        yield "at rest", said
    yield from _motion_lines(inputs)
    if inputs["pi"]:
        number = inputs["pi_number"]
        count = "" if number is None else f", {number} with the peak's"
        terms = ", ".join(f"{key} = {value:.4g}" for key, value in inputs["pi"].items())
        yield "Pi-terms", f"dimensionless numbers{count}: {terms}"
    solver = inputs["solver"]
    settings = "".join(
        f", {key} = {value}" for key, value in solver.items() if key not in ("name", "rtol")
    )
    yield "solver", f"{solver['name']}, rtol {solver['rtol']:g}{settings}"


def rest_words(told: Mapping[str, Sequence[str]]) -> str:
    """What is said of springs at rest (`eventpound.scene.at_rest.springs_at_rest`)."""
    listed = {key: _some(names) for key, names in told.items() if names}
    return "; ".join(_AT_REST[key].format(names) for key, names in listed.items())


def _of_motion(motion: Mapping[str, Any]) -> str:
    """A component of the ground motion."""
    if "suite" in motion:
        return f"{motion['suite']} records, one beside each of the first component"
    sizes = ""
    if "a_g" in motion:
        sizes = f", a_g = {motion['a_g']:.6g} m/s^2 ({motion['a_g/g']:.4g} g)"
    if "period" in motion:
        length = f"length scale L_e = a_g (T_g / 2 pi)^2 = {motion['L_e']:.5g} m"
        sizes += f", T_g = {motion['period']:.6g} s, {length}"
    if "time_step" in motion:
        sizes += f", {motion['samples']} samples every {motion['time_step']:g} s"
    if "begins" in motion:
        sizes += f", records from {', '.join(f'{begin:.6g}' for begin in motion['begins'])} s on"
    return f"{motion['kind']}{sizes}"


def _second_lines(inputs: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """The second component, where there may be one."""
    if "across" in inputs:
        second = inputs["across"]
        file = f"; {second['file']}" if "file" in second else ""
        yield "across", f"{_of_motion(second)}{file}; attack = {second['attack']:g} deg"


def _motion_lines(inputs: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """The ground motion, or how many there are, and the run."""
    motion, run = inputs["motion"], inputs["run"]
    if "suite" in motion:
        yield "suite", f"{motion['suite']} records, a run each"
        if "scaling" in motion:
            yield "scaling", str(motion["scaling"])
        yield from _second_lines(inputs)
        return
    yield "motion", _of_motion(motion)
    if "file" in motion:
        said = (motion.get(key) for key in ("event", "date", "station", "component"))
        yield "record", ", ".join([motion["file"], *filter(None, said)])
    yield from _second_lines(inputs)
    length = f"from {run['start']:g} s, as long as each motion says"
    if "duration" in run:
        length = f"{run['start']:g} to {run['start'] + run['duration']:.6g} s"
    rows = f", a row every {run['output_step']:.6g} s" if "output_step" in run else ""
    yield "run", length + rows
