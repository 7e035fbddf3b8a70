"""Numbers and tables as JSON that any program reads, and JSON objects read back.

JSON knows neither NaN nor infinity: both become ``null``. A finite number is
written with the digits that read back as the same double.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence, Set
from pathlib import Path
from typing import Any

import numpy as np

from eventpound.basics.input_files import read_bytes
from eventpound.errors import InputError


def read_json(path: Path) -> dict[str, Any]:
    """Content of a file that holds a JSON object.

    Raises
    ------
    InputError
        Where it cannot be read, is no JSON, or holds something else.
    """
    try:
        content = json.loads(read_bytes(path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not JSON: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: holds a {type(content).__name__}, not an object")
    return content


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
