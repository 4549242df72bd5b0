"""Arrays that are mostly zeros, packed: one bit an entry, and the entries that are not zero.

    where = packbits(array != 0)          values = array[array != 0]

Contact touches little of the skin, so its fields are zero nearly everywhere. Measured on the ten
frames of the default finger (10 x 26,020 vertices, 15.6 MB in six fields, 0.1 to 6 % not zero; two
slow cores): plain files 15.6 MB; zlib at its lowest level 0.7 MB, 27 ms to pack and 13 ms to
unpack; this 1.1 MB, under 3 ms for each. Where everything moves, as in a grip, neither helps (zlib
takes 0.4 s to save 6 % of 12 MB), so dense arrays stay plain files that are mapped, not read.
Images do not pay either: 260 ms to save a fifth of a depth image.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

LEAST_BYTES = 1_000_000
"""Smaller arrays are not worth a second file."""
MOST_FILLED = 0.25
"""Share of entries that are not zero up to which an array is packed."""
PARTS = ("where", "values")


def mostly_zeros(array: np.ndarray) -> bool:
    """Whether an array is large and empty enough to be packed."""
    if array.nbytes < LEAST_BYTES or array.dtype.kind not in "biuf":
        return False
    return bool(np.count_nonzero(_bits(array)) <= MOST_FILLED * array.size)


def pack_zeros(array: np.ndarray) -> dict[str, np.ndarray]:
    """The two parts of an array by their names in `PARTS`; minus zero is kept, NaN too."""
    filled = _bits(array) != 0
    return {"where": np.packbits(filled), "values": array.reshape(-1)[filled]}


def unpack_zeros(parts: Mapping[str, np.ndarray], shape: tuple[int, ...]) -> np.ndarray:
    """The array of a shape from its two parts, read-only.

    Raises:
        ValueError: If the parts do not belong together.
    """
    size, values = math.prod(shape), parts["values"]
    filled = np.unpackbits(parts["where"], count=size).astype(bool)
    flat = np.zeros(size, values.dtype)
    if np.count_nonzero(filled) != len(values):
        raise ValueError(f"{len(values)} values for {np.count_nonzero(filled)} places")
    flat[filled] = values
    flat.flags.writeable = False
    return flat.reshape(shape)


def _bits(array: np.ndarray) -> np.ndarray:
    """The entries in a row as whole numbers, so that minus zero is not zero."""
    return np.ascontiguousarray(array).reshape(-1).view(f"u{array.itemsize}")
