"""Lights as photons begin at them: equal numbers from each, of the power of its light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.surface import closest_point
from sim.optics.light.lights import Leds
from sim.optics.transport.scene import Scene

CLEARANCE = 0.95
"""Share of the distance to the nearest surface that an emitting disc may reach."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sources:
    """Lights in the form that the kernels read."""

    position_mm: np.ndarray
    """Shape (L, 3), float32."""
    axis: np.ndarray
    """Unit emission axes, shape (L, 3), float32."""
    emission: np.ndarray
    """Exponent, cosine of half the cone, and radius of the disc [mm], shape (L, 3), float32."""
    in_shell: np.ndarray
    """1 where photons begin in the solid, shape (L,), int32."""
    power: np.ndarray
    """Linear RGB over the strongest of all, at most 1, shape (L, 3), float32."""
    strongest: float
    """What `power` was divided by."""

    @property
    def count(self) -> int:
        """Number of lights."""
        return len(self.position_mm)


def open_sources(leds: Leds, scene: Scene) -> Sources:
    """The lights of a scene.

    A disc that would cut a wall or the skin is made smaller: an LED of 1.5 mm fits no shell of
    1 mm, and light must not begin on the wrong side.
    """
    position = np.asarray(leds.position_mm, dtype=np.float64)
    _, clear_mm, _ = closest_point(scene.points_mm, scene.faces, position)
    radius_mm = np.minimum(leds.size_mm / 2.0, CLEARANCE * clear_mm)
    strongest = float(np.max(leds.rgb, initial=0.0)) or 1.0
    return Sources(
        position_mm=position.astype(np.float32),
        axis=np.asarray(leds.axis, dtype=np.float32),
        emission=np.column_stack([leds.exponent, leds.cone, radius_mm]).astype(np.float32),
        in_shell=np.asarray(leds.in_shell, dtype=np.int32),
        power=(leds.rgb / strongest).astype(np.float32),
        strongest=strongest,
    )
