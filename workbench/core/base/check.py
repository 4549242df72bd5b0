"""Checks at the public edge: array shapes, and numbers inside their limits."""

from __future__ import annotations

import math
from typing import Unpack

import numpy as np

from workbench.core.base.errors import Advice, DesignError, shown


def expect(array: np.ndarray, shape: str, *, name: str = "array") -> np.ndarray:
    """Return the array if it has the stated shape, for example `"N 3"`.

    Letters are free sizes that must agree with themselves, numbers are exact.

    Raises:
        ValueError: If the shape differs; this is a bug of the caller, not of the designer.
    """
    wanted = shape.split()
    sizes: dict[str, int] = {}
    fits = array.ndim == len(wanted) and all(
        int(want) == size if want.isdigit() else sizes.setdefault(want, size) == size
        for want, size in zip(wanted, array.shape, strict=False)
    )
    if not fits:
        raise ValueError(f"{name} has shape {array.shape}, expected ({', '.join(wanted)})")
    return array


def within(
    value: object,
    low: float,
    high: float,
    *,
    what: str,
    unit: str,
    **advice: Unpack[Advice],
) -> float:
    """Return the value if it is a finite number in [low, high].

    Raises:
        DesignError: Naming value, limits and unit, if it is not; with `at` and `hint`, or with the
            limits as a hint.
    """
    span = f"{low:g} to {high:g} {unit}".strip()
    place: Advice = {**advice, "hint": advice.get("hint") or f"choose a value from {span}"}
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise DesignError(f"{what} is {shown(value)}, which is not a finite number", **place)
    if not low <= value <= high:
        given = f"{value:g} {unit}".strip()
        raise DesignError(f"{what} {given} is outside {span}", **place)
    return value
