"""``eventpound check``: read a case and show what was understood."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping
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
    from eventpound.results.cells import lines_of
    from eventpound.results.input_tables import input_lines, input_tables

    for table in input_tables(inputs):
        yield ""
        yield from lines_of(table)
    yield ""
    yield from (f"{word:<9} {text}" for word, text in input_lines(inputs))


def _check_study(path: Path) -> int:
    """Say what was understood of a case with a [study]."""
    from eventpound.scene.pi_terms import number_of_terms
    from eventpound.study.reading import load_study

    case = load_study(path)
    study = case.study
    show_warnings(case.warnings)
    print(f"study     {study.title}")
    print(f"runs      {study.size}, stored in chunks of {study.chunk_size}")
    print(f"axes      {', '.join(study.columns)}")
    print(f"keeps     {', '.join(study.quantities)}")
    scenes = [base.case.scene for base in study.bases]
    counts = {number_of_terms(s) for s in scenes if s.bodies and s.motion.scales() is not None}
    if counts:
        print(f"Pi-terms  {' or '.join(map(str, sorted(counts)))} with the peak's")
    print(f"solver    {study.solver}, rtol {study.rtol:g}")
    return 0
