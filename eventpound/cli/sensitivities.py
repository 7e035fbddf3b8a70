"""How quantities follow the numbers of a case, one at a time.

Each number is varied by 1e-5 of itself; derivatives have an error, and a note where there is none
because an impact comes or goes. Of a case with a [study] the axes are left out.

Files: sensitivities.csv, sensitivities.png (per cent for one per cent).

Examples
--------
  eventpound study sensitivities cases/bridge-el-centro --of contacts.joint.max_impulse
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.progress import Counter
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.case import Case
    from eventpound.study.reading import StudyCase


def add_sensitivities(commands: Commands) -> None:
    """Add the command to the parser."""
    command = add_command(commands, "study sensitivities", _sensitivities, __doc__)
    command.case()
    several: dict[str, Any] = {"action": "append", "default": []}
    command.option("--of QUANTITY", "by name or path (peaks); may be repeated", **several)
    command.option("--to NUMBER", "by its key (every number); may be repeated", **several)
    command.out("where they go (CASE/results)")
    command.option("--no-figures", "write the table only")
    command.paper()


def _only_scene(case: StudyCase) -> Case:
    """What a [study] varies."""
    bases = case.study.bases
    if len(bases) > 1 or bases[0].records:
        raise InputError("is of one scene, and this [study] has several")
    return bases[0].case


def _sensitivities(options: Options) -> int:
    from eventpound.results import check_writable
    from eventpound.results.tables import aligned, table_csv
    from eventpound.study.sensitivities import PEAKS, sensitivities

    case = arguments.by_kind(options.case, lambda case: case, _only_scene)
    paper = options.paper()
    check_writable(options.results)
    with Counter("runs") as progress:
        table = sensitivities(case, of=options.of or PEAKS, to=options.to, progress=progress)
    for name, part in table.groupby("quantity", sort=False):
        shown = zip(part["to"], part["elasticity"], part["note"], strict=True)
        rows = ((to, "" if note else f"{size:+.4f}", note) for to, size, note in shown)
        print(aligned((str(name), "% for 1 %", ""), rows, {0, 2}))
    files = {"sensitivities.csv": table_csv(table)}
    if not options.no_figures:
        from eventpound.report.study_curves import tornado_figure
        from eventpound.report.style import on_paper

        if (figure := tornado_figure(table, case.title)) is not None:
            files |= on_paper({"sensitivities.png": figure}, paper)
    arguments.write_and_print(options.results, files)
    return 0
