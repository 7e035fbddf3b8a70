"""The table ``[pi]``: a case written in Π-terms alone.

Ground motion and structure are then without dimension: any a_g and omega_g
serve, and where ``[excitation]`` gives none they are 1 m/s^2 and 1 rad/s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise

from eventpound.case.case import PiTable
from eventpound.case.excitation import Excitation
from eventpound.case.table import Table
from eventpound.scene.body import Body
from eventpound.scene.check import check_scene
from eventpound.scene.contact import BARRIER
from eventpound.scene.pi_structure import Kind, PiStructure
from eventpound.scene.pi_terms import OTHERS
from eventpound.scene.scene import Scene
from eventpound.units import Dimension

_UNIT_SCALES = {"amplitude": 1.0, "period": 2.0 * math.pi}
OF_SCENE = (
    "body", "spring", "dashpot", "rayleigh", "modal_damping", "contact", "support", "force",
    "seat", "deck", "joint", "pier", "bearing",
)  # fmt: skip
"""Tables of a scene in a case."""
_OF_NEIGHBOURS = ("m", "omega_s", "uy", "Q")
PLACEHOLDER = Scene((Body("0", math.nan),))


def with_unit_scales(document: Mapping[str, object]) -> Mapping[str, object]:
    """Tables of a case, with a_g = 1 m/s^2 and omega_g = 1 rad/s if ``[pi]`` leaves them open.

    Parameters
    ----------
    document : mapping
        As tomllib gives it.
    """
    excitation = document.get("excitation")
    if "pi" not in document or not isinstance(excitation, dict):
        return document
    if excitation.get("kind") in ("record", "none"):
        return document
    scales = dict(_UNIT_SCALES)
    if "frequency" in excitation:
        del scales["period"]
    return {**document, "excitation": scales | excitation}


def read_pi(top: Table) -> PiTable | None:
    """Read ``[pi]``.

    Parameters
    ----------
    top : Table
        The whole case.

    Returns
    -------
    PiTable or None
        None where there are problems; they are noted.
    """
    table = top.table("pi")
    for kind in OF_SCENE:
        if top.has(kind):
            top.report(f"[[{kind}]]", "found beside [pi], which says the whole case; drop either")
    words = [kind.word for kind in Kind]
    word = table.choice("structure", words)
    row = _read_row(table)
    names = [place for place in row if place != BARRIER]
    keys = ["omega_s", "uy", "Q", "delta", "epsilon"]
    keys += [f"{term}.{i}" for term in _OF_NEIGHBOURS for i in (OTHERS, *names) if i != "0"]
    keys += [
        f"{term}.{left}-{right}" for term in ("delta", "epsilon") for left, right in pairwise(row)
    ]
    given = {key: table.optional_quantity(key, Dimension.NUMBER) for key in keys}
    terms = {key: value for key, value in given.items() if value is not None}
    positive = "a positive number of periods 2 pi / omega_g"
    periods = table.optional_quantity("periods", Dimension.NUMBER, positive)
    table.close()
    if not word:
        return None
    with table.noting(""):
        return PiTable(PiStructure(Kind[word.upper()], row), terms, periods)
    return None


def _read_row(table: Table) -> tuple[str, ...]:
    """The row; without one, oscillator 0 beside a barrier where a gap or restitution is given."""
    if not table.has("row"):
        touching = "delta" in table.data or "epsilon" in table.data
        return ("0", BARRIER) if touching else ("0",)
    row = table.data["row"]
    if isinstance(row, list) and all(isinstance(p, int) or p == BARRIER for p in row):
        return tuple(str(place) for place in row)
    table.reject("row", f'numbers of oscillators from left to right, "{BARRIER}" at either end')
    return ()


def scene_of_pi(top: Table, pi: PiTable | None, excitation: Excitation | None) -> Scene:
    """Scene of a case in Π-terms; what is wrong with it is noted.

    Parameters
    ----------
    top : Table
        The whole case.
    pi : PiTable or None
        Its terms; None, like no excitation, where they have problems.
    excitation : Excitation or None
        Its ground motion.
    """
    if pi is None or excitation is None or any(math.isnan(term) for term in pi.terms.values()):
        return PLACEHOLDER
    try:
        with top.noting("[pi]"):
            scene = pi.structure.scene(excitation.motion, pi.terms)
            check_scene(scene)
            return scene
    except ArithmeticError:
        top.report("[pi]", "these terms make a number of the case too large or too small")
    return PLACEHOLDER


def with_periods(run: Table, pi: PiTable | None, scene: Scene) -> Table:
    """The table ``[run]`` with a duration of so many periods of the ground motion.

    Parameters
    ----------
    run : Table
        As it is given.
    pi : PiTable or None
        Perhaps with a length in periods 2 pi / omega_g.
    scene : Scene
        With the ground motion.
    """
    scales = scene.motion.scales()
    if pi is None or pi.periods is None:
        return run
    if run.has("duration"):
        run.reject("duration", "one of duration and [pi] periods")
    elif scales is not None:
        run.data = {**run.data, "duration": pi.periods * scales.period}
    return run
