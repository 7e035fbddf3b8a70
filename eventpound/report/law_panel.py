"""Spring laws as pictures: force against elongation, with the parameters of the law."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from eventpound.mechanics.link_law import link_law
from eventpound.numerics.arrays import Floats
from eventpound.quantities.loops import z_by_x
from eventpound.report.style import PALETTE, literal, say, zero_lines
from eventpound.results.shown_units import unit_by_size
from eventpound.scene.elastic_laws import elastic_force, reduced
from eventpound.scene.spring import BoucWen, Hysteretic, Law, Linear, Spring
from eventpound.units import Dimension

_MOST = 4
"""Laws in one figure."""
_REACH, _STEPS = 3.0, 200
"""Of a loop, in yield displacements, and steps a yield displacement."""
_TIMES = 3
"""That a loop is gone round which changes."""


def laws_shown(springs: Iterable[Spring]) -> list[tuple[str, Law]]:
    """Laws that differ, with the names of their springs; of too many the first of each kind.

    Parameters
    ----------
    springs : iterable of Spring
        Those of a scene.

    Returns
    -------
    list of tuple
        Empty where all are linear: one stiffness is no picture.
    """
    names: dict[Law, list[str]] = {}
    for spring in springs:
        names.setdefault(spring.law, []).append(spring.name)
    if all(isinstance(law, Linear) for law in names):
        return []
    if len(names) <= _MOST:
        return [(_called(of_law), law) for law, of_law in names.items()]
    kinds: dict[type, list[Law]] = {}
    for law in names:
        kinds.setdefault(type(law), []).append(law)
    found = []
    for first, *others in kinds.values():
        more = f", one of {1 + len(others)} such laws" if others else ""
        found.append((_called(names[first]) + more, first))
    return found


def _called(names: list[str]) -> str:
    return ", ".join(names) if len(names) < 3 else f"{names[0]} and {len(names) - 1} more"


def draw_law(axes: Axes, law: Law, name: str) -> None:
    """Draw a law, its parameters below it.

    Parameters
    ----------
    axes : Axes
        Without numbers: sizes are in what is said below.
    law : one of the laws
        Of a spring; a hysteretic one as its loop from rest.
    name : str
        Above it.
    """
    zero_lines(axes, upright=True)
    if isinstance(law, BoucWen):
        x, force = _loop(law)
        said = _of_loop(axes, law)
    elif isinstance(law, Hysteretic):
        x, force = map(np.array, law.drawn())
        words = [f"{_SAID[key][0]} = {_SAID[key][1](x)}" for key, x in law.numbers.items()]
        said = "\n".join(", ".join(words[i : i + 2]) for i in range(0, len(words), 2))
    else:
        whole = reduced(law)
        x = whole.offset + np.array([-1.0, 0.0, 1.0]) * (2.0 * abs(whole.offset) or 1.0)
        force, _ = elastic_force(whole, x)
        pair = whole.compression, whole.extension
        said = f"k = {_STIFFNESS(pair[0])}"
        if not isinstance(law, Linear):
            said = f"compression {_STIFFNESS(pair[0])}\nextension {_STIFFNESS(pair[1])}"
        if whole.offset:
            axes.plot(whole.offset, 0.0, ".", color="#888888", markersize=4.0)
            said += f"\noffset {_LENGTH(abs(whole.offset))}{' (closing)' * (whole.offset < 0.0)}"
    color = PALETTE[0] if isinstance(law, Hysteretic) else PALETTE[1]
    axes.plot(x, force, color="#333333" if isinstance(law, Linear) else color, linewidth=1.2)
    axes.set_title(literal(name), fontsize=8.0)
    axes.set_xlabel(f"elongation\n{said}", fontsize=7.0)
    axes.set_ylabel("force", fontsize=7.0)
    axes.set(box_aspect=0.85, xticks=[], yticks=[])


def _of_loop(axes: Axes, law: BoucWen) -> str:
    """Mark what is told of a loop; its parameters."""
    first = law.initial_stiffness
    yields = law.yield_displacement, first * law.yield_displacement
    end = _REACH * law.yield_displacement
    back: Any = {"color": "#888888", "linewidth": 0.8, "linestyle": "--"}
    axes.plot([0.0, yields[0]], [law.strength, yields[1]], **back)
    axes.plot([yields[0]] * 2, [0.0, yields[1]], **back)
    for text, place, away in (
        ("$Q$", (0.0, law.strength), (-3, 1)),
        ("$u_y$", (yields[0], 0.0), (0, -3)),
        ("$K_0$", (0.5 * yields[0], 0.5 * yields[1]), (-3, 1)),
        ("$F_y$", yields, (-1, 2)),
        ("$K_s$", (0.7 * end, law.strength + 0.7 * end * law.stiffness), (0, 3)),
    ):
        say(axes, text, place, away, fontsize=8.0)
    axes.margins(y=0.14)
    return (
        f"$K_0$ = {_STIFFNESS(first)}, $K_s$ = {_STIFFNESS(law.stiffness)}\n"
        f"$Q$ = {_FORCE(law.strength)}, $u_y$ = {_LENGTH(law.yield_displacement)}"
    )


def _loop(law: BoucWen) -> tuple[Floats, Floats]:
    """Elongations (m) and forces (N) from rest to one end, to the other and back; again if worn."""
    step, two = law.yield_displacement / _STEPS, bool(law.second)
    away, times = round(_REACH * _STEPS), _TIMES if two else 1
    ways, lengths = [step, *[-step, step] * times], [away, *[2 * away] * 2 * times]
    steps, beside = np.repeat(ways, lengths), 0.0
    z, memory = np.zeros(steps.size + 1), link_law([law], [0.0, 0.0], {0: 1} if two else {}).memory
    for i, dx in enumerate(steps.tolist()):
        z[i + 1] = z[i] + dx * z_by_x(memory, z[i], dx, beside)
        if two:
            beside += dx * float(z_by_x(memory, beside, dx, z[i + 1], of=1))
    x = np.concatenate([[0.0], np.cumsum(steps)])
    return x, law.stiffness * x + law.strength * z


def _in(dimension: Dimension) -> Callable[[float], str]:
    """Numbers of a dimension in the unit of their size."""
    return lambda value: unit_by_size(dimension, value).of(value)


_STIFFNESS, _FORCE, _LENGTH = map(_in, (Dimension.STIFFNESS, Dimension.FORCE, Dimension.LENGTH))
_SAID: dict[str, tuple[str, Callable[[float], str]]] = {
    "K0": ("$K_0$", _STIFFNESS),
    "K_s": ("$K_s$", _STIFFNESS),
    "Q": ("$Q$", _FORCE),
    "friction": (r"$\mu$", "{:.4g}".format),
    "N": ("$N$", _FORCE),
    "T_slip": ("$T$", "{:.4g} s".format),
    "F_ult": ("$F_{ult}$", _FORCE),
    "R_f": ("$R_f$", "{:.4g}".format),
    "gap": ("gap", _LENGTH),
    "y_ult": ("$y_{ult}$", _LENGTH),
}
"""Numbers of laws: their signs, and how they are said."""
