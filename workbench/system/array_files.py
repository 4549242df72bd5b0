"""Arrays of an .npz file that somebody else may have made, checked before they take any memory.

NumPy allocates what a header says, however little follows it; here the header must fit the bytes.
"""

from __future__ import annotations

import io
import math

import numpy as np

from workbench.system.zip_files import zip_members

MOST_ARRAYS = 8
MOST_BYTES = 200_000_000
"""Of all arrays of a file: a mesh of two million triangles, a picture of 25 million pixels."""
KINDS = "fiu"
"""Floating point and whole numbers."""


def read_arrays(name: str, content: bytes) -> dict[str, np.ndarray]:
    """The arrays of a file by name.

    Args:
        name: Of the file, for messages.
        content: The file.

    Raises:
        DesignError: If it is too large or no such file.
        ValueError: If a member is no array of numbers, or not of the size that it says.
    """
    members = zip_members(name, content, most_files=MOST_ARRAYS, most_bytes=MOST_BYTES)
    return {path.removesuffix(".npy"): _array(path, data) for path, data in members.items()}


def _array(path: str, data: bytes) -> np.ndarray:
    file = io.BytesIO(data)
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
    elif version == (2, 0):
        shape, _, dtype = np.lib.format.read_array_header_2_0(file)
    else:
        raise ValueError(f"{path} is an array of format {version}")
    if dtype.kind not in KINDS or min(shape, default=0) < 0:
        raise ValueError(f"{path} is no array of numbers")
    if math.prod(shape) * dtype.itemsize != len(data) - file.tell():
        raise ValueError(f"{path} is not as long as its shape {shape} says")
    file.seek(0)
    return np.lib.format.read_array(file, allow_pickle=False)
