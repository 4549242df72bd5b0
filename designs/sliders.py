"""A parameter of a family: a dataclass field that knows its slider."""

from __future__ import annotations

from dataclasses import field
from typing import Any


def slider(
    default: float,
    span: tuple[float, float, float],
    unit: str,
    label: str,
    hint: str,
    source: str = "",
) -> Any:
    """A field with its slider; `span` is minimum, maximum and step."""
    low, high, step = span
    about = {"min": low, "max": high, "step": step, "unit": unit, "label": label, "hint": hint}
    return field(default=default, metadata={**about, "source": source})
