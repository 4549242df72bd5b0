"""Tables of a LeRobot data set as Parquet files: frames, episodes, tasks."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from workbench.core.base.packages import naming_packages
from workbench.learning.lerobot.layout import INDICES, VALUES

TASK_INDEX = "__index_level_0__"
"""Column that pandas, with which LeRobot reads tasks, takes for the names of its rows."""


def frame_table(columns: Mapping[str, np.ndarray]) -> bytes:
    """The frames of all episodes.

    Args:
        columns: Numbers, (K,), or rows of numbers, (K, n), by the names of features.
    """
    with naming_packages():
        import pyarrow as pa
    arrays = {}
    for name, length in {name: len(names) for name, names in VALUES.items()}.items():
        flat = pa.array(columns[name].astype(np.float32).ravel())
        arrays[name] = pa.FixedSizeListArray.from_arrays(flat, length)
    for name, kind in INDICES.items():
        arrays[name] = pa.array(columns[name].astype(kind))
    return _bytes(pa.table(arrays))


def episode_table(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """What is known of each episode."""
    import pyarrow as pa

    return _bytes(pa.Table.from_pylist([dict(row) for row in rows]))


def task_table(tasks: Sequence[str]) -> bytes:
    """The tasks in words; row names are words, as pandas would write them."""
    import pyarrow as pa

    numbers = pa.array(range(len(tasks)), pa.int64())
    table = pa.table({"task_index": numbers, TASK_INDEX: pa.array(tasks, pa.string())})

    def column(name: str | None, field: str, kind: str, numpy_kind: str) -> dict[str, Any]:
        return {
            "name": name,
            "field_name": field,
            "pandas_type": kind,
            "numpy_type": numpy_kind,
            "metadata": None,
        }

    told = {
        "index_columns": [TASK_INDEX],
        "column_indexes": [],
        "columns": [
            column("task_index", "task_index", "int64", "int64"),
            column(None, TASK_INDEX, "unicode", "object"),
        ],
        "creator": {"library": "pyarrow", "version": pa.__version__},
        "pandas_version": "2.0.0",
    }
    return _bytes(table.replace_schema_metadata({"pandas": json.dumps(told)}))


def _bytes(table: Any) -> bytes:
    import pyarrow.parquet as parquet

    out = io.BytesIO()
    parquet.write_table(table, out)
    return out.getvalue()
