"""``eventpound check``: read a case and show what was understood."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from eventpound.cli.arguments import (
    Commands,
    add_case,
    add_command,
    check_solver_of,
    load,
    show_warnings,
)

_MOST_ROWS = 40
"""Rows of a table that are shown."""
_MOST_MODES = 5
"""Modes of a structure that are shown."""
_HEAVY = 1e4
"""Mass (kg) from which on tables are in t, kN and mm."""
_Column = tuple[str, str, str]
"""Key, heading and kind of unit of a column."""
_SIZES: dict[bool, dict[str, tuple[str, float]]] = {
    True: {
        "mass": ("t", 1e3),
        "force": ("kN", 1e3),
        "stiffness": ("kN/m", 1e3),
        "damping": ("kN s/m", 1e3),
        "length": ("mm", 1e-3),
    },
    False: {
        "mass": ("kg", 1.0),
        "force": ("N", 1.0),
        "stiffness": ("N/m", 1.0),
        "damping": ("N s/m", 1.0),
        "length": ("m", 1.0),
    },
}
_TABLES: dict[str, tuple[_Column, ...]] = {
    "bodies": (("name", "body", ""), ("mass", "mass", "mass"), ("weight", "weight", "force")),
    "springs": (
        ("name", "spring", ""),
        ("between", "between", ""),
        ("law", "law", ""),
        ("height", "height", "length"),
        ("K0", "K0", "stiffness"),
        ("K_s", "K_s", "stiffness"),
        ("F_y", "F_y", "force"),
        ("Q", "Q", "force"),
        ("u_y", "u_y", "length"),
        ("alpha", "alpha", ""),
        ("compression", "compression", "stiffness"),
        ("extension", "extension", "stiffness"),
        ("offset", "offset", "length"),
        ("mass", "mass on it", "mass"),
        ("F_y/W", "F_y/W", ""),
        ("T_initial", "T initial", "s"),
        ("T_post_yield", "T post-yield", "s"),
    ),
    "dashpots": (
        ("between", "dashpot", ""),
        ("coefficient", "c", "damping"),
        ("ratio_initial", "of critical, initial", "%"),
        ("ratio_post_yield", "post-yield", "%"),
    ),
    "contacts": (
        ("name", "contact", ""),
        ("between", "between", ""),
        ("gap", "gap", "length"),
        ("restitution", "restitution", ""),
    ),
}


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "read a case and show what was understood or is wrong"
    check = add_command(commands, "check", _check, text)
    add_case(check)
    check.add_argument("--json", action="store_true", help="as JSON, SI")


def _check(options: argparse.Namespace) -> int:
    from eventpound.case.loading import read_document

    if "study" in read_document(options.case)[0]:
        return _check_study(options.case)
    case = load(options.case)
    check_solver_of(case)
    from eventpound.results.inputs import inputs_of

    inputs = inputs_of(case)
    if options.json:
        from eventpound.results.jsontext import to_json

        sys.stdout.write(to_json(inputs).decode())
        return 0
    print(f"case      {inputs['title']}")
    for line in _lines(inputs):
        print(line)
    return 0


def _lines(inputs: Mapping[str, Any]) -> Iterator[str]:
    """What was understood, to be read."""
    heavy = max((row["mass"] for row in inputs["bodies"]), default=0.0) >= _HEAVY
    for kind, columns in _TABLES.items():
        # Springs with a kink have a table of their own: they share no number with others.
        kinked = [row for row in inputs[kind] if "compression" in row]
        for rows in ([row for row in inputs[kind] if row not in kinked], kinked):
            if rows:
                yield ""
                yield from table_lines(rows, columns, heavy)
    for structure in inputs["structures"]:
        yield from _mode_lines(structure)
    yield ""
    yield from _motion_lines(inputs)
    if inputs["pi"]:
        terms = ", ".join(f"{key} = {value:.4g}" for key, value in inputs["pi"].items())
        yield f"Pi-terms  {terms}"
    solver = inputs["solver"]
    settings = "".join(
        f", {key} = {value}" for key, value in solver.items() if key not in ("name", "rtol")
    )
    yield f"solver    {solver['name']}, rtol {solver['rtol']:g}{settings}"


def table_lines(
    rows: Sequence[Mapping[str, Any]], columns: Sequence[_Column], heavy: bool
) -> Iterator[str]:
    """A table in columns as wide as they need; those that no row has are left out."""
    there = [column for column in columns if any(row.get(column[0]) is not None for row in rows)]
    sizes = _SIZES[heavy]
    heads = []
    for _, head, unit in there:
        name = sizes[unit][0] if unit in sizes else unit
        heads.append(f"{head} ({name})" if name else head)
    cells = [
        [_cell(row.get(key), sizes.get(unit, ("", 0.01 if unit == "%" else 1.0))[1])
         for key, _, unit in there]
        for row in rows[:_MOST_ROWS]
    ]  # fmt: skip
    widths = [max(map(len, column)) for column in zip(heads, *cells, strict=True)]
    words = [
        all(isinstance(row.get(key), str | list | None) for row in rows) for key, _, _ in there
    ]
    for line in (heads, *cells):
        parts = [
            text.ljust(width) if word else text.rjust(width)
            for text, width, word in zip(line, widths, words, strict=True)
        ]
        yield "  ".join(parts).rstrip()
    if len(rows) > _MOST_ROWS:
        yield f"and {len(rows) - _MOST_ROWS} more"


def _cell(value: object, size: float) -> str:
    if value is None:
        return ""
    if isinstance(value, list):
        return " - ".join(map(str, value))
    return f"{value / size:.5g}" if isinstance(value, float | int) else str(value)


def _mode_lines(structure: Mapping[str, Any]) -> Iterator[str]:
    """Modes of a structure before and after its springs yield, side by side."""
    if "initial" not in structure:
        return
    initial, later = structure["initial"], structure.get("post_yield")
    rows = []
    for number, mode in enumerate(initial[:_MOST_MODES], 1):
        row = {"number": str(number), **mode}
        if later:
            row |= {f"{key}.later": value for key, value in later[number - 1].items()}
        rows.append(row)
    columns: list[_Column] = [
        ("number", "mode of " + _some(structure["bodies"]), ""),
        ("period", "T initial", "s"),
        ("share", "mass", "%"),
        ("damping", "damping", "%"),
        ("period.later", "T post-yield", "s"),
        ("share.later", "mass", "%"),
        ("damping.later", "damping", "%"),
    ]
    yield ""
    yield from table_lines(rows, columns, heavy=True)
    if len(initial) > _MOST_MODES:
        yield f"and {len(initial) - _MOST_MODES} more"


def _some(names: Sequence[str]) -> str:
    return ", ".join(names if len(names) <= 4 else [*names[:2], "...", names[-1]])


def _motion_lines(inputs: Mapping[str, Any]) -> Iterator[str]:
    """The ground motion, or how many there are, and the run."""
    motion, run = inputs["motion"], inputs["run"]
    if "suite" in motion:
        yield f"suite     {motion['suite']} records, a run each"
        if "scaling" in motion:
            yield f"scaling   {motion['scaling']}"
        return
    sizes = ""
    if "a_g" in motion:
        sizes = (
            f", a_g = {motion['a_g']:.6g} m/s^2 ({motion['a_g/g']:.4g} g), "
            f"T_g = {motion['period']:.6g} s, L_e = {motion['L_e']:.5g} m"
        )
    if "time_step" in motion:
        sizes += f", {motion['samples']} samples every {motion['time_step']:g} s"
    yield f"motion    {motion['kind']}{sizes}"
    yield (
        f"run       {run['start']:g} to {run['start'] + run['duration']:.6g} s, "
        f"a row every {run['output_step']:.6g} s"
    )


def _check_study(path: Path) -> int:
    """Say what was understood of a case with a [study]."""
    from eventpound.study.reading import load_study

    case = load_study(path)
    study = case.study
    show_warnings(case.warnings)
    print(f"study     {study.title}")
    print(f"runs      {study.size} of {len(study.bases)} scenes, {study.chunk_size} a chunk")
    print(f"axes      {', '.join(study.columns)}")
    print(f"tabulates {', '.join(study.quantities)}")
    print(f"solver    {study.solver}, rtol {study.rtol:g}")
    return 0
