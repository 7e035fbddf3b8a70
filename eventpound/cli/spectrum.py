"""``eventpound spectrum``: the response spectrum of a pulse from a study in Π-terms."""

from __future__ import annotations

import argparse
import math

from eventpound.cli.arguments import Commands, add_case, add_command, add_out
from eventpound.errors import InputError

_ABOUT = """\
A study in Π-terms holds for every amplitude and period of its pulse. For those given
here, spectrum.csv has its rows in dimensions: T_s (s) or Q/m (m/s²), gap and yield
displacement (m), and u_max (m); the figures of the case are drawn in them, too.

  eventpound study cases/figure-05
  eventpound spectrum cases/figure-05 --amplitude "0.4 g" --period "0.8 s"
"""


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "the response spectrum of a pulse from a study in Π-terms"
    spectrum = add_command(commands, "spectrum", _spectrum, text, examples=_ABOUT)
    add_case(spectrum)
    spectrum.add_argument("--amplitude", required=True, help='a_g of the pulse, "0.4 g" or m/s²')
    spectrum.add_argument("--period", required=True, help='T_p of the pulse, "0.8 s" or s')
    add_out(spectrum, "where the results are and the spectrum goes (CASE/results)")


def _spectrum(options: argparse.Namespace) -> int:
    from eventpound.motion.base import Scales
    from eventpound.report.study_files import draw_spectrum
    from eventpound.study.reading import load_finished

    a_g = _positive("--amplitude", options.amplitude)
    period = _positive("--period", options.period)
    case, out, _ = load_finished(options.case, options.out)
    for path in draw_spectrum(case, out, Scales(a_g, 2.0 * math.pi / period)):
        print(path)
    return 0


def _positive(option: str, text: str) -> float:
    """A positive amplitude (m/s^2) or period (s), with or without a unit."""
    from eventpound.units import Dimension, quantity

    dimension = Dimension.ACCELERATION if option == "--amplitude" else Dimension.TIME
    try:
        value = quantity(text, dimension)
    except InputError as error:
        raise InputError(f"{option}: {error}") from error
    if value <= 0.0:
        raise InputError(f"{option}: found {text!r}; accepted: a positive one")
    return value
