"""Soil behind a wall, by the wall's height and width.

Stiffness and passive force are those of Caltrans, Seismic Design Criteria 2.0 (2019), 6.3.1.2, of
a wall without skew (h in ft, w in ft):

    K = w (5.5 h + 20) kip/in,    F_ult = w 5.5 h^2.5 / (1 + 2.37 h) kip,    2 ft <= h <= 10 ft

At 5.5 ft they are within 1.2 % the 50 kip/in/ft and 5 ksf of its version 1.7 (2013), 7.8.1. The
curve through them is the hyperbola of Shamsabadi, Rollins and Kapuskar (2007): K is its secant at
half of F_ult, and F_ult is reached at 0.05 h, as of granular soil.
"""

from __future__ import annotations

from eventpound.errors import InputError

_INCH, _FOOT, _KIP = 0.0254, 0.3048, 4448.2216152605
"""In m and N."""
_LEAST, _MOST = 2.0 * _FOOT, 10.0 * _FOOT
"""Heights for which the formula is given (m)."""
_REACH = 0.05
"""Depth at which F_ult is reached, in heights."""


def soil_behind(height: float, width: float) -> tuple[float, float, float]:
    """K0 (N/m), F_ult (N) and R_f of the soil behind a wall of this height and width (m).

    Raises
    ------
    InputError
        Where the formula does not hold, each line naming ``height`` or ``width``.
    """
    heights = f"from {_LEAST:.4g} to {_MOST:.4g} m (Caltrans SDC 2.0)"
    said = {
        f"height: found {height!r}; accepted: {heights}": _LEAST <= height <= _MOST,
        f"width: found {width!r}; accepted: a positive length (m)": width > 0.0,
    }
    if problems := [text for text, holds in said.items() if not holds]:
        raise InputError(problems)
    h = height / _FOOT
    secant = width * (5.5 * h + 20.0) * _KIP / _INCH / _FOOT
    ultimate = width * 5.5 * h**2.5 / (1.0 + 2.37 * h) * _KIP / _FOOT
    # F = C y / (1 + D y): F_ult/2 at F_ult/(2 K), F_ult at the end.
    ratio = secant * _REACH * height / ultimate
    return secant * (2.0 - 1.0 / ratio), ultimate, 2.0 * (ratio - 1.0) / (2.0 * ratio - 1.0)
