"""A designer's picture file as an array: what is read, what is converted, what is refused.

Read: grey, colour and palette pictures of 8 or 16 bits, with or without transparency, which is
laid over a plain ground. 16 bits are divided by 257, so that 65535 is 255. Refused: CMYK, whose
colours need the printer's profile, numbers with a fraction, and what is no picture.
"""

from __future__ import annotations

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.design.photo import Photo

MOST_PIXELS = 50_000_000
"""Of a picture [1]; a larger one would take more memory than the images of a press."""
JPEG, TIFF = b"\xff\xd8", (b"II*\x00", b"MM\x00*")
SEPARATED = 5
"""Photometric interpretation of CMYK in a TIFF file. Source: TIFF 6.0, section 16."""


def read_rgb(photo: Photo, *, at: str, ground: float = 1.0) -> np.ndarray:
    """Display values in [0, 1], red, green, blue, shape (H, W, 3), float32.

    Args:
        photo: The file.
        at: Field of the design, for messages.
        ground: Grey in [0, 1] that transparent places show.

    Raises:
        DesignError: If it cannot be read, is CMYK, or has a number format that is no display value.
    """
    import cv2

    if is_cmyk(photo.data.tobytes()):
        raise DesignError(
            f"{photo.name} is a CMYK picture; its inks have no colour of light",
            hint="save it as 8-bit RGB PNG",
            at=at,
        )
    flags = cv2.IMREAD_UNCHANGED
    try:
        found = cv2.imdecode(photo.data, flags) if photo.data.size else None
    except cv2.error:
        found = None
    if found is None or not found.size:
        raise DesignError(
            f"{photo.name} ({photo.data.size:,} bytes) cannot be read as a picture",
            hint="open it in an image program and save it as 8-bit RGB PNG",
            at=at,
        )
    if found.shape[0] * found.shape[1] > MOST_PIXELS:
        raise DesignError(
            f"{photo.name} has {found.shape[1]} x {found.shape[0]} pixels, more than "
            f"{MOST_PIXELS:,}",
            hint="save it with fewer pixels",
            at=at,
        )
    full = {"uint8": 255.0, "uint16": 65535.0}.get(found.dtype.name)
    if full is None:
        raise DesignError(
            f"{photo.name} holds numbers of the type {found.dtype.name}, not of 8 or 16 bits",
            hint="save it as 8-bit RGB PNG",
            at=at,
        )
    return _colours(np.atleast_3d(found).astype(np.float32) / np.float32(full), ground)


def _colours(values: np.ndarray, ground: float) -> np.ndarray:
    """Red, green, blue of grey, grey with alpha, BGR or BGR with alpha, (H, W, 1 to 4)."""
    channels = values.shape[2]
    colour = values[:, :, 2::-1] if channels >= 3 else np.repeat(values[:, :, :1], 3, axis=2)
    if channels in (2, 4):
        alpha = values[:, :, -1:]
        colour = alpha * colour + (1.0 - alpha) * np.float32(ground)
    return np.ascontiguousarray(colour, dtype=np.float32)


def is_cmyk(data: bytes) -> bool:
    """Whether a JPEG or TIFF file holds four inks.

    The decoder would turn them into some RGB without a word. A JPEG says so by four components in
    its frame header, a TIFF by its photometric interpretation.
    """
    if data.startswith(JPEG):
        return _jpeg_components(data) == 4
    if data.startswith(TIFF):
        return _tiff_photometric(data) == SEPARATED
    return False


def _jpeg_components(data: bytes) -> int:
    at = 2
    while at + 9 < len(data) and data[at] == 0xFF:
        marker, size = data[at + 1], int.from_bytes(data[at + 2 : at + 4], "big")
        # Frame headers are C0 to CF, without the tables C4 and CC and the extension C8.
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            return data[at + 9]
        at += 2 + size
    return 0


def _tiff_photometric(data: bytes) -> int:
    order = "little" if data[0] == 0x49 else "big"
    start = int.from_bytes(data[4:8], order)
    count = int.from_bytes(data[start : start + 2], order)
    for number in range(count):
        entry = data[start + 2 + 12 * number : start + 14 + 12 * number]
        if int.from_bytes(entry[:2], order) == 262:
            return int.from_bytes(entry[8:10], order)
    return -1
