"""Write and draw the response spectrum of a pulse from a study in Π-terms.

A study in Π-terms holds for every amplitude and period of its pulse. spectrum.csv has the rows of
its finished table in dimensions: T_s (s) or Q/m (m/s²), gap and yield displacement (m), and u_max
(m); the figures of the case are drawn in them, too. Other columns stay those of the study's pulse.

Examples
--------
  eventpound study spectrum cases/figure-05 --amplitude "0.4 g" --period "0.8 s"
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from eventpound.basics.given import number
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.units import Dimension


def add_spectrum(commands: Commands) -> None:
    """Add the command to the parser."""
    command = add_command(commands, "study spectrum", _spectrum, __doc__)
    command.case()
    command.option("--amplitude A", 'a_g of the pulse, "0.4 g" or m/s²', required=True)
    command.option("--period T", 'T_p of the pulse, "0.8 s" or s', required=True)
    command.out("where the results are and the spectrum goes (CASE/results)")


def _spectrum(options: Options) -> int:
    from eventpound.motion.base import Scales
    from eventpound.report.study_files import draw_spectrum
    from eventpound.study.reading import load_finished
    from eventpound.units import Dimension

    a_g = _positive("--amplitude", options.amplitude, Dimension.ACCELERATION)
    period = _positive("--period", options.period, Dimension.TIME)
    case, out, _ = load_finished(options.case, options.out)
    for path in draw_spectrum(case, out, Scales(a_g, 2.0 * math.pi / period)):
        print(path)
    return 0


def _positive(name: str, text: str, dimension: Dimension) -> float:
    """A positive number, with or without a unit."""
    value = number(name, text, dimension)
    if value <= 0.0:
        raise InputError(f"{name}: found {text!r}; accepted: a positive one")
    return value
