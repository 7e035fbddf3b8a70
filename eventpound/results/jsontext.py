"""Numbers and tables as JSON that any program reads.

JSON knows neither NaN nor infinity: both become ``null``. A finite number is
written with the digits that read back as the same double.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence, Set
from pathlib import Path

import numpy as np


def to_json(value: object) -> bytes:
    """Value as indented JSON with a line end, UTF-8.

    Parameters
    ----------
    value : object
        Mappings, sequences, arrays, numbers, strings, paths and None.

    Raises
    ------
    TypeError
        For anything else.
    """
    return (json.dumps(plain(value), indent=2, ensure_ascii=False) + "\n").encode()


def canonical(value: object) -> bytes:
    """Value as JSON of which every value has one form only, to be hashed.

    Parameters
    ----------
    value : object
        As for `to_json`.
    """
    return json.dumps(plain(value), sort_keys=True, separators=(",", ":")).encode()


def plain(value: object) -> object:
    """Value in the types JSON has; what is not finite is None.

    Parameters
    ----------
    value : object
        As for `to_json`.

    Raises
    ------
    TypeError
        Where there is no such form.
    """
    if isinstance(value, np.generic | np.ndarray):
        return plain(value.tolist())
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if value is None or isinstance(value, bool | int):
        return value
    if isinstance(value, str | Path):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, Sequence | Set):
        return [plain(entry) for entry in value]
    raise TypeError(f"no JSON form for a {type(value).__name__}")
