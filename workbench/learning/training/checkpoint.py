"""Checkpoints: all that a training needs to go on after the power failed, in one file.

Written after every epoch, whole or not at all, so a killed process loses the epoch that ran. Read
by PyTorch's loader for plain tensors, which executes nothing.
"""

from __future__ import annotations

import io
import pickle
from pathlib import Path
from typing import Any

from workbench.core.base.errors import StoreError, shown
from workbench.system.whole_files import write_atomically

FORMAT = 1
CHECKPOINT = "checkpoint.pt"


def write_checkpoint(folder: Path, key: str, content: dict[str, Any]) -> None:
    """Replace the checkpoint of a training.

    Args:
        folder: Of the training.
        key: Of data, settings and seed: what another training must not go on from.
        content: Tensors, numbers, texts, lists and tables.

    Raises:
        StoreError: If the disk is full or read-only; the old checkpoint stays.
    """
    import torch

    buffer = io.BytesIO()
    torch.save({"format": FORMAT, "key": key, **content}, buffer)
    write_atomically(folder / CHECKPOINT, buffer.getvalue())


def read_checkpoint(folder: Path, key: str) -> dict[str, Any] | None:
    """The checkpoint of a training, None where it has none yet.

    Raises:
        StoreError: If it is damaged, of another format, or of another training.
    """
    import torch

    path = folder / CHECKPOINT
    if not path.exists():
        return None
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
        found, whose = content["format"], content["key"]
    except (OSError, RuntimeError, KeyError, TypeError, EOFError, pickle.UnpicklingError) as error:
        raise StoreError(
            f"the checkpoint {path} is damaged or cut short: {str(error).splitlines()[0][:200]}",
            hint="copy it again, or delete it to begin the training anew",
            at=str(path),
        ) from error
    if found != FORMAT:
        raise StoreError(
            f"the checkpoint {path} has format {shown(found)}, this program reads {FORMAT}",
            hint="go on with the program that began it, or train in another folder",
            at=str(path),
        )
    if whose != key:
        raise StoreError(
            f"{folder} holds a training of other data, settings or seed",
            hint="give the options and the data that it was begun with, or another --out",
            at=str(folder),
        )
    return content
