"""``[[rayleigh]]`` and ``[[modal_damping]]``: damping of groups of bodies, or of named springs.

A group of ``bodies`` has C = a M + b K, K of the springs between them and to the ground;
``springs`` that are named have C = b K of these alone, such as the storeys on isolators.
Modal damping of a group is `eventpound.scene.modal_damping`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from eventpound.case.frequency import optional_frequency
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene.at_rest import stiffness_of
from eventpound.scene.body import Body
from eventpound.scene.damping import (
    dashpots_beside,
    rayleigh_coefficients,
    rayleigh_dashpots,
    springs_of_group,
)
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.grounded import ends_on_ground
from eventpound.scene.modal_damping import modal_dashpots, springs_on
from eventpound.scene.modes import coefficient_at_mode, modes_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Spring
from eventpound.units import Dimension, quantity


def read_group_damping(
    rayleigh: Sequence[Table],
    modal: Sequence[Table],
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    supports: Sequence[str] = (),
) -> tuple[Dashpot, ...]:
    """Dashpots from the ``[[rayleigh]]`` and ``[[modal_damping]]`` tables.

    Parameters
    ----------
    rayleigh, modal : sequence of Table
        One a group.
    bodies, springs : sequence
        Those of the scene at rest.
    supports : sequence of str
        Names of supports, which count as the ground.

    Returns
    -------
    tuple of Dashpot
        What the groups add to the scene.
    """
    taken: set[str] = set()
    damped: set[str] = set()
    standing = [
        replace(spring, between=ends_on_ground(spring.between, supports)) for spring in springs
    ]
    dashpots: list[Dashpot] = []
    for table in [*rayleigh, *modal]:
        key = "bodies"
        if table in modal:
            group = _read_group(table, bodies, taken)
            beside, made = _read_modal(table, group, bodies, springs, supports)
            dashpots += made
        elif table.has("springs"):
            key, beside = "springs", _read_springs(table, springs)
            b = _read_stiffness_coefficient(table, beside, bodies, standing)
            dashpots += () if math.isnan(b) else dashpots_beside(beside, b)
        else:
            group = _read_group(table, bodies, taken)
            a, b = _read_coefficients(table, group, standing)
            ground = _ground_of(table, supports)
            beside = springs_of_group([body.name for body in group], standing) if b > 0.0 else []
            if not math.isnan(a + b):
                dashpots += rayleigh_dashpots(group, springs, a, b, supports, ground)
        table.close()
        names = dict.fromkeys(spring.name for spring in beside)
        for name in names.keys() & damped:
            table.report(key, f"damps spring {name!r} again; accepted: every spring in one group")
        damped |= names.keys()
    return tuple(dashpots)


def _read_springs(table: Table, springs: Sequence[Spring]) -> list[Spring]:
    """Springs that a group names."""
    by_name = {spring.name: spring for spring in springs}
    names = table.texts("springs", "a list of names of springs")
    if table.has("bodies"):
        table.reject("bodies", "one of bodies and springs")
    for name in names:
        if name not in by_name:
            table.report("springs", f"found {name!r}; accepted: some of {', '.join(by_name)}")
        elif stiffness_of(by_name[name]) == 0.0:
            table.report("springs", f"found {name!r}; accepted: springs that resist at rest")
    if len(set(names)) < len(names):
        table.reject("springs", "every spring once")
    return [by_name[name] for name in dict.fromkeys(names) if name in by_name]


_WHERE = ("mode", "period", "frequency")
"""Where a ratio of springs holds."""


def _read_stiffness_coefficient(
    table: Table, named: Sequence[Spring], bodies: Sequence[Body], standing: Sequence[Spring]
) -> float:
    """Coefficient b (s) of the springs of a group; NaN where it could not be read."""
    b = table.optional_quantity("stiffness_coefficient", Dimension.TIME)
    where = [key for key in _WHERE if table.has(key)]
    if b is not None:
        table.require("stiffness_coefficient", not b < 0.0, "a coefficient that is not negative")
        for key in ["ratio"] * table.has("ratio") + where:
            table.reject(key, f"ratio with one of {', '.join(_WHERE)}, or stiffness_coefficient")
        return b
    ratio = table.quantity("ratio", Dimension.NUMBER)
    table.require("ratio", not ratio < 0.0, "a ratio that is not negative")
    key = table.one_of(_WHERE)
    if not key:
        return math.nan
    if key != "mode":
        omega, _ = optional_frequency(table) or (math.nan, math.nan)
        table.require(key, omega != 0.0, "a positive frequency (rad/s)")
        return 2.0 * ratio / omega if omega else math.nan
    stiffnesses = [stiffness_of(spring) for spring in standing]
    usable = all(body.mass > 0.0 for body in bodies) and not any(map(math.isnan, stiffnesses))
    if not (usable and named):
        # What is wrong is said where it stands.
        return math.nan
    names = [spring.name for spring in named]
    try:
        return coefficient_at_mode(bodies, standing, names, ratio, table.data["mode"])
    except InputError as error:
        table.report("mode", str(error))
        return math.nan


def _read_modal(
    table: Table,
    group: Sequence[Body],
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    supports: Sequence[str],
) -> tuple[list[Spring], tuple[Dashpot, ...]]:
    """Springs of a group with modal damping, and its dashpots; none where something is wrong."""
    names = [body.name for body in group]
    others = [body.name for body in bodies if body.name not in names]
    base, ratios = GROUND, _read_ratios(table, len(group))
    if table.has("base"):
        base = table.text("base", "what the bodies stand on")
        if base not in (GROUND, *supports, *others):
            table.reject("base", f"one of {', '.join([GROUND, *supports, *others])}")
            return [], ()
    beside = springs_on(names, springs, {GROUND, base, *supports})
    usable = all(body.mass > 0.0 for body in group) and not any(
        math.isnan(stiffness_of(spring)) for spring in beside
    )
    if not (ratios and usable):
        # What is wrong is said where it stands.
        return beside, ()
    try:
        return beside, modal_dashpots(group, springs, ratios, base, supports)
    except InputError as error:
        table.report("bodies", str(error).removeprefix("bodies: "))
        return beside, ()


def _read_ratios(table: Table, modes: int) -> list[float]:
    """Ratios of the lowest modes of a group; empty where they are wrong."""
    if not table.has("ratio"):
        table.report_missing("ratio", "a ratio, or a list of one for each mode")
        return []
    given = table.data["ratio"]
    try:
        found = [
            quantity(r, Dimension.NUMBER) for r in (given if isinstance(given, list) else [given])
        ]
    except InputError as error:
        table.report("ratio", str(error))
        return []
    if not (0 < len(found) <= max(modes, 1) and min(found) >= 0.0):
        table.reject("ratio", f"a ratio that is not negative, or a list of at most {modes}")
        return []
    return found


def _ground_of(table: Table, supports: Sequence[str]) -> str:
    """The end from which the mass part of a group acts: the ground, or the support it names."""
    if not table.has("support"):
        return GROUND
    name = table.text("support", "the name of a support")
    if name not in (GROUND, "", *supports):
        table.reject("support", f"one of {', '.join([GROUND, *supports])}")
    return name if name in supports else GROUND


def _read_group(table: Table, bodies: Sequence[Body], taken: set[str]) -> list[Body]:
    """Bodies of one group; their names are added to those taken."""
    by_name = {body.name: body for body in bodies}
    names = table.texts("bodies", "a list of names of bodies")
    for name in names:
        if name not in by_name:
            table.report("bodies", f"found {name!r}; accepted: some of {', '.join(by_name)}")
        elif name in taken:
            table.report("bodies", f"found {name!r} again; accepted: every body in one group only")
        taken.add(name)
    return [by_name[name] for name in names if name in by_name]


def _read_coefficients(
    table: Table, group: Sequence[Body], springs: Sequence[Spring]
) -> tuple[float, float]:
    """Coefficients a (1/s) and b (s) of one group; NaN where they could not be read."""
    a = table.optional_quantity("mass_coefficient", Dimension.RATE)
    b = table.optional_quantity("stiffness_coefficient", Dimension.TIME)
    for key, value in (("mass_coefficient", a), ("stiffness_coefficient", b)):
        if value is not None and value < 0.0:
            table.reject(key, "a coefficient that is not negative")
    if a is not None or b is not None:
        for key in ("ratio", *_TWO):
            if table.has(key):
                table.reject(key, f"ratio with one of {', '.join(_TWO)}, or the two coefficients")
        return a or 0.0, b or 0.0
    ratio = table.quantity("ratio", Dimension.NUMBER)
    table.require("ratio", not ratio < 0.0, "a ratio that is not negative")
    omegas = _read_two_frequencies(table, group, springs)
    return rayleigh_coefficients(ratio, *omegas)


_TWO = ("frequencies", "periods", "modes")
"""Where a ratio holds."""


def _read_two_frequencies(
    table: Table, group: Sequence[Body], springs: Sequence[Spring]
) -> tuple[float, float]:
    key = table.one_of(_TWO, ", a list of two")
    if not key:
        return math.nan, math.nan
    values = table.data[key]
    if not isinstance(values, list) or len(values) != 2:
        table.reject(key, f"a list of two {key}")
        return math.nan, math.nan
    if key == "modes":
        return _frequencies_of_modes(table, values, group, springs)
    dimension = Dimension.ANGULAR_FREQUENCY if key == "frequencies" else Dimension.TIME
    try:
        first, second = (quantity(value, dimension) for value in values)
    except InputError as error:
        table.report(key, str(error))
        return math.nan, math.nan
    if min(first, second) <= 0.0:
        table.reject(key, f"two positive {key}")
        return math.nan, math.nan
    if key == "frequencies":
        return first, second
    return 2.0 * math.pi / first, 2.0 * math.pi / second


def _frequencies_of_modes(
    table: Table, numbers: Sequence[object], group: Sequence[Body], springs: Sequence[Spring]
) -> tuple[float, float]:
    """Angular frequencies (rad/s) of two modes of a group at rest."""
    chosen = [n for n in numbers if isinstance(n, int) and not isinstance(n, bool)]
    if len(chosen) < 2 or not 1 <= min(chosen) <= max(chosen) <= len(group):
        table.reject("modes", f"two numbers of modes, from 1 to {len(group)}")
        return math.nan, math.nan
    scene, names = Scene(tuple(group), tuple(springs)), [body.name for body in group]
    try:
        first, second = modes_of(scene, names).period[[n - 1 for n in chosen]].tolist()
    except InputError:
        # A mass or a stiffness is wrong, which is said where it stands.
        return math.nan, math.nan
    if not math.isfinite(max(first, second)):
        table.reject("modes", "modes that a spring resists")
        return math.nan, math.nan
    return 2.0 * math.pi / first, 2.0 * math.pi / second
