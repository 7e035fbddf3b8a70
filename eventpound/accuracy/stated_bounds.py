"""What a case's ``certificate.json`` says of its true values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.results.jsontext import read_json

CERTIFICATES = ("results/certificate.json", "certificate.json")
"""Where a certificate may lie in a case directory; the first one there is believed."""
DOUBT = 100.0
"""How many times the difference of two runs a certified value may be off one of them."""
ROUNDING = 1e-9
"""Part of the scale that the arithmetic of another machine may make, however small a bound."""


@dataclass(frozen=True)
class StatedBounds:
    """Certified quantities of a case.

    Parameters
    ----------
    file : Path
        Where they stand.
    certified : mapping of str to tuple of float
        Value and bound (SI) by the name of the quantity, as in ``summary.json``.
    """

    file: Path
    certified: Mapping[str, tuple[float, float]]

    def values(self, names: Iterable[str]) -> dict[str, float]:
        """Values (SI) of those quantities that are certified."""
        return {name: self.certified[name][0] for name in names if name in self.certified}

    def check(
        self,
        values: Mapping[str, float],
        doubt: Mapping[str, float],
        scales: Mapping[str, float],
    ) -> None:
        """Make sure that these are certified values of this very case.

        Parameters
        ----------
        values, doubt, scales : mapping of str to float
            What a run gives, how far it may be off, and the scale of it (SI).

        Raises
        ------
        InputError
            Where a certified value is further off than its bound and the doubt allow.
        """
        for name, value in self.values(values).items():
            slack = self.certified[name][1] + DOUBT * doubt[name] + ROUNDING * scales[name]
            if abs(value - values[name]) > slack:
                raise InputError(
                    f"{self.file}: {name} = {value:.9g} +- {self.certified[name][1]:.1e}, but the "
                    f"case as it stands gives {values[name]:.9g}; run eventpound verify again"
                )

    def bounds(self, names: Iterable[str]) -> dict[str, float]:
        """Bounds (SI) of those quantities that are certified."""
        return {name: self.certified[name][1] for name in names if name in self.certified}


def stated_bounds(case: Case) -> StatedBounds | None:
    """What the certificate in a case's directory or its results says; None without one.

    Raises
    ------
    InputError
        Where the file is no certificate.
    """
    files = [case.directory / name for name in CERTIFICATES]
    file = next((path for path in files if path.is_file()), None)
    if file is None:
        return None
    try:
        content = read_json(file)
    except InputError as error:
        raise InputError(f"{error}; run eventpound verify again") from error
    return StatedBounds(file, _certified(file, content))


def _certified(file: Path, content: Any) -> dict[str, tuple[float, float]]:
    try:
        return {
            entry["quantity"]: (float(entry["value"]), float(entry["bound"]))
            for entry in content["quantities"]
            if entry["certified"]
        }
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{file}: 'quantities' must be a list of quantity, value, bound, certified "
            f"({type(error).__name__}: {error}); run eventpound verify again"
        ) from error
