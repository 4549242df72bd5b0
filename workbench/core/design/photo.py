"""A picture file that a design uses: a photographed background, or a pattern of markers."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np

from workbench.core.base.errors import DesignError

PICTURE_ENDINGS = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff")
MOST_BYTES = 50_000_000


@dataclass(frozen=True, kw_only=True, slots=True)
class Photo:
    """The bytes of a picture file; equal files are equal whatever their names."""

    name: str = field(compare=False, metadata={"cosmetic": True})
    """Name for people."""
    sha256: str
    data: np.ndarray = field(compare=False, repr=False, metadata={"cosmetic": True})
    """Content, shape (bytes,), uint8; `sha256` stands for it in keys."""


def photo(name: str, data: bytes, *, at: str) -> Photo:
    """A picture as the designer gave it; what it shows is read where it is used.

    Args:
        name: File name; its ending must be one that can be read.
        data: Content.
        at: Field of the design, for messages.

    Raises:
        DesignError: If its name ends in no known format, or it is too large.
    """
    if not name.lower().endswith(PICTURE_ENDINGS):
        raise DesignError(
            f"{name} is not a picture that can be read",
            hint=f"give a file that ends in {', '.join(PICTURE_ENDINGS)}",
            at=at,
        )
    if len(data) > MOST_BYTES:
        raise DesignError(
            f"{name} has {len(data)} bytes, a picture has at most {MOST_BYTES}",
            hint="save it with fewer pixels",
            at=at,
        )
    return Photo(
        name=name,
        sha256=hashlib.sha256(data).hexdigest(),
        data=np.frombuffer(data, dtype=np.uint8),
    )
