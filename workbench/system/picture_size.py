"""Width and height of a picture from its header, before anything of it is decoded.

A file of a few kilobytes can unfold to gigabytes. Sources: PNG specification (W3C, 2003) 11.2.2;
JPEG (ITU-T T.81) B.2.2; BMP (BITMAPCOREHEADER, BITMAPINFOHEADER); TIFF 6.0, section 2. Leaves out
all other formats, and the 64-bit form of TIFF.
"""

from __future__ import annotations

import struct

PNG, JPEG, BMP = b"\x89PNG\r\n\x1a\n", b"\xff\xd8", b"BM"
TIFF = {b"II*\0": "<", b"MM\0*": ">"}
"""Byte order by the first four bytes."""
WIDTH_TAG, HEIGHT_TAG = 256, 257
SHORT = 3
"""Type of a TIFF field of two bytes; the other that a size may have has four."""
NO_FRAME = (0xC4, 0xC8, 0xCC)
"""JPEG markers from C0 to CF that do not begin a frame."""
LONE = (0x01, *range(0xD0, 0xDA))
"""JPEG markers without a length."""


def picture_size(data: bytes) -> tuple[int, int] | None:
    """Width and height [px] of a PNG, JPEG, BMP or TIFF; None of anything else."""
    try:
        if data.startswith(PNG):
            width, height = struct.unpack_from(">II", data, 16)
        elif data.startswith(JPEG):
            width, height = _jpeg(data)
        elif data.startswith(BMP):
            old = struct.unpack_from("<I", data, 14)[0] == 12
            width, height = struct.unpack_from("<HH" if old else "<ii", data, 18)
        elif data[:4] in TIFF:
            width, height = _tiff(data, TIFF[data[:4]])
        else:
            return None
    except (struct.error, KeyError):
        return None
    # The rows of a BMP may run downward, which a negative height says.
    size = abs(int(width)), abs(int(height))
    return size if all(size) else None


def _jpeg(data: bytes) -> tuple[int, int]:
    place = 2
    while True:
        fill, marker = struct.unpack_from("BB", data, place)
        if fill != 0xFF or marker == 0xFF:
            place += 1
        elif marker in LONE:
            place += 2
        elif 0xC0 <= marker <= 0xCF and marker not in NO_FRAME:
            height, width = struct.unpack_from(">HH", data, place + 5)
            return width, height
        else:
            place += 2 + struct.unpack_from(">H", data, place + 2)[0]


def _tiff(data: bytes, order: str) -> tuple[int, int]:
    (start,) = struct.unpack_from(f"{order}I", data, 4)
    (count,) = struct.unpack_from(f"{order}H", data, start)
    fields: dict[int, int] = {}
    for number in range(count):
        place = start + 2 + 12 * number
        tag, kind = struct.unpack_from(f"{order}HH", data, place)
        (fields[tag],) = struct.unpack_from(
            f"{order}{'H' if kind == SHORT else 'I'}", data, place + 8
        )
    return fields[WIDTH_TAG], fields[HEIGHT_TAG]
