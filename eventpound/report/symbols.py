"""How the columns of a study are called at an axis and in a legend."""

from __future__ import annotations

from eventpound.results.files import plain_name

_TERMS = {
    "omega_s": (r"\Pi_{\omega_s%s}", r"\omega_s/\omega_g"),
    "uy": (r"\Pi_{u_y%s}", r"u_y\omega_g^2/a_g"),
    "Q": (r"\Pi_{Q%s}", r"Q/(m\,a_g)"),
    "m": (r"\Pi_{m%s}", r"m_0/m"),
    "delta": (r"\Pi_{\delta%s}", r"\delta\,\omega_g^2/a_g"),
    "epsilon": (r"\Pi_{\epsilon%s}", r"\epsilon"),
}
_UM = (r"\Pi_{um%s}", r"u_{max}\,\omega_g^2/a_g")
_OTHERS = {
    "amplification": "peak with contact / without",
    "impacts": "impacts",
    "resting_time": "resting time (s)",
}
_UNITS = {
    "excitation.amplitude": ("$a_g$", "m/s²"),
    "excitation.pga": ("PGA", "m/s²"),
    "excitation.period": ("$T_g$", "s"),
    "scales.a_g": ("$a_g$", "m/s²"),
    "scales.omega_g": (r"$\omega_g$", "rad/s"),
    "scales.L_e": ("$L_e$", "m"),
    "T_s": ("$T_s$", "s"),
    "Q/m": ("$Q/m$", "m/s²"),
    "u_y": ("$u_y$", "m"),
    "delta": (r"$\delta$", "m"),
    "u_max": ("$u_{max}$", "m"),
}
_WORDS = {
    ("excitation.reverse", "False"): "normal",
    ("excitation.reverse", "True"): "reverse",
}


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
    return key.removeprefix("free.")


def axis_label(key: str) -> str:
    """Name of a column at an axis: its symbol, what it is and its unit.

    Parameters
    ----------
    key : str
        Column of the table of a study.
    """
    found = _term(key)
    if found is not None:
        name, meaning = found
        # A ratio to another oscillator has a meaning of its own (eq. 16).
        return f"${name} = {meaning}$" if "," not in name else f"${name}$"
    if key in _OTHERS:
        return _OTHERS[key]
    if key in _UNITS:
        name, unit = _UNITS[key]
        return f"{name} ({unit})"
    if key.endswith(".abs_max"):
        return r"$u_{max}$ (m)"
    return key


def value_label(key: str, value: object) -> str:
    """A value of a column as a legend or a title has it.

    Parameters
    ----------
    key : str
        Column of the table of a study.
    value : object
        Word or number.
    """
    if isinstance(value, str) or (key, str(value)) in _WORDS:
        word = plain_value(key, value)
        return f"{word} pulse" if key == "excitation.kind" else word
    if key in _UNITS and isinstance(value, float | int):
        name, unit = _UNITS[key]
        return f"{name} = {value:.4g} {unit}"
    return f"{symbol(key)} = {value:g}" if isinstance(value, float | int) else str(value)


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
    return plain_name(_WORDS.get((key, str(value)), str(value)))


def _term(key: str) -> tuple[str, str] | None:
    """Symbol and meaning of a Π-term."""
    stem = key.removeprefix("free.")
    if stem == "pi_um" or stem.startswith("pi_um."):
        return _filled(_UM, stem.removeprefix("pi_um").removeprefix("."))
    if stem.startswith("pi."):
        term, _, which = stem.removeprefix("pi.").partition(".")
        if term in _TERMS:
            return _filled(_TERMS[term], which)
    return None


def _filled(pair: tuple[str, str], which: str) -> tuple[str, str]:
    return pair[0] % (rf",\,{which}" if which else ""), pair[1]
