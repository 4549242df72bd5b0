"""Elements of XML with numbers, and their text."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable

import numpy as np

DIGITS = 7
"""Of lengths, masses and inertias: no file says more than it knows."""


def numbers(values: Iterable[float] | np.ndarray) -> str:
    """Numbers as XML files of robots have them: apart by blanks."""
    # Adding zero turns a negative zero into zero.
    return " ".join(f"{float(value) + 0.0:.{DIGITS}g}" for value in np.ravel(np.asarray(values)))


def element(parent: ET.Element, tag: str, **attributes: str) -> ET.Element:
    """An element inside another; `class_` stands for `class`."""
    named = {name.rstrip("_"): value for name, value in attributes.items()}
    return ET.SubElement(parent, tag, named)


def document(root: ET.Element, says: str) -> bytes:
    """An indented file with a comment at its head."""
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n<!-- {says} -->\n{text}\n'.encode()
