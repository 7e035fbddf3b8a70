"""Records of named numbers, which compiled code hands on as one address."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

if TYPE_CHECKING:
    # To type checkers the other is final.
    _Record = object
else:
    _Record = np.void


class NamedNumbers(_Record):
    """A record whose fields are the annotations of its class.

    `layout` is the dtype of an array that has such records. A field of ``Floats`` has as many as
    the class has `room` for. What Python asks often it takes from the array, ``now["t"][0]``: a
    sixth of the time of ``now[0].t``.
    """

    layout: ClassVar[np.dtype]

    def __init_subclass__(cls, room: int = 0) -> None:
        kinds: dict[str, Any] = {"float": float, "int": int, "bool": bool, "Floats": (float, room)}
        fields = [(name, kinds[kind]) for name, kind in cls.__annotations__.items()]
        cls.layout = np.dtype((cls, np.dtype(fields, align=True)))
        for name, _ in fields:
            # Attributes of `np.record` take six times as long.
            def put(record: Any, value: Any, name: str = name) -> None:
                record[name] = value

            setattr(cls, name, property(itemgetter(name), put))
