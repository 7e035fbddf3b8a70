"""Floor spectra: responses of light equipment on bodies that are struck.

The largest responses of light equipment (oscillators) on a body, over the period, through every
impact: an impact is an impulse on the equipment, with no contact stiffness to choose.

Files: floor-spectra.csv with columns body, damping, period (s), SD (m), PSV (m/s), PSA (m/s^2),
PSA_g (g), SA (m/s^2, the largest absolute acceleration of the equipment), and floor-spectra.png.
With --without-contact also free.SD, free.PSV and so on. A spectrum is over the run of the case.

Examples
--------
  eventpound floor-spectrum buildings A5
  eventpound floor-spectrum buildings A1 A5 --damping 2%,5% --without-contact
"""

from __future__ import annotations

from eventpound.cli import arguments
from eventpound.cli.arguments import Commands, Options, add_command
from eventpound.errors import InputError


def add_floor_spectrum(commands: Commands) -> None:
    """Add the command to the parser."""
    floor = add_command(commands, "floor-spectrum", _floor_spectrum, __doc__)
    floor.case()
    floor.add_argument("body", metavar="BODY", nargs="+", help="what the equipment stands on")
    floor.option("--damping RATIO,...", "its ratios, as 2%%,5%% (5 %%)", default="5 %")
    floor.option("--periods FROM,TO", "between which its 200 lie (0.05,10 s)", arguments.two_times)
    floor.option("--without-contact", "also those of the same case without contact")
    floor.out("where table and figure go (CASE/results)")
    floor.paper()


def _floor_spectrum(options: Options) -> int:
    from eventpound.case.run_options import Way, warn_left_out
    from eventpound.report.record_figure import floor_figure
    from eventpound.report.style import on_paper
    from eventpound.results import check_writable
    from eventpound.results.tables import table_csv
    from eventpound.simulation import response_of

    paper, periods, damping = options.paper(), _periods(options.periods), options.damping
    case = arguments.loaded_case(options.case)
    case.refuse_suite()
    arguments.check_solver_of(case)
    warn_left_out(case.run, Way.FLOOR)
    out = options.results
    check_writable(out)
    response = response_of(case)
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
    arguments.write_and_print(out, files)
    return 0


def _periods(between: tuple[float, float] | None) -> list[float]:
    """Periods (s), evenly spaced in their logarithm."""
    from eventpound.motion.scaling import PERIODS, read_periods

    if between is None:
        return list(PERIODS)
    low, high = between
    if low <= 0.0:
        raise InputError(f"--periods: found {low:g},{high:g}; accepted: two times (s), as 0.02,3")
    ratio = (high / low) ** (1.0 / (len(PERIODS) - 1))
    return list(read_periods([low * ratio**i for i in range(len(PERIODS))]))
