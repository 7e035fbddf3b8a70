"""Scales and intensity measures of records, their spectra and pulses; synthetic motions.

PGA, mean period T_m (Rathje et al. 1998), omega_g = 2 pi / T_m, L_e = PGA / omega_g^2,
PGV, PGD, Arias intensity, significant duration and CAV of a record, or of every
component of every file in a folder. Formats are told by their content; what a file
does not say (units, time step, which of several components) is asked for.

A folder gives a table, records.csv, with a row for each component; files that cannot
be read are listed at the end with the reason. The table is a list for --list and for
--suite of `eventpound run`, in which units, time step (dt_s) and component can be filled in.

Synthetic motions are written by `eventpound records synthetic DIR`; a folder of that
name is ./synthetic.

Examples
--------
  eventpound records RSN6.AT2                        print, and write RSN6-record/
  eventpound records a.txt --units g --time-step 0.01
  eventpound records station.V2 --component 90       '#2' is the second
  eventpound records folder --units g                where a file does not say
  eventpound records folder --list folder/index.csv  units and time steps by file
  eventpound records a.AT2 --baseline 1 --highpass 0.1 --lowpass 25
  eventpound records a.AT2 --pulse                   the pulse that fits it best
  eventpound records a.AT2 --spectrum --damping 2%   its response spectrum
  eventpound records synthetic motions --count 60
"""

from __future__ import annotations

import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.cli import synthetic
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.cli.progress import Counter
from eventpound.cli.record_pulses import add_pulses, write_pulses
from eventpound.cli.record_spectra import add_spectra, write_spectra
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.motion.base import Scales
    from eventpound.motion.intensity import Characteristics
    from eventpound.motion.processing import Processing
    from eventpound.motion.record_list import RecordFile


def add_records(commands: Commands) -> None:
    """Add the command to the parser."""
    records = add_command(commands, "records", _records, __doc__)
    records.add_argument("path", metavar="FILE|FOLDER", type=Path, help="a record or many")
    records.out("where table, manifest and figures go (NAME-record in this directory)")
    records.group("what a file does not say")
    records.option("--units UNIT", "g, m/s2, cm/s2, gal or mm/s2, or '0.1 g'")
    records.option("--time-step S", "time step (s)", float)
    records.option("--component NAME", "its name in the file, or #2 for the second")
    records.option("--response FILE", "StationXML file, for counts")
    records.option("--format NAME", "the format, instead of what the content says")
    files = "the files of a folder, with columns file, units, time_step (or dt_s)"
    records.option("--list CSV", files, Path)
    add_pulses(records)
    add_spectra(records)
    records.group("processing, off by default")
    records.option("--baseline N", "take a polynomial away; 0: mean", int)
    records.option("--highpass HZ", "lower corner of the filter", float)
    records.option("--lowpass HZ", "upper corner of the filter", float)
    records.option("--order N", "of the Butterworth filter, a pass (4)", int, default=4)
    records.add_argument(
        "--mean-period",
        choices=("padded", "literal", "slammer"),
        default="padded",
        help="transform that T_m is taken of: padded to 0.05 Hz or finer, as the record is, "
        "or as in SLAMMER",
    )
    records.option("--figures", "a figure for each of a folder")
    records.option("--no-figures", "no figure for a file")
    synthetic.add_synthetic(commands)


def _records(options: Options) -> int:
    from eventpound import results
    from eventpound.motion.processing import Processing
    from eventpound.results.records import MANIFEST, TABLE, records_csv, records_manifest

    folder = options.path.is_dir()
    if not folder:
        options.refuse(["--list"], f"is for a folder, and {options.path} is none")
    if options.pulse is None:
        options.refuse(["--pulse-to"], "is for --pulse")
    if not options.spectrum:
        options.refuse(["--damping", "--target"], "is for --spectrum")
    processing = Processing(options.baseline, options.highpass, options.lowpass, options.order)
    out = options.out or Path(f"{options.path.resolve().stem}-record")
    results.check_writable(out)
    started = datetime.now(UTC)
    read = _read_folder if folder else _read_file
    records, unread = read(options, processing)
    if not records:
        raise InputError([*unread.values()] or f"{options.path}: no file in the folder")
    table = records_csv(records, unread, out)
    manifest = records_manifest(records, unread, processing, table, started)
    results.write_together(out, {TABLE: table, MANIFEST: manifest})
    files = {record.data.file for record in records}
    print(
        f"records   {len(records)} in {len(files)} of {len(files | unread.keys())} files"
        if folder
        else _summary(records[0])
    )
    print(f"table     {out / TABLE}")
    drawn: list[str] = []
    if options.figures or not (folder or options.no_figures):
        drawn = _draw(records, out)
    if options.pulse is not None:
        write_pulses(records, options, out, drawn)
    if options.spectrum:
        write_spectra(records, options, _names(records), out)
    if unread:
        print(f"\n{len(unread)} files were not read:", file=sys.stderr)
        for problem in unread.values():
            print(f"  {problem}", file=sys.stderr)
        print(
            f"what they do not say can be filled in in {out / TABLE}, "
            f"which is a list for --list and --suite",
            file=sys.stderr,
        )
    return 0


def _said(options: Options) -> dict[str, Any]:
    """What is said of all files."""
    words = ("units", "time_step", "component", "response", "format")
    return {word: getattr(options, word) for word in words}


def _read_file(
    options: Options, processing: Processing
) -> tuple[list[Characteristics], dict[str, str]]:
    """The record of one file."""
    from eventpound.motion.intensity import Characteristics
    from eventpound.motion.readers import read_record

    data = read_record(options.path, **_said(options))
    record = Characteristics(processing.apply(data), options.mean_period)
    record.row()
    return [record], {}


def _read_folder(
    options: Options, processing: Processing
) -> tuple[list[Characteristics], dict[str, str]]:
    """The records of a folder, and why others were not read."""
    from eventpound.motion.intensity import Characteristics
    from eventpound.motion.record_list import read_each

    files = _files(options)
    records: list[Characteristics] = []
    unread: dict[str, str] = {}
    with Counter("files") as progress:
        for file, found in read_each(files, progress):
            if isinstance(found, InputError):
                unread[str(file.path)] = found.problems[0]
                continue
            for data in found:
                try:
                    record = Characteristics(processing.apply(data), options.mean_period)
                    record.row()
                    records.append(record)
                except InputError as error:
                    problem = error.problems[0].removeprefix(f"{file.path}: ")
                    unread[str(file.path)] = f"{file.path}: {problem}"
    return records, unread


def _files(options: Options) -> list[RecordFile]:
    """Files of the folder or of the list, with what is said of all of them."""
    from dataclasses import replace

    from eventpound.motion.record_list import RecordFile, files_in, listed_files

    if options.list is None:
        files = [RecordFile(path) for path in files_in(options.path)]
    else:
        files = listed_files(options.list)
    said, own = _said(options), ("units", "time_step")
    return [
        replace(file, **said | {word: getattr(file, word) or said[word] for word in own})
        for file in files
    ]


def _draw(records: list[Characteristics], out: Path) -> list[str]:
    """A figure for each record; their names without ending."""
    from eventpound.report.record_figure import record_figure
    from eventpound.report.style import png
    from eventpound.results import write_together

    names = _names(records)
    for record, name in zip(records, names, strict=True):
        write_together(out, {f"{name}.png": png(record_figure(record))})
        print(f"figure    {out / name}.png")
    return names


def _names(records: list[Characteristics]) -> list[str]:
    """What the files of each record are called: its file, component and a number."""
    from eventpound.results.files import plain_name

    names: list[str] = []
    for record in records:
        parts = [Path(record.data.file).name, record.data.component]
        plain = "-".join(plain_name(part) for part in parts if part)
        numbered = (f"{plain}{suffix}" for suffix in ("", *(f"-{i}" for i in range(2, 10_000))))
        names.append(next(name for name in numbered if name not in names))
    return names


def _scale_lines(scales: Scales | None, periods: str) -> list[str]:
    """T_m with that of every convention, and the scales that it makes."""
    if scales is None:
        return [f"T_m       not defined: nothing between 0.25 and 20 Hz {periods}"]
    return [
        f"T_m       {scales.period:.4f} s {periods}",
        f"omega_g   {scales.omega_g:.5g} rad/s",
        f"L_e       {scales.length:.5g} m",
    ]


def _summary(record: Characteristics) -> str:
    """Numbers of one record, to be read."""
    from eventpound.units import STANDARD_GRAVITY

    data, x, scales = record.data, record.intensity, record.scales
    named = [data.event, data.date, data.station, data.component]
    periods = ", ".join(f"{name} {period:.4f}" for name, period in record.mean_periods.items())
    lines = [
        f"record    {data.file} ({data.format}, units {data.units})",
        *([f"header    {', '.join(part for part in named if part)}"] if any(named) else []),
        f"samples   {data.acceleration.size}, every {data.time_step:g} s, "
        f"{record.record.end:.2f} s",
        *(f"note      {note}" for note in data.notes),
        f"PGA       {x.pga:.5g} m/s^2 ({x.pga / STANDARD_GRAVITY:.5g} g) at {x.time_of_pga:.5g} s",
        *_scale_lines(scales, f"({periods})"),
        f"PGV, PGD  {x.pgv:.5g} m/s, {x.pgd:.5g} m",
        f"Arias     {x.arias:.5g} m/s (trapezoid sum)",
        f"D_5-95    {x.significant_duration:.2f} s, from {x.duration_from:.2f} s on",
        f"CAV       {x.cav:.5g} m/s (trapezoid sum)",
    ]
    return "\n".join(lines)
