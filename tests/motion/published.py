"""Computed against published numbers for every file of the folder of real records.

    EVENTPOUND_RECORDS=FOLDER python -m tests.motion.published

The first table has PGA and mean period of the index; a star marks what differs
by more than its print, a plus what was published of another processing of the
same record. The second has intensity measures published with SLAMMER of the
same digital files, and how its conventions explain what differs. The third
says how far the conventions of the mean period are apart.
"""

import csv
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.intensity import Characteristics
from eventpound.units import STANDARD_GRAVITY
from tests.motion.readers.real_records import FOLDER, read_row, rows_of_index

SLAMMER_ARIAS = 1.00077
"""Published over computed Arias intensity: between 1.000768 and 1.000771 for all of
22 records, so a constant of theirs; which, we do not know."""


@dataclass(frozen=True)
class Published:
    """Numbers of one record as SLAMMER's table prints them, and ours."""

    row: dict[str, str]
    fact: dict[str, str]

    @cached_property
    def ours(self) -> Characteristics:
        """Computed from the same digital file."""
        return Characteristics(read_row(self.row))

    @property
    def name(self) -> str:
        """Event and component."""
        return f"{self.fact['earthquake']}/{self.fact['record']}"

    def pairs(self) -> list[tuple[str, float, str, int, float]]:
        """Name, ours, theirs as printed, decimals, and what conventions may add to rounding."""
        c, x = self.ours, self.ours.intensity
        dt = c.data.time_step
        return [
            ("PGA g", x.pga / STANDARD_GRAVITY, self.fact["pga_g_published"], 3, 0.0),
            ("T_m s", c.mean_periods["slammer"], self.fact["tm_s_published"], 2, 0.0),
            ("I_A m/s", x.arias * SLAMMER_ARIAS, self.fact["arias_m_s_published"], 3, 0.0),
            # Theirs is a sum of rectangles, which differs from ours by half a sample.
            ("PGV cm/s", 100 * x.pgv, self.fact["pgv_cm_s_published"], 1, 50 * x.pga * dt),
            # Theirs is between samples, ours between times within intervals.
            ("D s", x.significant_duration, self.fact["duration_5_95_s_published"], 1, dt),
        ]


def published_with_slammer() -> list[Published]:
    """Records whose own digital file SLAMMER's table was made of."""
    with (FOLDER / "facts" / "slammer_2133_records.csv").open(newline="", encoding="utf-8") as file:
        facts = {f"{fact['earthquake']}/{fact['record']}": fact for fact in csv.DictReader(file)}
    found = []
    for row in rows_of_index():
        if "same digital file" in row["published_from"]:
            name = row["published_from"].removeprefix("SLAMMER database: ").partition(" (")[0]
            found.append(Published(row, facts[name]))
    return found


def misses(ours: float, printed: str, decimals: int) -> bool:
    """Whether a number is not what was printed with so many decimals."""
    return abs(ours - float(printed)) > 0.5 * 10.0**-decimals * (1.0 + 1e-6)


def decimals_of(printed: str) -> int:
    """Decimals of a printed number."""
    return len(printed.partition(".")[2])


def _print_index() -> None:
    print(
        f"{'file':<52} {'PGA':>8} {'index':>8} {'publ.':>8}  {'T_m':>7} {'index':>7} {'publ.':>6}"
    )
    count = missed = 0
    for row in rows_of_index():
        try:
            ours = Characteristics(read_row(row))
        except InputError as error:
            print(f"{row['file']:<52} not read: {str(error)[-60:]}")
            continue
        if not row["pga_m_s2"]:
            continue
        count += 1
        pga, period = ours.intensity.pga, ours.mean_period
        columns = ("tm_s", "tm_nopad_s", "tm_slammer_convention_s")
        wrong = [
            column
            for column, period in zip(columns, ours.mean_periods.values(), strict=True)
            if misses(period, row[column], 4)
        ]
        wrong += ["pga_m_s2"] if misses(pga, row["pga_m_s2"], 4) else []
        missed += bool(wrong)
        mark = {True: "+", False: "*"}["other processing" in row["published_from"]]
        of_pga, of_period = row["published_pga_g"], row["published_tm_s"]
        pga_mark = (
            mark if of_pga and misses(pga / STANDARD_GRAVITY, of_pga, decimals_of(of_pga)) else " "
        )
        slammer = ours.mean_periods["slammer"]
        period_mark = mark if of_period and misses(slammer, of_period, 2) else " "
        print(
            f"{row['file'][-52:]:<52} {pga:8.4f} {row['pga_m_s2']:>8} {of_pga:>8}{pga_mark} "
            f"{period:7.4f} {row['tm_s']:>7} {of_period:>6}{period_mark} {' '.join(wrong)}"
        )
    print(f"{count} rows, {missed} with a number that is not the index's to its last digit\n")


def _print_slammer() -> None:
    for published in published_with_slammer():
        cells = [
            f"{name} {ours:.4f} ({printed}{'*' if misses(ours, printed, decimals) else ''})"
            for name, ours, printed, decimals, _ in published.pairs()
        ]
        print(f"{published.name:<32} " + "  ".join(cells))
    print(
        "I_A is multiplied by 1.00077, a constant of SLAMMER's; its PGV is a sum of rectangles,\n"
        "which is off by up to PGA dt / 2; its D is between samples, ours between times.\n"
    )


def _print_conventions() -> None:
    ratios: dict[str, list[float]] = {"literal": [], "slammer": []}
    for row in rows_of_index():
        if row["pga_m_s2"]:
            try:
                periods = Characteristics(read_row(row)).mean_periods
            except InputError:
                continue
            for name, values in ratios.items():
                values.append(abs(periods[name] / periods["padded"] - 1.0))
    for name, values in ratios.items():
        median, most, worst = np.quantile(values, [0.5, 0.95, 1.0])
        print(
            f"T_m {name} against padded, {len(values)} records: "
            f"median {median:.2%}, 95 % below {most:.1%}, worst {worst:.1%}"
        )


def main() -> None:
    """Print the tables."""
    if not FOLDER.is_dir():
        print(f"skipped: there are no real records in {FOLDER}; EVENTPOUND_RECORDS names a folder")
        return
    _print_index()
    _print_slammer()
    _print_conventions()


if __name__ == "__main__":
    main()
