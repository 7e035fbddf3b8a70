"""What commands share: their options, how these are read and refused, how a case is loaded."""

from __future__ import annotations

import argparse
import math
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from eventpound.cli.talk import add_loudness, complain, located, tell_step
from eventpound.errors import InputError, told_of

if TYPE_CHECKING:
    from eventpound.case import Case
    from eventpound.report.style import Paper
    from eventpound.study.base import Base
    from eventpound.study.plan import Plan
    from eventpound.study.reading import StudyCase

T = TypeVar("T")
Commands: TypeAlias = "argparse._SubParsersAction[Command]"
"""What commands are added to."""
PAPER = " --format --width --dpi"
"""Options that say how figures are written."""
EXAMPLES = "Examples\n--------\n"
"""What their examples begin with in docstrings."""
_OF_ALL = ("--help", "--quiet", "--verbose")
_FORMATS = ("png", "pdf", "svg")
"""Kinds of files that figures may be written as."""


class Command(argparse.ArgumentParser):
    """What a command is told, and its help."""

    def __init__(self, **of_parser: Any) -> None:
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **of_parser)
        self._where: argparse._ActionsContainer = self

    def group(self, title: str, about: str | None = None) -> None:
        """Begin a group of options, under a title of its own."""
        self._where = self.add_argument_group(title, about and textwrap.fill(about, 76))

    def exclusive(self) -> None:
        """Begin a group of options of which one may be given."""
        self._where = self.add_mutually_exclusive_group()

    def option(self, words: str, text: str, read: Callable[[str], Any] = str, **more: Any) -> None:
        """Add an option: a flag, or, as ``"--out DIR"``, one that takes a value."""
        name, _, metavar = words.partition(" ")
        kind = {"metavar": metavar, "type": read} if metavar else {"action": "store_true"}
        self._where.add_argument(name, help=text, **kind | more)

    def case(self, **more: Any) -> None:
        """Add the directory of a case."""
        self.add_argument("case", metavar="CASE", type=Path, help="directory of the case", **more)

    def out(self, text: str) -> None:
        """Add ``--out``, described by a text that names the default."""
        self.option("--out DIR", text, Path)

    def paper(self) -> None:
        """Add kinds of files, width and resolution of figures."""
        self.group("how figures are written")
        kinds = f"{', '.join(_FORMATS)}, or some of them (png)"
        self.option("--format KIND,...", kinds, _formats, default=_FORMATS[:1])
        self.option("--width WIDTH", 'of a figure, as "90 mm"')
        self.option("--dpi N", "dots an inch of a PNG (150)", count_argument, default=150)


class Options(argparse.Namespace):
    """What a command was told."""

    @property
    def results(self) -> Path:
        """Where the results of a case are: ``--out``, or ``results`` beside its file."""
        case: Path = self.case
        return self.out or (case.parent if case.is_file() else case) / "results"

    def refuse(self, names: Iterable[str], why: str) -> None:
        """Refuse those of the options that were given, for a reason."""
        parser: Command = self.parser
        of = {name: action.dest for action in parser._actions for name in action.option_strings}
        given = [n for n in names if getattr(self, of[n]) != parser.get_default(of[n])]
        if given:
            raise InputError(f"{', '.join(given)}: {why}")

    def refuse_others(self, accepted: str, why: str) -> None:
        """Refuse all options but those accepted, which stand one behind the other in a text."""
        actions = self.parser._actions
        names = [action.option_strings[-1] for action in actions if action.option_strings]
        self.refuse([n for n in names if n not in (*_OF_ALL, *accepted.split())], why)

    def paper(self) -> Paper:
        """How figures are written.

        Raises
        ------
        InputError
            Where the width is none.
        """
        from eventpound.basics.given import number
        from eventpound.report.style import Paper
        from eventpound.units import Dimension

        width = self.width and number("--width", self.width, Dimension.LENGTH)
        if width is not None and not 0.02 <= width <= 2.0:
            found = f"--width: found {self.width!r}"
            raise InputError(f'{found}; accepted: 20 mm to 2 m, as "90 mm"')
        return Paper(self.format, width and 1e3 * width, self.dpi)


def add_command(
    commands: Commands, name: str, command: Callable[[Options], int], text: str | None
) -> Command:
    """Add a command whose help is a docstring.

    The first line of the text stands in the list of commands, for a name of one word; its
    examples stand behind the options.
    """
    line, _, rest = located(text or "").partition("\n\n")
    about, _, examples = rest.partition(EXAMPLES)
    listed: dict[str, Any] = {}
    if " " not in name:
        listed["help"] = line[:1].lower() + line[1:].rstrip(".")
    if examples:
        listed["epilog"] = f"examples:\n{examples}"
    parser = commands.add_parser(name, description=f"{line}\n\n{about}".rstrip(), **listed)
    add_loudness(parser)
    parser.set_defaults(command=command, parser=parser)
    return parser


def _number(fits: Callable[[float], bool], accepted: str) -> Callable[[str], float]:
    """What reads a number from the command line."""

    def read(text: str) -> float:
        with suppress(ValueError):
            if fits(value := float(text)):
                return value
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: {accepted}")

    return read


tolerance = _number(lambda x: 0.0 < x < 1.0, "a number between 0 and 1")
seconds = _number(lambda x: 0.0 < x < math.inf, "a number of seconds")
restitution = _number(lambda x: 0.0 <= x <= 1.0, "a number from 0 to 1")


def count_argument(text: str) -> int:
    """Read a positive whole number from the command line."""
    if not text.isascii() or not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"found {text!r}; accepted: a whole number from 1")
    return int(text)


def comma_list(read: Callable[[str], T]) -> Callable[[str], list[T]]:
    """What reads several with commas between them."""
    return lambda text: [read(word) for word in text.split(",")]


def two_times(text: str) -> tuple[float, float]:
    """Read two times, the earlier one first, from the command line."""
    with suppress(ValueError):
        low, high = map(float, text.split(","))
        if low < high:
            return low, high
    raise argparse.ArgumentTypeError(f"found {text!r}; accepted: two times (s), as 2,6.5")


def _formats(text: str) -> tuple[str, ...]:
    kinds = tuple(dict.fromkeys(text.split(",")))
    if not set(kinds) <= set(_FORMATS):
        accepted = f"accepted: some of {', '.join(_FORMATS)}"
        raise argparse.ArgumentTypeError(f"found {text!r}; {accepted}")
    return kinds


def loaded_case(path: Path, suite: str | None = None) -> Case:
    """Load a case, perhaps with other records, and show its warnings."""
    from eventpound.case import load_case

    case = load_case(path, suite)
    scene = case.scene
    tell_step(f"read {path}: {len(scene.bodies)} bodies, {len(scene.contacts)} contacts")
    show_warnings(case.warnings)
    if any(case.run.stated.named()):
        from eventpound.quantities.lookup import asked

        with told_of(f"{file_of(case)}[run]: "):
            asked([(scene, case.run.stated)])
    return case


def loaded_study(path: Path) -> StudyCase:
    """Load a case with a [study], and show its warnings."""
    from eventpound.study.reading import load_study

    case = load_study(path)
    show_warnings(case.warnings)
    return case


def by_kind(
    path: Path,
    one: Callable[[Case], T],
    study: Callable[[StudyCase], T] | None = None,
    suite: Callable[[Case], T] | None = None,
    *,
    records: str | None = None,
) -> T:
    """What is made of a case, which is loaded, by what it holds.

    Parameters
    ----------
    path : Path
        Its directory.
    one : callable
        Makes it of a run.
    study, suite : callable, optional
        Make it of a study, which is refused by default, and of a suite, by default as of a run.
    records : str, optional
        Others, which make a suite of a run.
    """
    from eventpound.study.kinds import Holds, kind_of

    if study is not None and kind_of(path)[0] is Holds.STUDY:
        return study(loaded_study(path))
    case = loaded_case(path, records)
    return one(case) if suite is None or case.suite is None else suite(case)


def case_of_results(manifest: Mapping[str, Any], out: Path, options: Options) -> Case:
    """The case as it was run, whatever became of its file since."""
    from eventpound.case.loading import CASE_FILE, read_case

    understood = manifest.get("case")
    if not isinstance(understood, dict):
        raise InputError(f"{out}: its manifest has no case; run the case with `eventpound run`")
    return read_case(understood, options.case / CASE_FILE)


def show_warnings(warnings: Iterable[str]) -> None:
    """Say on stderr what is computed as it is asked for, but hardly meant so."""
    for warning in warnings:
        complain(f"warning: {warning}")


def complain_of_scales(bases: Sequence[Base]) -> None:
    """Warn of records that are scaled by much."""
    from eventpound.study.large_scales import large_scales_of

    if text := large_scales_of(bases):
        complain(f"warning: {text}")


def check_solver_of(case: Case, in_file: bool = True) -> None:
    """Refuse what no solver can be asked of a run, before anything runs.

    Parameters
    ----------
    case : Case
        Whose solver, settings and tolerance are looked at.
    in_file : bool
        Whether they are those of its file, which messages then name.

    Raises
    ------
    InputError
        Where there is no such solver, setting or tolerance, or the solver cannot take the scene.
    """
    from eventpound.case.solver_options import REFERENCE

    if in_file and case.solver.name == REFERENCE and not case.solver.settings:
        # It takes every scene, and its tolerance was checked; others take long to import.
        return
    from eventpound.simulation import check_solver

    with told_of(file_of(case) if in_file else ""):
        check_solver(case.solver, case.scene, case.run)


def checked_suite(case: Case) -> Plan:
    """The plan of a suite, of which nothing is refused any more."""
    from eventpound.study.suite import suite_plan

    with told_of(file_of(case)):
        return suite_plan(case)


def file_of(case: Case) -> str:
    """What a message on the file of a case begins with."""
    from eventpound.case.loading import CASE_FILE

    return f"{case.directory / CASE_FILE}: "


def write_and_print(out: Path, files: Mapping[str, bytes]) -> None:
    """Write files of a folder together and print their names."""
    from eventpound.results import write_together

    for path in write_together(out, files):
        print(path)
