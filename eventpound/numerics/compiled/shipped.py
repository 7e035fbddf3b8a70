"""Kernels that an installation came with: machine code for a named class of processors.

A wheel may hold them, in `FOLDER`, with a list of what they were made by and of what a
processor must have for them; ``.ci/wheel`` makes one. There they are looked for once the
kernels that this machine has compiled itself were. Their names tell sources, versions and
how they were compiled, as all names of kernels do (`eventpound.numerics.compiled.store`).
"""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import llvmlite
import llvmlite.binding as llvm
import numba
from numba import config

SUFFIX = ".kernel"
VERSIONS = f"{sys.implementation.cache_tag} numba {numba.__version__} llvm {llvmlite.__version__}"
"""What makes machine code of sources here."""
FOLDER = Path(__file__).parent / "kernels"
_LIST = "made.json"
_V3 = (
    *("cx16", "crc32", "popcnt", "sahf", "sse3", "sse4.1", "sse4.2", "ssse3"),
    *("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave"),
)
CLASSES: Mapping[str, Sequence[str]] = {
    "x86-64-v3": _V3,
    "x86-64-v4": (*_V3, "avx512bw", "avx512cd", "avx512dq", "avx512f", "avx512vl"),
}
"""What a processor must have, as LLVM calls it, by LLVM's name of the class (x86-64 psABI)."""


class Made(NamedTuple):
    """What the kernels of `FOLDER` were made for and by.

    Attributes
    ----------
    processor : str
        LLVM's name of the class of processors.
    features : sequence of str
        What each of them has, as LLVM calls it.
    versions : str
        Of Python, Numba and llvmlite.
    """

    processor: str
    features: Sequence[str]
    versions: str


@cache
def made() -> Made | None:
    """The list of `FOLDER`; None where the installation came with no kernels."""
    try:
        return Made(**json.loads((FOLDER / _LIST).read_text(encoding="utf-8")))
    except FileNotFoundError:
        return None
    except (OSError, ValueError, TypeError):
        return Made("", (), "a list that cannot be read")


@cache
def misfit() -> str:
    """Why the kernels of `FOLDER` are not for this process; empty where they are."""
    known = made()
    if known is None:
        return "there are none"
    if known.versions != VERSIONS:
        return f"they were made by {known.versions}, here is {VERSIONS}"
    if config.CPU_NAME is not None or config.CPU_FEATURES is not None:
        return "NUMBA_CPU_NAME or NUMBA_CPU_FEATURES is set"
    present = llvm.get_host_cpu_features()
    if lacking := [name for name in known.features if not present.get(name)]:
        return f"they are for {known.processor}, and the processor lacks {', '.join(lacking)}"
    return ""


def ship(kept: Path, processor: str) -> int:
    """Take kernels into the package, for a wheel; their number.

    Parameters
    ----------
    kept : Path
        Where they are: the `NUMBA_CACHE_DIR` under which they were compiled, with
        `NUMBA_CPU_NAME` the class and `NUMBA_CPU_FEATURES` empty.
    processor : str
        The class, of `CLASSES`.
    """
    features = CLASSES[processor]
    FOLDER.mkdir()
    found = sorted(kept.rglob(f"*{SUFFIX}"))
    for path in found:
        shutil.copyfile(path, FOLDER / path.name)
    text = json.dumps(Made(processor, features, VERSIONS)._asdict(), indent=1)
    (FOLDER / _LIST).write_text(text + "\n", encoding="utf-8")
    return len(found)
