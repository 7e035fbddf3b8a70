"""Back to dimensions: traditional spectra from those in Π-terms, by similarity.

For a pulse of a_g and omega_g, and L_e = a_g / omega_g^2,

    u_max = Pi_um L_e        delta = Pi_delta L_e       u_y = Pi_uy L_e
    Q/m = Pi_Q a_g           T_s = 2 pi / (Pi_omega_s omega_g)

(the founding paper, end of section 5). One table in Π-terms so serves every
intensity and period of a pulse of its shape.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.base import Scales
from eventpound.quantities.lookup import FREE
from eventpound.study.axes import PI

if TYPE_CHECKING:
    import pandas as pd

_UM = "pi_um"
_NAMES = {"omega_s": "T_s", "Q": "Q/m", "uy": "u_y", "delta": "delta"}
# Ratios of oscillators: they have no dimension to go back to.
_OF_NEIGHBOURS = ("omega_s", "m")


def dimensional_name(column: str) -> str:
    """Name in dimensions of a column in Π-terms; other columns keep theirs.

    Parameters
    ----------
    column : str
        Of the table of a study.
    """
    stem = column.removeprefix(FREE)
    free = column[: len(column) - len(stem)]
    if stem == _UM or stem.startswith(_UM + "."):
        return f"{free}u_max{stem.removeprefix(_UM)}"
    term, dot, which = stem.removeprefix(PI).partition(".")
    if not stem.startswith(PI) or term not in _NAMES or (which and term in _OF_NEIGHBOURS):
        return column
    return f"{_NAMES[term]}{dot}{which}"


def dimensional_spectrum(table: pd.DataFrame, scales: Scales) -> pd.DataFrame:
    """Spectrum in dimensions of one in Π-terms.

    Parameters
    ----------
    table : DataFrame
        With columns as a study has them, ``pi.omega_s``, ``pi_um``, ...
    scales : Scales
        a_g and omega_g of the pulse.

    Returns
    -------
    DataFrame
        The same rows; in the place of Π-terms ``T_s`` (s), ``Q/m`` (m/s^2),
        ``u_y``, ``delta``, ``u_max`` and ``free.u_max`` (m). Other columns stay
        those of the pulse of the study.

    Raises
    ------
    InputError
        Where the table has no peak in Π-terms.
    """
    import pandas as pd

    if not any(dimensional_name(column).startswith("u_max") for column in table.columns):
        raise InputError("the table has no column pi_um, from which u_max could be found")
    columns = {}
    for column in table.columns:
        name = dimensional_name(column)
        values = table[column]
        columns[name] = values if name == column else _scaled(name, values.to_numpy(float), scales)
    return pd.DataFrame(columns)


def _scaled(name: str, values: np.ndarray, scales: Scales) -> np.ndarray:
    if name == "T_s":
        with np.errstate(divide="ignore"):
            return 2.0 * math.pi / (values * scales.omega_g)
    return values * (scales.a_g if name.startswith("Q/m") else scales.length)
