"""The six parameters of a bilinear hysteretic spring, any three independent ones given.

    K_s = alpha K_0,    Q = (1 - alpha) F_y,    F_y = K_0 u_y      (so Q = (K_0 - K_s) u_y)

K_0 initial and K_s post-yield stiffness (N/m), Q strength and F_y yield force
(N), u_y yield displacement (m), alpha hardening ratio. Source: the founding
paper, section 2.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import StrEnum

from eventpound.errors import InputError

AGREEMENT = 1.0e-9
"""Relative difference up to which values given twice agree: the accuracy that is
promised by default, so that it cannot matter which of them is used."""


class Parameter(StrEnum):
    """A parameter, by the word a case gives it."""

    INITIAL_STIFFNESS = "initial_stiffness"
    STIFFNESS = "stiffness"
    STRENGTH = "strength"
    YIELD_FORCE = "yield_force"
    YIELD_DISPLACEMENT = "yield_displacement"
    HARDENING = "hardening"


OF_LAW = (Parameter.STIFFNESS, Parameter.STRENGTH, Parameter.YIELD_DISPLACEMENT)
"""Those that a law has, in its order."""
_Values = dict[Parameter, float]
_K0, _KS, _Q, _FY, _UY, _ALPHA = Parameter
_ACCEPTED: dict[Parameter, tuple[str, Callable[[float], bool]]] = {
    _K0: ("positive (N/m)", lambda x: x > 0.0),
    _KS: ("not negative (N/m)", lambda x: x >= 0.0),
    _Q: ("not negative (N)", lambda x: x >= 0.0),
    _FY: ("positive (N)", lambda x: x > 0.0),
    _UY: ("positive (m)", lambda x: x > 0.0),
    _ALPHA: ("from 0 to 1", lambda x: 0.0 <= x <= 1.0),
}

_RULES: tuple[tuple[Parameter, tuple[Parameter, ...], Callable[..., float]], ...] = (
    (_KS, (_ALPHA, _K0), lambda alpha, k_0: alpha * k_0),
    (_K0, (_KS, _ALPHA), lambda k_s, alpha: k_s / alpha),
    (_ALPHA, (_KS, _K0), lambda k_s, k_0: k_s / k_0),
    (_FY, (_K0, _UY), lambda k_0, u_y: k_0 * u_y),
    (_UY, (_FY, _K0), lambda f_y, k_0: f_y / k_0),
    (_K0, (_FY, _UY), lambda f_y, u_y: f_y / u_y),
    (_Q, (_ALPHA, _FY), lambda alpha, f_y: (1.0 - alpha) * f_y),
    (_FY, (_Q, _ALPHA), lambda q, alpha: q / (1.0 - alpha)),
    (_ALPHA, (_Q, _FY), lambda q, f_y: 1.0 - q / f_y),
    (_K0, (_KS, _Q, _UY), lambda k_s, q, u_y: k_s + q / u_y),
)


def bouc_wen_parameters(given: Mapping[Parameter, float]) -> Mapping[Parameter, float]:
    """Find all parameters from three or more that determine them.

    Parameters
    ----------
    given : mapping
        The parameters that are known (SI).

    Returns
    -------
    mapping
        All six (SI), the given ones as they are, the others computed from them.

    Raises
    ------
    InputError
        A value out of its range; too few or dependent parameters (what to add
        is named); more than three that disagree by more than `AGREEMENT`; a
        combination that softens (K_s > K_0, or K_s < 0).
    """
    _check_ranges(given)
    known = _determine(dict(given))
    missing = [p for p in Parameter if p not in known]
    if missing:
        raise InputError(_what_to_add(given, known))
    _check_agreement(given, known)
    for parameter in (_KS, _Q, _ALPHA):
        known[parameter] = max(known[parameter], 0.0)
    return known


def _check_ranges(given: Mapping[Parameter, float]) -> None:
    problems = [
        f"{parameter}: found {value!r}; accepted: {_ACCEPTED[parameter][0]}"
        for parameter, value in given.items()
        if not (math.isfinite(value) and _ACCEPTED[parameter][1](value))
    ]
    if problems:
        raise InputError(problems)


def _determine(known: _Values) -> _Values:
    """Apply the rules until none adds anything; one that divides by zero adds nothing."""
    progress = True
    while progress:
        progress = False
        for target, sources, rule in _RULES:
            if target in known or not all(source in known for source in sources):
                continue
            try:
                known[target] = rule(*(known[source] for source in sources))
            except ZeroDivisionError:
                continue
            progress = True
    return known


def _what_to_add(given: Mapping[Parameter, float], known: _Values) -> str:
    found = ", ".join(given) or "none of them"
    if len(given) < 3:
        return (
            f"found {found}; accepted: three independent ones of {', '.join(Parameter)} "
            "(initial_period may stand for initial_stiffness, post_yield_period or frequency "
            "for stiffness)"
        )
    # With any one trial value more, everything is determined or still not.
    trial = {p: 0.5 * math.pi * (1.0 + max(known.values())) for p in Parameter}
    trial[_ALPHA] = 1.0 / math.pi
    useful = [
        p for p in Parameter if p not in known and len(_determine({**known, p: trial[p]})) == 6
    ]
    return f"found {found}, which depend on one another; add one of {', '.join(useful)}"


def _check_agreement(given: Mapping[Parameter, float], known: _Values) -> None:
    """Compare every parameter with what the others say of it."""
    k_0, k_s, q, f_y, u_y, alpha = (known[p] for p in Parameter)
    for left, right, scale, statement in (
        (k_s, alpha * k_0, k_0, "stiffness = hardening x initial_stiffness"),
        (f_y, k_0 * u_y, f_y, "yield_force = initial_stiffness x yield_displacement"),
        (q, (1.0 - alpha) * f_y, f_y, "strength = (1 - hardening) x yield_force"),
    ):
        if abs(left - right) > AGREEMENT * scale:
            raise InputError(
                f"{', '.join(given)} disagree: {statement} would be {right:.10g}, not {left:.10g}; "
                "accepted: values that agree to 1e-9, or three of them"
            )
    if min(k_s / k_0, q / f_y) < -AGREEMENT:
        raise InputError(
            f"{', '.join(given)}: together they make stiffness = {k_s:.10g} N/m of an "
            f"initial_stiffness of {k_0:.10g} N/m; accepted: a stiffness from 0 to the initial one"
        )
