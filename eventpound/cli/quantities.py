"""``eventpound quantities``: every number of a run that can be asked for."""

from __future__ import annotations

import argparse
from pathlib import Path

from eventpound.cli.arguments import Commands, add_command, load


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "list the quantities of a run, or their names in a case"
    command = add_command(commands, "quantities", _quantities, text)
    command.add_argument("case", metavar="CASE", type=Path, nargs="?", help="directory of a case")
    command.add_argument("--markdown", action="store_true", help="as the table of the docs")


def _quantities(options: argparse.Namespace) -> int:
    from eventpound.quantities import SIX, listing

    if options.case is not None:
        for name in _names(options.case):
            print(name)
        return 0
    if options.markdown:
        print("| name | unit | what | from |\n| --- | --- | --- | --- |")
        for path, unit, text, source in listing():
            print(f"| `{path}` | {unit} | {text} | {source} |")
        return 0
    for path, unit, text, _ in listing():
        print(f"{path:<34} {unit:<6} {text}")
    print(f"* stands for {', '.join(SIX)}")
    return 0


def _names(path: Path) -> list[str]:
    """Names of a case, of a study those of all its scenes."""
    from eventpound.case.loading import read_document
    from eventpound.quantities import names_of

    if "study" not in read_document(path)[0]:
        return names_of(load(path).scene)
    from eventpound.study.reading import load_study

    scenes = [base.case.scene for base in load_study(path).study.bases]
    return list(dict.fromkeys(name for scene in scenes for name in names_of(scene)))
