"""Trainings in files, under the key of all that they rest on."""

from __future__ import annotations

import io
import pickle
from pathlib import Path
from typing import Any

import torch

from workbench.system.whole_files import write_atomically


def write_training(path: Path, key: str, content: dict[str, Any]) -> None:
    """Keep a training.

    Raises:
        StoreError: If the file cannot be written.
    """
    buffer = io.BytesIO()
    torch.save({"key": key, **content}, buffer)
    write_atomically(path, buffer.getvalue())


def read_training(path: Path, key: str) -> dict[str, Any] | None:
    """A kept training; None where there is none, or of something else."""
    try:
        found = torch.load(path, map_location="cpu", weights_only=True)
    except (OSError, RuntimeError, EOFError, pickle.UnpicklingError):
        return None
    return found if found.get("key") == key else None
