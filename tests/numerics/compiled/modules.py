"""Small modules with kernels in folders of their own, and processes that import them."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

KERNELS = """\
from __future__ import annotations

import numpy as np

from eventpound.numerics.compiled import kernel, scalar_kernel


@scalar_kernel
def halved(x):
    return 0.5 * x


@scalar_kernel
def power(x, n):
    result = 1.0
    for _ in range(n):
        result *= x
    return result


@kernel
def doubled(x):
    return 2.0 * x + 0.0 * halved(x)


@kernel
def powers(x):
    out = np.zeros(4)
    out[0], out[1], out[2] = power(x, 1), power(x, 2), power(x, 3)
    out[3] = max(x, halved(x))
    return out


@kernel
def refused(n):
    if n > 3:
        raise ValueError("more than three")
    return n


@kernel
def hashed(n):
    return hash("word") + n
"""
"""Two kernels with parts; `refused` raises."""


def written(folder: Path) -> Path:
    """The module's file."""
    file = folder / "kernels.py"
    file.write_text(KERNELS)
    return file


def imported(file: Path, name: str = "kernels") -> ModuleType:
    """The module, made anew, as a new process would have it."""
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def in_a_process(
    file: Path, expression: str, cache: Path | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Print an expression of the module's names in a process of its own."""
    program = f"import sys; sys.path.insert(0, {str(file.parent)!r}); from kernels import *; "
    own = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    kept = {} if cache is None else {"NUMBA_CACHE_DIR": str(cache)}
    return subprocess.run(
        [sys.executable, "-c", program + f"print({expression})"],
        capture_output=True,
        text=True,
        check=False,
        env={**own, **kept, **environment},
    )
