"""The table of a study as Parquet, where pyarrow is installed."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from eventpound.study.plan import RECORD, Plan
from eventpound.study.table import MESSAGE, SUCCESS, TABLE

PARQUET = "study.parquet"
_BLOCK = 1 << 18
"""Bytes of the table that are read at once: several such blocks are in memory."""


def write_parquet(study: Plan, directory: Path) -> bool:
    """Write ``study.parquet`` beside ``study.csv``, a block of rows at a time.

    Parameters
    ----------
    study : Plan
        Whose table it is.
    directory : Path
        Results of the study.

    Returns
    -------
    bool
        Whether pyarrow is installed, so that it was written.
    """
    if find_spec("pyarrow") is None:
        return False
    from pyarrow import csv, parquet, system_memory_pool

    target = directory / PARQUET
    temporary = directory / f".{PARQUET}.{os.getpid()}.partial"
    options = csv.ConvertOptions(column_types=_types(study), strings_can_be_null=False)
    try:
        with (
            csv.open_csv(
                directory / TABLE,
                read_options=csv.ReadOptions(block_size=_BLOCK),
                convert_options=options,
                # Others keep what they have been given back.
                memory_pool=system_memory_pool(),
            ) as blocks,
            parquet.ParquetWriter(temporary, blocks.schema) as writer,
        ):
            for block in blocks:
                writer.write_batch(block)
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
    return True


def _types(study: Plan) -> dict[str, Any]:
    """Types of the columns, which the first block alone need not show."""
    import pyarrow as pa

    words = {RECORD, *(name for base in study.bases for name in base.labels)}
    numbers = [name for name in (*study.columns, *study.quantities) if name not in words]
    types: dict[str, Any] = dict.fromkeys(words, pa.string()) | dict.fromkeys(numbers, pa.float64())
    return types | {SUCCESS: pa.bool_(), MESSAGE: pa.string()}
