"""What ground motions are like: the ranges in which those of earthquakes lie.

They are wide, to find slips of a unit or of a factor, not rare motions. Whatever lies outside is
computed as it is asked for, and told.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Range:
    """Where a number of a motion lies.

    Parameters
    ----------
    what : str
        What it is called, with an article.
    least, most : float
        Its range.
    unit : str
        Of both.
    """

    what: str
    least: float
    most: float
    unit: str

    def __contains__(self, value: float) -> bool:
        return self.least <= value <= self.most

    @property
    def usual(self) -> str:
        """The range in words."""
        if not self.least:
            return f"usual is up to {self.most:g} {self.unit}"
        return f"usual are {self.least:g} to {self.most:g} {self.unit}"

    def doubt(self, value: float) -> str:
        """A sentence on a value outside; empty for one within."""
        return "" if value in self else f"{self.what} of {value:.4g} {self.unit}; {self.usual}"


PEAK = Range("a peak", 0.01, 2.0, "g")
"""Below it structures do not move much; 2.2 g vertical is the most of Christchurch 2011."""
PERIOD = Range("a period", 0.02, 20.0, "s")
"""Of a structure or a ground motion."""
STEP = Range("a time step", 0.0005, 0.1, "s")
"""Instruments sample 50 to 500 times a second; with fewer than 10 the structures' periods are lost,
and times in ms or minutes lie outside."""
LENGTH = Range("a length", 0.1, 1000.0, "s")
"""From a pulse alone to the longest earthquakes, which shake for minutes."""
PGV = Range("a peak velocity", 0.0, 5.0, "m/s")
"""Some 3 m/s were the most of Chi-Chi 1999 (TCU068)."""
PGD = Range("a peak displacement", 0.0, 20.0, "m")
"""Some 10 m moved with the fault there; records that are not corrected drift by metres."""
