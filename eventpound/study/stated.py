"""What all runs of a study have in common, in words: Π-terms that stay, and the end time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from eventpound.motion.record import Record
from eventpound.motion.scaling import DAMPING
from eventpound.study.axes import PI
from eventpound.study.base import PART, Base
from eventpound.study.plan import Plan
from eventpound.study.variants import PSA_PERIOD

PSA = "excitation.psa"


def stated(study: Plan, symbol: Callable[[str], str]) -> list[str]:
    """Lines that state what is the same in all runs, and of each part what it has beyond that.

    Parameters
    ----------
    study : Plan
        The study.
    symbol : callable
        How a column of its table is called.

    Returns
    -------
    list of str
        At least one.
    """
    each = [_of_base(base, symbol) for base in study.bases]
    common = [text for text in each[0] if all(text in texts for texts in each)]
    lines = [", ".join([*common, f"solver {study.solver}, rtol {study.rtol:g}"])]
    own: dict[tuple[str, ...], list[str]] = {}
    for base, texts in zip(study.bases, each, strict=True):
        rest = tuple(text for text in texts if text not in common)
        name = str(base.labels.get(PART, ", ".join(str(v) for v in base.labels.values())))
        if rest and name not in own.setdefault(rest, []):
            own[rest].append(name)
    return [*lines, *(f"{', '.join(names)}: {', '.join(rest)}" for rest, names in own.items())]


def measured_at(study: Plan) -> dict[str, str]:
    """Period and damping of the PSA of a study, by its column; nothing where they vary."""
    varied = {axis.key for base in study.bases for axis in base.axes}
    found = {psa_at(_excitation(base)) for base in study.bases}
    return {PSA: found.pop()} if len(found) == 1 and PSA_PERIOD not in varied else {}


def psa_at(excitation: Mapping[str, Any]) -> str:
    """Period and damping of the PSA that ``[excitation]`` scales to; empty where it does not."""
    period, damping = excitation.get("psa_period"), excitation.get("psa_damping")
    if period is None:
        return ""
    at = f"{period:.4g} s" if isinstance(period, float) else str(period)
    return f"{at}, {100.0 * (DAMPING if damping is None else damping):g} %"


def _excitation(base: Base) -> Mapping[str, Any]:
    found: Any = base.case.understood.get("excitation", {})
    return dict(found)


def _of_base(base: Base, symbol: Callable[[str], str]) -> list[str]:
    """Fixed Π-terms of one scene and the end of its runs."""
    varied = {axis.key for axis in base.axes} | set(base.labels)
    texts = []
    motion = base.case.scene.motion
    if PSA in varied and PSA_PERIOD not in varied and (at := psa_at(_excitation(base))):
        texts.append(f"PSA at {at} damping")
    pi = base.case.pi
    if pi is not None:
        texts += [
            f"{symbol(PI + key)} = {value:g}"
            for key, value in pi.terms.items()
            if PI + key not in varied
        ]
        if pi.periods is not None:
            return [*texts, rf"end at $t = {pi.periods:g}\,T_g$"]
    if base.own_duration:
        return [*texts, f"end at t = {base.case.run.start_time + base.case.run.duration:g} s"]
    if base.records or isinstance(motion, Record):
        return [*texts, r"end $5\,T_1$ after the record"]
    return [*texts, r"end $4\,T_g$ after the motion"]
