"""Read a case and show what was understood or is wrong; list its quantities.

Examples
--------
  eventpound check pulse
  eventpound check pulse --json
  eventpound check pulse --quantities     names of all numbers that a run of the case gives
  eventpound check --quantities           the list of all quantities, with their units
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command

if TYPE_CHECKING:
    from eventpound.study.reading import StudyCase


def add_check(commands: Commands) -> None:
    """Add the command to the parser."""
    check = add_command(commands, "check", _check, __doc__)
    check.case(nargs="?")
    check.option("--json", "as JSON, SI")
    check.option("--quantities", "list the quantities of the case, or without one all there are")


def _check(options: Options) -> int:
    if options.quantities:
        options.refuse(["--json"], "is not for --quantities")
        return _list_quantities(options.case)
    if options.case is None:
        options.parser.error("the following arguments are required: CASE")
    from eventpound.study.kinds import Holds, kind_of

    if kind_of(options.case)[0] is Holds.STUDY:
        options.refuse(["--json"], "is for the case of a single run or of a suite, not of a study")
        return _check_study(arguments.loaded_study(options.case))
    case = arguments.loaded_case(options.case)
    arguments.check_solver_of(case)
    if case.suite is not None:
        arguments.complain_of_scales(case)
    from eventpound.results.input_tables import input_lines
    from eventpound.results.inputs import inputs_of

    inputs = inputs_of(case)
    if options.json:
        from eventpound.results.jsontext import to_json

        sys.stdout.write(to_json(inputs).decode())
        return 0
    print(f"case      {inputs['title']}")
    print("\n".join(_tables(inputs)), end="\n\n")
    for word, text in input_lines(inputs):
        print(f"{word:<9} {text}")
    return 0


def _tables(inputs: Mapping[str, Any]) -> Iterator[str]:
    """Bodies, what joins them, and modes, to be read."""
    from eventpound.results.input_tables import input_tables
    from eventpound.results.tables import lines_of

    for table in input_tables(inputs):
        yield ""
        yield from lines_of(table)


def _check_study(case: StudyCase) -> int:
    """Say what was understood of a case with a [study], its scene by that of the first run."""
    from eventpound.results.inputs import inputs_of
    from eventpound.scene.pi_terms import number_of_terms

    study, first = case.study, case.study.bases[0]
    arguments.complain_of_scales(study.bases)
    print(f"study     {study.title}")
    print("\n".join(_tables(inputs_of(first.case))), end="\n\n")
    values = {**first.labels, **{axis.key: f"{axis.values[0]:.6g}" for axis in first.axes}}
    at = ", ".join(f"{key} = {value}" for key, value in values.items())
    print(f"shown     what the first run has{at and ': '}{at}")
    print(f"runs      {study.size}, stored in chunks of {study.chunk_size}")
    print(f"axes      {', '.join(study.columns)}")
    print(f"keeps     {', '.join(study.quantities)}")
    scenes = [base.case.scene for base in study.bases]
    counts = {number_of_terms(s) for s in scenes if s.bodies and s.motion.scales() is not None}
    if counts:
        numbers = " or ".join(map(str, sorted(counts)))
        print(f"Pi-terms  dimensionless numbers, {numbers} with the peak's")
    print(f"solver    {study.solver}, rtol {study.rtol:g}")
    return 0


def _list_quantities(path: Path | None) -> int:
    """Names of the quantities of a case, or of what a study may tabulate; without any, all."""
    from eventpound.quantities.base import SIX
    from eventpound.quantities.lookup import listing, names_of

    if path is None:
        for name, unit, text, _ in listing():
            print(f"{name:<34} {unit:<6} {text}")
        print(f"* stands for {', '.join(SIX)}")
        return 0
    from eventpound.study.kinds import Holds, kind_of

    if kind_of(path)[0] is Holds.STUDY:
        from eventpound.study.quantities import quantities_of

        scenes = [base.case.scene for base in arguments.loaded_study(path).study.bases]
        names = [name for scene in scenes for name in quantities_of(scene)]
    else:
        names = names_of(arguments.loaded_case(path).scene)
    print("\n".join(dict.fromkeys(names)))
    return 0
