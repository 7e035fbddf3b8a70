"""How the columns of a study are called at an axis and in a legend: one table of quantities.

A key is ``<kind>.<name of a body, spring or contact>.<quantity>``, ``<kind>.<quantity>`` or a
word by itself; kind and quantity decide what it is called and its unit, the name in between is
said as it is. Π-terms have symbols instead.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from eventpound.case.run_options import options
from eventpound.quantities.base import parts_of
from eventpound.quantities.listed import LISTED
from eventpound.report.style import literal
from eventpound.results.files import plain_name
from eventpound.results.shown_units import GRAVITY, Unit, unit_by_size
from eventpound.results.tables import headed
from eventpound.scene.parameters import dimension_of_number
from eventpound.units import Dimension

_Called = tuple[str, Dimension]
"""What a quantity is called, and its unit."""

_TERMS = {
    "omega_s": (r"\Pi_{\omega_s%s}", r"\omega_s/\omega_g"),
    "uy": (r"\Pi_{u_y%s}", r"u_y\omega_g^2/a_g"),
    "Q": (r"\Pi_{Q%s}", r"Q/(m\,a_g)"),
    "m": (r"\Pi_{m%s}", r"m_0/m"),
    "delta": (r"\Pi_{\delta%s}", r"\delta\,\omega_g^2/a_g"),
    "epsilon": (r"\Pi_{\epsilon%s}", r"\epsilon"),
    "delay": (r"\Pi_{\tau%s}", r"\tau\,\omega_g"),
    "um": (r"\Pi_{um%s}", r"u_{max}\,\omega_g^2/a_g"),
}
_REVERSE = {"False": "normal", "True": "reverse"}


def _of_run() -> Iterator[tuple[tuple[str, str], _Called]]:
    """Quantities of runs by kind and what follows the owner's name, empty where nothing does."""
    for quantity in LISTED:
        before, _, after = parts_of(quantity.path)
        kind, _, rest = before.removesuffix(".").partition(".")
        called = quantity.symbol or quantity.called
        yield (kind, after.removeprefix(".") or rest), (called, quantity.dimension)


_OF_RUN: dict[tuple[str, str], _Called] = {
    **dict(_of_run()),
    ("L_e", ""): ("$L_e$", Dimension.LENGTH),
    ("PGA", ""): ("PGA", Dimension.ACCELERATION),
    ("PGV", ""): ("PGV", Dimension.VELOCITY),
    ("Sa_T1", ""): ("$S_a(T_1)$", Dimension.ACCELERATION),
    ("T_m", ""): ("$T_m$", Dimension.TIME),
    ("T_s", ""): ("$T_s$", Dimension.TIME),
    ("Q/m", ""): ("$Q/m$", Dimension.ACCELERATION),
    ("u_y", ""): ("$u_y$", Dimension.LENGTH),
    ("delta", ""): (r"$\delta$", Dimension.LENGTH),
    ("u_max", ""): ("$u_{max}$", Dimension.LENGTH),
    **{
        ("run", name): (key.called or name.replace("_", " "), key.dimension)
        for name, key in options()
        if key.dimension
    },
    **{("deck", name): (name, Dimension.LENGTH) for name in ("length", "width")},
    ("deck", "skew"): ("skew", Dimension.ANGLE),
    ("joint", "gap"): ("gap", Dimension.LENGTH),
    ("joint", "friction"): (r"$\mu$", Dimension.NUMBER),
    ("pi", "periods"): ("length of the run in periods", Dimension.NUMBER),
}
"""By kind and quantity, with those of a suite, of a dimensional spectrum and of keys of a case."""

_OF_CASE: dict[tuple[str, str], str] = {
    ("spring", "strength"): "$Q$",
    ("spring", "yield_displacement"): "$u_y$",
    ("spring", "exponent"): "$n$",
    ("spring", "beta"): r"$\beta$",
    ("spring", "gamma"): r"$\gamma$",
    ("spring", "initial_z"): "initial $z$",
    ("spring", "compression"): "stiffness in compression",
    ("spring", "extension"): "stiffness in extension",
    ("body", "displacement"): "initial displacement",
    ("body", "velocity"): "initial velocity",
    ("dashpot", "coefficient"): "damping coefficient",
    ("contact", "restitution"): r"$\epsilon$",
    ("contact", "damping"): "damping of the contact",
    ("excitation", "amplitude"): "$a_g$",
    ("excitation", "pga"): "PGA",
    ("excitation", "psa"): "PSA",
    ("excitation", "psa_period"): "period of PSA",
    ("excitation", "psa_damping"): "damping of PSA",
    ("excitation", "period"): "$T_g$",
    ("excitation", "scale"): "scale of the record",
    ("excitation", "start"): "start of the motion",
    ("excitation", "center"): "middle of the pulse",
    ("excitation", "time_step"): "time step of the record",
    ("excitation", "gamma"): r"$\gamma$ of the pulse",
    ("excitation", "phase"): "phase of the pulse",
}
"""Numbers of a case that are called otherwise than by their keys."""
_FREE = "free."
_IN_G = ("excitation.", "acceleration.", "PGA", "Sa_T1")
"""Beginnings of columns whose accelerations are read in g; a strength over a mass is not."""


def symbol(key: str) -> str:
    """Short name of a column, in mathtext where it has a symbol.

    Parameters
    ----------
    key : str
        Column of the table of a study.
    """
    found = _term(key)
    if found is not None:
        return f"${found[0]}$"
    called = _called(key)
    return key.removeprefix(_FREE) if called is None else called[0]


def display_unit(key: str, largest: float) -> Unit:
    """Unit in which values of a column are read most easily.

    Parameters
    ----------
    key : str
        Column of the table of a study or a suite.
    largest : float
        The largest of them (SI).
    """
    dimension = dimension_of(key)
    if dimension is Dimension.ACCELERATION and key.removeprefix(_FREE).startswith(_IN_G):
        return GRAVITY
    return unit_by_size(dimension, largest)


def axis_label(key: str, of: Unit | None = None, at: str = "") -> str:
    """Name of a column at an axis: its symbol, what it is and its unit.

    Parameters
    ----------
    key : str
        Column of the table of a study.
    of : Unit, optional
        Its unit, where it is not that of SI.
    at : str
        At what it is measured, as the period of a spectral acceleration.
    """
    found = _term(key)
    if found is not None:
        name, meaning = found
        # A ratio to another oscillator has a meaning of its own (eq. 16).
        return f"${name} = {meaning}$" if "," not in name else f"${name}$"
    called = _called(key)
    if called is None:
        return key
    name, unit = called
    unit = unit if of is None else of.name
    return headed(f"{name} at {at}" if at else name, unit)


def value_label(key: str, value: object) -> str:
    """A value of a column as a legend or a title has it.

    Parameters
    ----------
    key : str
        Column of the table of a study.
    value : object
        Word or number.
    """
    if isinstance(value, bool) or not isinstance(value, float | int):
        return _word(key, value) + (" pulse" if key == "excitation.kind" else "")
    called = None if _term(key) is not None else _called(key)
    if called is None:
        return f"{symbol(key)} = {value:g}"
    return f"{called[0]} = {display_unit(key, float(value)).of(value)}"


def plain_value(key: str, value: object) -> str:
    """A value of a column as the name of a file has it.

    Parameters
    ----------
    key : str
        Column of the table of a study.
    value : object
        Word or number.
    """
    if isinstance(value, float):
        return f"{value:.4g}"
    return plain_name(_word(key, value))


def _word(key: str, value: object) -> str:
    return _REVERSE.get(str(value), "") if key == "excitation.reverse" else str(value)


def dimension_of(key: str) -> Dimension:
    """Dimension of a column, a number where it is not known.

    Parameters
    ----------
    key : str
        Column of the table of a study or a suite.
    """
    found, _ = _found(key.removeprefix(_FREE))
    return Dimension.NUMBER if found is None or _term(key) is not None else found[1]


def _found(stem: str) -> tuple[_Called | None, str]:
    """What a column is called by itself, and whose it is."""
    kind, _, rest = stem.partition(".")
    owner, _, quantity = rest.rpartition(".")
    found = _OF_RUN.get((kind, quantity))
    dimension = dimension_of_number(stem)
    if dimension is not None and (kind, quantity) != ("contact", "stiffness"):
        # The unit of the stiffness of a contact is that of its law.
        found = _OF_CASE.get((kind, quantity), quantity), dimension
    return (found, owner) if found is not None else (_OF_RUN.get((kind, "")), rest)


def _called(key: str) -> tuple[str, str] | None:
    """Name, with that of what it belongs to, and unit of a quantity; None where not known."""
    stem = key.removeprefix(_FREE)
    found, owner = _found(stem)
    if found is None:
        return None
    name, dimension = found
    if owner:
        name += " of " + literal(owner.replace(".parts.", ", part "))
    if stem != key:
        name += " without contact"
    return name, dimension.unit.replace("^2", "²")


def _term(key: str) -> tuple[str, str] | None:
    """Symbol and meaning of a Π-term."""
    found = re.fullmatch(r"pi[._](\w+)(?:\.(.*))?", key.removeprefix(_FREE), re.DOTALL)
    if found is None or found[1] not in _TERMS:
        return None
    sign, meaning = _TERMS[found[1]]
    return sign % (rf",\,{_in_math(found[2])}" if found[2] else ""), meaning


def _in_math(name: str) -> str:
    """A name within a symbol, without what mathtext would obey."""
    plain = re.sub(r"[\\^~]", "-", name)
    return re.sub(r"([$_{}%#& ])", r"\\\1", plain)
