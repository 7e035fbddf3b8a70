"""What all runs of a study have in common, in words: Π-terms that stay, and the end time."""

from __future__ import annotations

from collections.abc import Callable

from eventpound.motion.record import Record
from eventpound.motion.scaling import DAMPING
from eventpound.study.axes import PI
from eventpound.study.plan import PART, Base, Plan


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


def _of_base(base: Base, symbol: Callable[[str], str]) -> list[str]:
    """Fixed Π-terms of one scene and the end of its runs."""
    varied = {axis.key for axis in base.axes} | set(base.labels)
    texts = []
    motion = base.case.scene.motion
    if "excitation.psa" in varied and isinstance(motion, Record) and motion.psa_period:
        damping = DAMPING if motion.psa_damping is None else motion.psa_damping
        texts.append(f"PSA at T = {motion.psa_period:g} s, {100.0 * damping:g} % damping")
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
