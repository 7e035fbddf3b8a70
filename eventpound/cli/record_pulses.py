"""``eventpound records --pulse``: the pulse in a record, written, drawn and printed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Command, Options

if TYPE_CHECKING:
    from eventpound.motion.intensity import Characteristics
    from eventpound.motion.pulse_fit import PulseFit

PULSE_WORDS = (
    *("all", "sine", "cosine", "type-c", "ricker", "antisymmetric-ricker"),
    "mavroeidis-papageorgiou",
)
_DRAWN = 3
"""Pulses of a record that are drawn, the best ones."""


def add_pulses(parser: Command) -> None:
    """Add the options to the parser of the command."""
    parser.group("the pulse in a record")
    kinds = "fit pulses, all kinds or this one: a_p, T_p, start and the share explained"
    parser.add_argument("--pulse", nargs="?", const="all", choices=PULSE_WORDS, help=kinds)
    parser.add_argument(
        "--pulse-to",
        choices=("velocity", "acceleration"),
        default="velocity",
        help="what they are fitted to by least squares (velocity: its long, coherent part)",
    )


def write_pulses(
    records: Sequence[Characteristics], options: Options, out: Path, names: Sequence[str]
) -> None:
    """Fit, write ``pulses.csv``, draw where figures are wanted, print for a single record.

    Parameters
    ----------
    records : sequence of Characteristics
        At least one.
    options : Namespace
        Of the command.
    out : Path
        Where the files go.
    names : sequence of str
        Names of the records' figures, without ending; empty for no figures.
    """
    from eventpound.motion.pulse_fit import PULSES, fit_pulse
    from eventpound.report.pulse_fit import pulse_fit_figure
    from eventpound.report.style import png
    from eventpound.results import write_together
    from eventpound.results.records import PULSE_TABLE, pulses_csv

    kinds = tuple(PULSES) if options.pulse == "all" else (options.pulse,)
    fits = [fit_pulse(record.record, kinds, options.pulse_to) for record in records]
    write_together(out, {PULSE_TABLE: pulses_csv(list(zip(records, fits, strict=True)))})
    if len(records) == 1:
        print(_summary(fits[0]))
    print(f"pulses    {out / PULSE_TABLE}")
    for record, own, name in zip(records, fits, names, strict=False):
        figure = pulse_fit_figure(record.record, own[:_DRAWN], Path(record.data.file).name)
        write_together(out, {f"{name}-pulse.png": png(figure)})
        print(f"figure    {out / f'{name}-pulse.png'}")


def _summary(fits: Sequence[PulseFit]) -> str:
    """The pulses of one record, to be read."""
    from eventpound.results.tables import aligned

    rows = (
        (f.kind, f"{f.a_p:.4f}", f"{f.T_p:.4f}", f"{f.length:.5f}", f"{f.explained:.1%}")
        for f in fits
    )
    heads = ("pulse", "a_p (m/s^2)", "T_p (s)", "L_e (m)", "explained")
    return aligned(heads, rows, {0}) + f"\n          explained: of the squares of the {fits[0].on}"
