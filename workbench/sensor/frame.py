"""What a sensor feels and sees in one call: B presses side by side."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

Array = TypeVar("Array")


@dataclass(frozen=True, kw_only=True)
class Felt:
    """Forces act on the object; all vectors are in the sensor's frame."""

    force_N: np.ndarray
    """Shape (B, 3)."""
    torque_Nmm: np.ndarray
    """About the object's origin, shape (B, 3)."""
    displacement_mm: np.ndarray
    """Of the N nodes of the skin (`Sensor.skin.points_mm`), shape (B, N, 3)."""
    pressure_MPa: np.ndarray
    """At the nodes, shape (B, N)."""
    slip: np.ndarray
    """Share of the normal force that slides, shape (B,): 1 is gross slip."""
    within_range: np.ndarray
    """Whether the presses are of the kind that fast contact was fitted to, shape (B,), bool."""
    notes: tuple[str, ...]
    """Why they are not, a sentence for each press, or ""."""


@dataclass(frozen=True, kw_only=True)
class Seen(Generic[Array]):
    """What the camera sees, as arrays or tensors."""

    rgb: Array
    """Images, shape (B, H, W, 3), uint8."""
    looks: Callable[[], tuple[Array, Array]] = field(repr=False)
    """Finds depth and dots, when they are asked for."""

    @functools.cached_property
    def _looked(self) -> tuple[Array, Array]:
        return self.looks()

    @property
    def depth_mm(self) -> Array:
        """Depth of the skin along the camera's axis, shape (B, H, W), float32; NaN beside it."""
        return self._looked[0]

    @property
    def markers_px(self) -> Array:
        """u, v of the printed dots, shape (B, M, 2), float32; NaN of those not seen."""
        return self._looked[1]


@dataclass(frozen=True, kw_only=True)
class Frame(Seen[np.ndarray], Felt):
    """What a sensor feels and sees."""
