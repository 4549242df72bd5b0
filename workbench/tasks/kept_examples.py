"""Examples in a file: to read thousands of dents takes minutes, and who was stopped goes on."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from workbench.system.whole_files import write_atomically
from workbench.tasks.examples import Examples
from workbench.tasks.kept.kept_key import kept_key

SOURCES = (
    "workbench.tasks.rendered",
    "workbench.tasks.examples",
    "workbench.tasks.reshoot",
    "workbench.tasks.kinds",
)
"""Code that they rest on, with what it imports."""
ARRAYS = ("places", "inputs", "at", "feet_mm", "axes", "motion", "truth")
WORDS = ("names", "outputs")
KEY = "key"


def kept_examples(path: Path, rests_on: list[object], see: Callable[[], Examples]) -> Examples:
    """Examples from their file; seen and kept where they are of something else, or not there.

    Args:
        path: Of the file.
        rests_on: What they are of, besides the code: recipe, light, network.
        see: Sees them.

    Raises:
        StoreError: If the file cannot be written.
    """
    key = kept_key(rests_on, SOURCES)
    found = _read(path, key)
    if found is None:
        found = see()
        _write(path, key, found)
    return found


def _read(path: Path, key: str) -> Examples | None:
    """None where there are none, or of something else, or the file is damaged."""
    try:
        with np.load(path, allow_pickle=False) as held:
            if str(held[KEY]) != key:
                return None
            content: dict[str, Any] = {name: held[name] for name in ARRAYS}
            content.update((name, tuple(held[name].tolist())) for name in WORDS)
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    return Examples(**content)


def _write(path: Path, key: str, found: Examples) -> None:
    content: dict[str, Any] = {name: np.asarray(getattr(found, name)) for name in (*ARRAYS, *WORDS)}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **{KEY: np.array(key)}, **content)
    write_atomically(path, buffer.getvalue())
