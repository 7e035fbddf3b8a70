"""What a case's ``certificate.json`` says of its true values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.results.jsontext import read_json
from eventpound.score import ScaledValue

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

    def instead_of(self, quantities: Sequence[ScaledValue]) -> list[ScaledValue]:
        """Quantities of a run with the values and bounds that are certified in place of its own.

        Raises
        ------
        InputError
            Where a certified value is further from the run's than the bounds of both allow: it is
            of another case.
        """
        found = []
        for q in quantities:
            value, bound = self.certified.get(q.name, (q.value, q.bound))
            slack = bound + DOUBT * q.bound + ROUNDING * q.scale
            if q.name in self.certified and abs(value - q.value) > slack:
                raise InputError(
                    f"{self.file}: {q.name} = {value:.9g} +- {bound:.1e}, but the "
                    f"case as it stands gives {q.value:.9g}; run eventpound verify again"
                )
            found.append(replace(q, value=value, bound=bound))
        return found


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
