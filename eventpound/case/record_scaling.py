"""How large a case wants its records: a factor, a peak, one ordinate of a spectrum, or all of it.

scale = 1.5                                              # factor on the samples
scale = [1.0, 0.8]                                       # of each record of a sequence; pga, psa
pga = "0.4 g"                                            # their peak
psa = "0.5 g"                                            # PSA at one period
psa_period = "1.2 s"                                     # or "T1", "T1 of deck": of the scene
psa_damping = "5 %"
target = "code.csv"                                      # least squares to a spectrum
target_periods = ["0.2 s", "2 s"]
target_damping = "5 %"
largest_scale = 4                                        # larger factors are warned of
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from eventpound.basics.input_files import read_columns, to_numbers
from eventpound.case.record_file import find_record
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.motion import Record, RecordData
from eventpound.motion.scaling import DAMPING, Target, factor_to, psa_of
from eventpound.motion.sequence import begun_with, records_of, times_each
from eventpound.numerics.arrays import Floats
from eventpound.scene.periods import T_1, period_called
from eventpound.scene.scene import Scene
from eventpound.units import STANDARD_GRAVITY, Dimension, quantity

LARGEST_SCALE = 4.0
"""Factor on a record beyond which is warned, where the case does not say another."""
_MOST_NAMED = 4
"""Records that a warning names, where each has several factors."""
WAYS = ("scale", "pga", "psa", "target")
"""Keys that say how large a record is."""
_TARGET = (
    'a CSV file with columns period (s) and PSA_g (g), or a list of pairs, [[0.1, "0.5 g"], ...]'
)
_BETWEEN = 'two periods between which it counts, ["0.2 s", "2 s"]'


def _in_g(acceleration: float) -> str:
    return f"{acceleration / STANDARD_GRAVITY:.4g} g"


@dataclass(frozen=True, slots=True)
class RecordScaling:
    """One of four ways to scale a record; none of them leaves it as it is.

    Parameters
    ----------
    scale : float or None
        Factor on the samples.
    pga : float or None
        Peak that they are scaled to (m/s^2).
    psa, psa_period : float or None
        Pseudo-acceleration (m/s^2) that they are scaled to at a period (s).
    psa_damping : float or None
        Its ratio of critical damping, where it is not 5 %.
    psa_at : str
        What the case calls the period, where it is one of the scene's (`for_scene`).
    target : Target or None
        Spectrum that they are brought close to.
    largest : float
        Factor beyond which is warned.
    each : tuple of float
        Numbers of `each_of` for the records of a sequence, one each.
    each_of : str
        ``"scale"``, ``"pga"`` or ``"psa"``.
    """

    scale: float | None = None
    pga: float | None = None
    psa: float | None = None
    psa_period: float | None = None
    psa_damping: float | None = None
    target: Target | None = None
    psa_at: str = ""
    largest: float = LARGEST_SCALE
    each: tuple[float, ...] = ()
    each_of: str = ""

    def for_scene(self, scene: Scene) -> RecordScaling:
        """The same with the period of a scene, where the case leaves it to that.

        Raises
        ------
        InputError
            Where the scene has no such period.
        """
        if not self.psa_at:
            return self
        return replace(self, psa_period=period_called(scene, self.psa_at))

    def of(self, data: RecordData, reverse: bool, start: float) -> Record:
        """The ground motion of a file that was read."""
        if self.each:
            data = times_each(data, self._factors(data))
            return Record(data.acceleration, data.time_step, 1.0, None, reverse, start, data)
        scale = 1.0 if self.scale is None else self.scale
        if self.target is not None:
            scale = factor_to(self.target, data.acceleration, data.time_step)
        return Record(
            *(data.acceleration, data.time_step, scale, self.pga, reverse, start, data),
            psa=self.psa,
            psa_period=self.psa_period,
            psa_damping=self.psa_damping,
            psa_at=self.psa_at,
        )

    def _factors(self, data: RecordData) -> list[float]:
        """On each record of a sequence."""
        if len(data.shocks) != len(self.each):
            raise InputError(
                f"{self.each_of}: found {len(self.each)} numbers for {len(data.shocks) or 1} "
                "records; accepted: a list of as many as a sequence has, or one number"
            )
        if self.each_of == "scale":
            return list(self.each)
        records = records_of(data)
        if self.each_of == "pga":
            sizes = [float(np.abs(record).max()) for record in records]
        else:
            damping = DAMPING if self.psa_damping is None else self.psa_damping
            at = np.array([self.psa_period], dtype=np.float64)
            sizes = [float(psa_of(r, data.time_step, at, damping)[0]) for r in records]
        return [to / of if of else 1.0 for to, of in zip(self.each, sizes, strict=True)]

    def wanted(self, period: float) -> float:
        """PSA (m/s^2) that records are brought to at a period (s); NaN where that is not said."""
        here = math.isclose(self.psa_period or 0.0, period, rel_tol=1e-6)
        if here and (self.psa is not None or self.each_of == "psa"):
            return self.psa or max(self.each)
        if self.target is not None:
            return float(np.exp(self.target.log_psa(period)))
        return math.nan

    def words(self, acceleration: Callable[[float], str] = _in_g) -> str:
        """What is done to the size of every record; empty where nothing is.

        `acceleration` writes one (m/s^2) with its unit.
        """
        if self.each:
            shown = [f"{x:g}" if self.each_of == "scale" else acceleration(x) for x in self.each]
            named = f"{self.psa_at} = " * bool(self.psa_at)
            at = f" at {named}{self.psa_period:.4g} s" if self.each_of == "psa" else ""
            word = {"scale": "times", "pga": "to a PGA of", "psa": "to a PSA of"}[self.each_of]
            return f"shocks {word} {', '.join(shown)}{at} ({self.each_of} in [excitation])"
        if self.pga is not None:
            return f"every record to a PGA of {acceleration(self.pga)} (pga in [excitation])"
        if self.psa is not None:
            size = acceleration(self.psa)
            at = f"{self.psa_at} = " * bool(self.psa_at) + f"{self.psa_period:.4g} s"
            return f"every record to a PSA of {size} at {at} (psa in [excitation])"
        if self.target is not None:
            between = f"{self.target.low:g} and {self.target.high:g} s"
            return f"every record to the target between {between} (target in [excitation])"
        if self.scale is not None and self.scale != 1.0:
            return f"every record times {self.scale:.6g} (scale in [excitation])"
        return ""

    def understood(self) -> Mapping[str, object]:
        """Its keys in SI, with the defaults filled in, but for that of the largest factor."""
        limit = {} if self.largest == LARGEST_SCALE else {"largest_scale": self.largest}
        return {**self._understood(), **limit}

    def _understood(self) -> dict[str, object]:
        """What scales, a target with its points."""
        if self.target is not None:
            points = zip(self.target.period, self.target.psa, strict=True)
            return {
                "target": [[*point] for point in points],
                "target_periods": [self.target.low, self.target.high],
                "target_damping": self.target.damping,
            }
        if self.each:
            of_psa = {"psa_period": self.psa_at or self.psa_period}
            of_psa["psa_damping"] = self.psa_damping or DAMPING
            return {self.each_of: list(self.each), **(of_psa if self.each_of == "psa" else {})}
        given = {"pga": self.pga, "psa": self.psa, "psa_period": self.psa_period}
        found: dict[str, object] = {key: v for key, v in given.items() if v is not None}
        if self.psa_period is not None:
            found["psa_period"] = self.psa_at or self.psa_period
            found["psa_damping"] = self.psa_damping or DAMPING
        by_size = self.pga is not None or self.psa is not None
        return found if by_size else {"scale": self.scale or 1.0, **found}


def scaled_as(first: Record, second: Record) -> Record:
    """A second component by the factor on the first; each shock begins there, and has its own.

    Raises
    ------
    InputError
        Where it has other shocks.
    """
    scale = abs(first.factor)
    if first.source is None or second.source is None:
        return second.like(scale=scale)
    data = begun_with(first.source, second.source)
    if data is second.source:
        return second.like(scale=scale)
    if first.source.factors:
        data = times_each(data, first.source.factors)
    numbers = data.acceleration, data.time_step, scale, None, second.reverse, second.start
    return Record(*numbers, data)


def read_scaling(table: Table, directory: Path) -> RecordScaling | None:
    """Read the keys of the size of a record.

    Parameters
    ----------
    table : Table
        ``[excitation]``.
    directory : Path
        Of the case.

    Returns
    -------
    RecordScaling or None
        None where there are problems; they are noted.
    """
    dimensions = {
        "scale": Dimension.NUMBER,
        "pga": Dimension.ACCELERATION,
        "psa": Dimension.ACCELERATION,
    }
    positive = "a positive number; reverse turns a motion round"
    each_of = next((way for way in dimensions if isinstance(table.data.get(way), list)), "")
    each = _read_each(table, each_of, dimensions[each_of], positive) if each_of else ()
    scale, pga, psa = (
        None if way == each_of else table.optional_quantity(way, of, positive)
        for way, of in dimensions.items()
    )
    at = own_period(table)
    # The scene is not known yet; `for_scene` puts its period in this place.
    period = 1.0 if at else table.optional_quantity("psa_period", Dimension.TIME, positive)
    damping = table.optional_quantity("psa_damping", Dimension.NUMBER)
    if damping is not None:
        table.require("psa_damping", not (damping < 0.0 or damping >= 1.0), "0 to below 1")
    given = [way for way in WAYS if table.has(way)]
    if len(given) > 1:
        table.reject(given[-1] if given[-1] != "pga" else "scale", f"one of {', '.join(WAYS)}")
        return None
    if not table.has("psa"):
        for key in ("psa_period", "psa_damping"):
            if table.has(key):
                table.reject(key, "a psa beside it")
    if (psa is not None or each_of == "psa") and period is None:
        table.report_missing("psa_period", 'the period of psa (s), or "T1" for that of the scene')
        return None
    target = _read_target(table, directory)
    given_limit = table.optional_quantity("largest_scale", Dimension.NUMBER, "a positive number")
    limit = LARGEST_SCALE if given_limit is None else given_limit
    numbers = [value for value in (scale, pga, psa, period, damping, limit) if value is not None]
    wrong = any(math.isnan(n) or n < 0.0 for n in numbers) or (table.has("target") and not target)
    if wrong or (each_of and not each):
        return None
    return RecordScaling(scale, pga, psa, period, damping, target, at, limit, each, each_of)


def _read_each(table: Table, key: str, dimension: Dimension, accepted: str) -> tuple[float, ...]:
    """Numbers of the records of a sequence; empty where one is wrong, which is noted."""
    assert table.has(key)
    try:
        given: Any = table.data[key]
        found = tuple(quantity(value, dimension) for value in given)
    except InputError as error:
        table.report(key, str(error))
        return ()
    table.require(key, bool(found) and min(found, default=0.0) > 0.0, f"a list of {accepted}")
    return found if min(found, default=0.0) > 0.0 else ()


def large_scales(factors: Sequence[tuple[str, float]], limit: float) -> str:
    """A sentence on records that are scaled by more than a limit; empty where none is.

    Parameters
    ----------
    factors : sequence of tuple of str and float
        Name and factor of the record of each run.
    limit : float
        The limit.
    """
    over = sorted(((abs(f), name) for name, f in factors if abs(f) > limit), reverse=True)
    if not over:
        return ""
    largest: dict[str, float] = {}
    for factor, name in over:
        largest.setdefault(name, factor)
    each = [f"{name} times {factor:.3g}" for name, factor in largest.items()]
    # Of an intensity each record has many factors: its largest says enough.
    several = len({name for name, _ in factors}) < len(factors)
    most = _MOST_NAMED if several else len(each)
    more = f" and {len(each) - most} more" if len(each) > most else ""
    count = f"{len(over)} of {len(factors)}"
    who = f"{count} runs scale their record" if several else f"{count} records are scaled"
    if len(factors) == 1:
        who = "the record is scaled"
    named = ", ".join(each[:most]) + more
    return f"{who} by more than {limit:g} (largest_scale in [excitation]): {named}"


def own_period(table: Table) -> str:
    """What ``psa_period`` calls a period of the scene; empty where it does not."""
    given = table.data.get("psa_period")
    named = isinstance(given, str) and (given == T_1 or given.startswith(f"{T_1} of "))
    return str(given) if named and table.has("psa_period") else ""


def _read_target(table: Table, directory: Path) -> Target | None:
    """The target of ``target``; None without one, and where it has problems, which are noted."""
    if not table.has("target"):
        for key in ("target_periods", "target_damping"):
            if table.has(key):
                table.reject(key, "a target beside it")
        return None
    damping = table.quantity("target_damping", Dimension.NUMBER, DAMPING)
    table.require("target_damping", not (damping < 0.0 or damping >= 1.0), "0 to below 1")
    points = _points(table, directory)
    between = _between(table)
    if points is None or between is None or not 0.0 <= damping < 1.0:
        return None
    low, high = between
    if not points[0][0] <= low < high <= points[0][-1]:
        table.reject(
            "target_periods",
            f"two rising periods between {points[0][0]:g} and {points[0][-1]:g} s, "
            "where the target ends",
        )
        return None
    return Target(*points, low, high, damping)


def _points(table: Table, directory: Path) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    """Periods (s) and PSA (m/s^2) of a target."""
    given: Any = table.data["target"]
    try:
        if isinstance(given, str):
            period, psa = read_target_file(find_record(given, directory))
        else:
            pairs = [
                (quantity(t, Dimension.TIME), quantity(a, Dimension.ACCELERATION)) for t, a in given
            ]
            period, psa = _checked(np.array([t for t, _ in pairs]), np.array([a for _, a in pairs]))
    except InputError as error:
        table.report("target", str(error))
        return None
    except (TypeError, ValueError):
        table.reject("target", _TARGET)
        return None
    return tuple(period.tolist()), tuple(psa.tolist())


def read_target_file(path: Path) -> tuple[Floats, Floats]:
    """Points of a target spectrum from a CSV file.

    Parameters
    ----------
    path : Path
        With columns period (s) and PSA_g (g).

    Returns
    -------
    tuple of ndarray, shape (n,)
        Periods (s) and PSA (m/s^2).

    Raises
    ------
    InputError
        Where it cannot be read, or is no spectrum.
    """
    cells = read_columns(path)
    missing = [name for name in ("period", "PSA_g") if name not in cells]
    if missing:
        raise InputError(
            f"{path}: no column {', '.join(missing)}; accepted: columns period (s) and PSA_g (g)"
        )
    period, psa = (to_numbers(path, name, cells[name]) for name in ("period", "PSA_g"))
    return _checked(period, psa * STANDARD_GRAVITY, f"{path}: ")


def _checked(period: Floats, psa: Floats, where: str = "") -> tuple[Floats, Floats]:
    """Points that are a spectrum."""
    rising = period.size > 1 and bool((np.diff(period) > 0.0).all()) and period[0] > 0.0
    if not (rising and np.isfinite(period).all() and np.isfinite(psa).all() and (psa > 0.0).all()):
        raise InputError(
            f"{where}accepted: two points or more, periods rising, all numbers positive"
        )
    return period, psa


def _between(table: Table) -> tuple[float, float] | None:
    """The two periods of ``target_periods`` (s)."""
    if not table.has("target_periods"):
        table.report_missing("target_periods", _BETWEEN)
        return None
    try:
        given: Any = table.data["target_periods"]
        low, high = (quantity(v, Dimension.TIME) for v in given)
    except (InputError, TypeError, ValueError):
        table.reject("target_periods", _BETWEEN)
        return None
    return low, high
