"""A learned reader as one file: weights, and all else that reading needs.

An NPZ: `head` is JSON with size, scales, what it was learned for and its data card; matrices of
weights are float16, which moves outputs by less than a thousandth; vectors stay float32. Nothing in
it is executed, and every entry has a checksum. Imports no PyTorch.
"""

from __future__ import annotations

import dataclasses
import io
import json
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.reading.network.rest_view import RestView
from sim.reading.network.spec import ReaderSpec, Scales
from workbench.core.base.errors import StoreError

FORMAT = 1
HEAD, WEIGHT, REST = "head", "weight.", "rest."
MOST_BYTES = 100_000_000
SUFFIX = ".reader.npz"


@dataclass(frozen=True, kw_only=True, slots=True)
class ReaderFile:
    """A learned reader."""

    spec: ReaderSpec
    arrays: Mapping[str, np.ndarray]
    """The folded network's state by name, float32."""
    scales: Scales
    rest: RestView
    """What the camera sees of the skin at rest."""
    design: str
    """Name of the design it was learned for."""
    digest: str
    """Of all of that design that matters to an image."""
    camera_px: tuple[int, int]
    """Width and height of the camera's images."""
    card: Mapping[str, Any]
    """The data card: free JSON about data, training and scores."""


def reader_bytes(reader: ReaderFile) -> bytes:
    """The file.

    Raises:
        StoreError: If a weight is not finite.
    """
    arrays = {name: np.asarray(array) for name, array in reader.arrays.items()}
    bad = [name for name, array in arrays.items() if not np.isfinite(array).all()]
    if bad:
        raise StoreError(
            f"weights that are not finite: {', '.join(bad[:3])}",
            hint="the training diverged: train again with more presses",
            at="weights",
        )
    head = {
        "format": FORMAT,
        "spec": dataclasses.asdict(reader.spec),
        "scales": dataclasses.asdict(reader.scales),
        "design": reader.design,
        "digest": reader.digest,
        "camera_px": reader.camera_px,
        "card": dict(reader.card),
    }
    kept: dict[str, Any] = {HEAD: np.frombuffer(json.dumps(head).encode(), np.uint8)}
    for name, array in arrays.items():
        kept[WEIGHT + name] = array.astype(np.float16 if array.ndim > 1 else np.float32)
    kept |= {REST + name: array for name, array in reader.rest.arrays().items()}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **kept)
    return buffer.getvalue()


def reader_from_bytes(content: bytes, source: str) -> ReaderFile:
    """The reader of a file.

    Args:
        content: The file.
        source: Its name, for messages.

    Raises:
        StoreError: If it is damaged, or no reader of this format.
    """
    try:
        with np.load(io.BytesIO(content)) as file:
            arrays = {name: file[name] for name in file.files}
        head = json.loads(arrays.pop(HEAD).tobytes())
        if head["format"] != FORMAT:
            raise ValueError(f"it has format {head['format']}, this program reads {FORMAT}")
        spec = head["spec"]
        return ReaderFile(
            spec=ReaderSpec(**{**spec, "widths": tuple(spec["widths"])}),
            arrays={
                name.removeprefix(WEIGHT): array.astype(np.float32)
                for name, array in arrays.items()
                if name.startswith(WEIGHT)
            },
            scales=Scales(**head["scales"]),
            rest=RestView.of(
                {n.removeprefix(REST): a for n, a in arrays.items() if n.startswith(REST)}
            ),
            design=str(head["design"]),
            digest=str(head["digest"]),
            camera_px=(int(head["camera_px"][0]), int(head["camera_px"][1])),
            card=head["card"],
        )
    except (OSError, KeyError, TypeError, ValueError, EOFError, zlib.error) as error:
        raise _damaged(source, error) from error
    except zipfile.BadZipFile as error:
        raise _damaged(source, error) from error


def load_reader(path: Path) -> ReaderFile:
    """The reader of a file on disk.

    Raises:
        StoreError: As `reader_from_bytes`, or if the file cannot be read.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise StoreError(
                f"{path} is larger than the {MOST_BYTES // 10**6} MB that a reader may have",
                hint="name a file that `workbench reader train` wrote",
                at=str(path),
            )
        content = path.read_bytes()
    except OSError as error:
        raise StoreError(
            f"cannot read {path}: {error.strerror or error}",
            hint="check the path, or train a reader with `workbench reader train`",
            at=str(path),
        ) from error
    return reader_from_bytes(content, str(path))


def _damaged(source: str, error: Exception) -> StoreError:
    return StoreError(
        f"{source} is no learned reader, or damaged: {error}",
        hint="name a file that `workbench reader train` wrote, or train again",
        at=source,
    )
