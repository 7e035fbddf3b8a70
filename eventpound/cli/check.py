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
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.case import Case
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
        names = _all_quantities() if options.case is None else _quantities_of(options.case)
        print("\n".join(names))
        return 0
    if options.case is None:
        options.parser.error("the following arguments are required: CASE")
    study, suite = partial(_check_study, options), partial(_check_suite, options)
    return arguments.by_kind(options.case, partial(_check_one, options), study, suite)


def _check_suite(options: Options, case: Case) -> int:
    arguments.complain_of_scales(arguments.checked_suite(case).bases)
    return _say(options, case)


def _check_one(options: Options, case: Case) -> int:
    arguments.check_solver_of(case)
    return _say(options, case)


def _say(options: Options, case: Case) -> int:
    """Say what was understood of a case."""
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


def _check_study(options: Options, case: StudyCase) -> int:
    """Say what was understood of a case with a [study], its scene by that of the first run."""
    options.refuse(["--json"], "is for the case of a single run or of a suite, not of a study")
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
    numbers_of = (number_of_terms(scene) for scene in scenes if scene.bodies)
    if counts := {count for count in numbers_of if count is not None}:
        numbers = " or ".join(map(str, sorted(counts)))
        print(f"Pi-terms  dimensionless numbers, {numbers} with the peak's")
    print(f"solver    {study.solver}, rtol {study.rtol:g}")
    return 0


def _all_quantities() -> Iterator[str]:
    """What quantities there are, with units and what they are."""
    from eventpound.quantities.base import SIX
    from eventpound.quantities.lookup import listing
    from eventpound.results.tables import aligned

    yield aligned(("quantity", "unit", "what it is"), (row[:3] for row in listing()), range(3))
    yield f"* stands for {', '.join(SIX)}"


def _quantities_of(path: Path) -> Iterable[str]:
    """Names of the quantities of a case, or of what a study may tabulate."""
    from eventpound.quantities.lookup import names_of
    from eventpound.study.plan import quantities_of

    names = arguments.by_kind(
        path,
        lambda case: names_of(case.scene) if case.scene.bodies else [],
        lambda case: [n for base in case.study.bases for n in quantities_of(base.case.scene)],
    )
    if not names:
        raise InputError(f"{path}: the case has no bodies, and so no quantities")
    return dict.fromkeys(names)
