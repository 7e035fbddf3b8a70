"""``eventpound records --spectrum``: response spectra."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.basics.given import number
from eventpound.cli.arguments import Command, Options
from eventpound.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.motion.intensity import Characteristics
    from eventpound.motion.record import Record


def add_spectra(record: Command) -> None:
    """Add the options to the parser."""
    record.group("response spectra")
    record.option("--spectrum", "SD, PSV, PSA at 200 periods: table and figure")
    record.option("--damping RATIO", "ratio of critical damping (5 %%)", default="5 %")
    target = "a spectrum to draw beside it, columns period (s) and PSA_g (g)"
    record.option("--target CSV", target, Path)


def write_spectra(
    records: list[Characteristics], options: Options, names: list[str], out: Path
) -> None:
    """Compute the spectra of records, write and draw them.

    Parameters
    ----------
    records : list of Characteristics
        The records.
    options : Namespace
        What was asked for.
    names : list of str
        What the files of each are called, without ending.
    out : Path
        Where they go.
    """
    from eventpound.report.record_figure import spectrum_figure
    from eventpound.report.style import png
    from eventpound.results import write_together
    from eventpound.results.tables import table_csv
    from eventpound.study.response_spectrum import response_spectrum
    from eventpound.units import Dimension

    damping = number("--damping", options.damping, Dimension.NUMBER)
    target = None if options.target is None else read_target(options.target)
    for record, name in zip(records, names, strict=True):
        spectrum = response_spectrum(record.record, damping)
        figure = spectrum_figure(spectrum, damping, name, target)
        stem = f"{name}-spectrum"
        write_together(out, {f"{stem}.csv": table_csv(spectrum), f"{stem}.png": png(figure)})
        peak = spectrum.loc[spectrum["PSA"].idxmax()]
        print(
            f"spectrum  {out / stem}.csv, .png: PSA up to {peak['PSA_g']:.4g} g "
            f"at {peak['period']:.3g} s"
        )
        if target is not None:
            print(_to_target(record.record, target, damping))


def _to_target(record: Record, target: pd.DataFrame, damping: float) -> str:
    """The factor that brings a record to a target, in words."""
    from eventpound.motion.scaling import PERIODS, Target, factor_to

    points = tuple(target["period"]), tuple(STANDARD_GRAVITY * target["PSA_g"])
    low, high = max(points[0][0], PERIODS[0]), min(points[0][-1], PERIODS[-1])
    factor = factor_to(Target(*points, low, high, damping), record.values, record.time_step)
    between = f"least squares of ln PSA from {low:g} to {high:g} s"
    return f"target    scale = {factor:.4g} brings it there ({between})"


def read_target(path: Path) -> pd.DataFrame:
    """A target spectrum.

    Raises
    ------
    InputError
        Where it cannot be read, or lacks a column.
    """
    import pandas as pd

    from eventpound.case.record_scaling import read_target_file

    period, psa = read_target_file(path)
    return pd.DataFrame({"period": period, "PSA_g": psa / STANDARD_GRAVITY})
