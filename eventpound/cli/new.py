"""Write a commented case that runs."""

from __future__ import annotations

from pathlib import Path

from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.talk import complain
from eventpound.errors import InputError


def add_new(commands: Commands) -> None:
    """Add the command to the parser."""
    new = add_command(commands, "new", _new, __doc__)
    new.add_argument("directory", metavar="DIR", type=Path, help="made where it is missing")
    kinds = new.add_mutually_exclusive_group()
    for word, text in (
        ("oscillator", "one body beside a barrier (the default)"),
        ("bridge", "three segments on piers, an abutment, two joints"),
        ("buildings", "two frames of storeys that touch at their floors"),
        ("isolated", "a building on isolators between moat walls"),
    ):
        kinds.add_argument(f"--{word}", dest="scene", action="store_const", const=word, help=text)
    new.option("--record FILE", "a record, instead of a pulse", Path)
    new.set_defaults(scene="oscillator")


def _new(options: Options) -> int:
    from eventpound.case import write_template

    if options.record is not None and not options.record.is_file():
        raise InputError(f"--record: {options.record}: no such file")
    file = write_template(options.directory, options.scene, options.record)
    print(f"wrote {file}")
    if options.record is not None:
        _say_what_is_missing(options.record, file)
    return 0


def _say_what_is_missing(record: Path, file: Path) -> None:
    """Say on stderr what the case has to say of a record, because its file does not."""
    from eventpound.motion import read_record

    try:
        read_record(record)
    except InputError as error:
        complain(f"to be filled in, in {file}: {error}")
