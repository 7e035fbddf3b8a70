"""``eventpound floor``: floor spectra of bodies that are struck."""

from __future__ import annotations

import argparse

from eventpound.cli.arguments import (
    Commands,
    add_case,
    add_command,
    add_out,
    check_solver_of,
    load,
)
from eventpound.cli.paper_words import add_paper, paper_of
from eventpound.errors import InputError

_ABOUT = """\
The largest responses of light equipment (oscillators) on a body, over the period, through every
impact: an impact is an impulse on the equipment, with no contact stiffness to choose.
"""
_EXAMPLES = """\
examples:
  eventpound floor buildings A5
  eventpound floor buildings A1 A5 --damping 2%,5% --without-contact

Files: floor-spectra.csv with columns body, damping, period (s), SD (m), PSV (m/s), PSA (m/s^2),
PSA_g (g), SA (m/s^2, the largest absolute acceleration of the equipment), and floor-spectra.png.
With --without-contact also free.SD, free.PSV and so on. A spectrum is over the run of the case.
"""


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "floor spectra: responses of light equipment on bodies that are struck"
    floor = add_command(commands, "floor", _floor, text, _ABOUT, _EXAMPLES)
    add_case(floor)
    floor.add_argument("body", metavar="BODY", nargs="+", help="what the equipment stands on")
    floor.add_argument("--damping", default="5 %", help="its ratios, as 2%%,5%% (5 %%)")
    floor.add_argument(
        "--periods", metavar="FROM,TO", help="between which its 200 periods lie (0.05,10 s)"
    )
    floor.add_argument(
        "--without-contact", action="store_true", help="also those of the scene without contact"
    )
    add_out(floor, "where table and figure go (CASE/results)")
    add_paper(floor)


def _floor(options: argparse.Namespace) -> int:
    from eventpound.report.spectrum_figure import floor_figure
    from eventpound.report.style import on_paper
    from eventpound.results import check_writable, write_together
    from eventpound.results.tables import table_csv
    from eventpound.simulation import refuse_suite, simulate
    from eventpound.ways import Way, warn_left_out

    paper, periods, damping = paper_of(options), _periods(options.periods), options.damping
    case = load(options.case)
    refuse_suite(case)
    check_solver_of(case)
    warn_left_out(case, Way.FLOOR)
    out = options.out or case.directory / "results"
    check_writable(out)
    response = simulate(case)
    table = response.floor_spectrum(options.body, periods, damping.split(","))
    free = None
    both = table
    if options.without_contact:
        apart = response.without_contact
        free = apart.floor_spectrum(options.body, periods, damping.split(","))
        own = free.drop(columns=["body", "damping", "period"])
        both = table.join(own.add_prefix("free."))
    figures = {"floor-spectra.png": floor_figure(table, free, case.title)}
    files = {"floor-spectra.csv": table_csv(both)} | on_paper(figures, paper)
    for (body, ratio), curve in table.groupby(["body", "damping"], sort=False):
        peak = curve.loc[curve["PSA"].idxmax()]
        print(
            f"{body:<16} {100.0 * ratio:g} % damping: PSA up to {peak['PSA_g']:.4g} g "
            f"at {peak['period']:.3g} s"
        )
    for path in write_together(out, files):
        print(path)
    return 0


def _periods(text: str | None) -> list[float]:
    """Periods (s), evenly spaced in their logarithm."""
    from eventpound.motion.oscillators import PERIODS, read_periods

    if text is None:
        return list(PERIODS)
    try:
        low, high = map(float, text.split(","))
    except ValueError:
        low, high = 0.0, 0.0
    if not 0.0 < low < high:
        raise InputError(f"--periods: found {text!r}; accepted: two times (s), as 0.02,3")
    ratio = (high / low) ** (1.0 / (len(PERIODS) - 1))
    return list(read_periods([low * ratio**i for i in range(len(PERIODS))]))
