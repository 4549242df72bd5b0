"""A file that says how one built sensor differs from its design; a calibration writes it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np

from workbench.core.base.errors import DesignError

ENDING = ".npz"
MOST_BYTES = 50_000_000


@dataclass(frozen=True, kw_only=True, slots=True)
class Unit:
    """The bytes of the file; equal files are equal whatever their names."""

    name: str = field(compare=False, metadata={"cosmetic": True})
    """Name for people."""
    sha256: str
    data: np.ndarray = field(compare=False, repr=False, metadata={"cosmetic": True})
    """Content, shape (bytes,), uint8; `sha256` stands for it in keys."""


def unit(name: str, data: bytes, *, at: str = "optics.unit") -> Unit:
    """A file as the designer gave it; what it holds is read where it is used.

    Raises:
        DesignError: If its name does not end in `.npz`, or it is too large.
    """
    if not name.lower().endswith(ENDING) or len(data) > MOST_BYTES:
        raise DesignError(
            f"{name} ({len(data):,} bytes) is not what a calibration writes",
            hint=f"name the unit.npz of `workbench calibrate`, of at most {MOST_BYTES:,} bytes",
            at=at,
        )
    return Unit(
        name=name,
        sha256=hashlib.sha256(data).hexdigest(),
        data=np.frombuffer(data, dtype=np.uint8),
    )
