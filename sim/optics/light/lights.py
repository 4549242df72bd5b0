"""The lights of a sensor as points: the ring's LEDs, and the lamps divided into points.

Power is radiant flux, so the radiant intensity on the axis of an LED that falls as cos^m within a
cone of half angle c is I0 = power (m + 1) / (2 pi (1 - cos(c)^(m + 1))); see `lobe.emitted`. Its
edge is sharp, and in an image as sharp as the triangles of the skin. A
lamp's power is shared out equally to its points. Colours are linear RGB, see `spectrum`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.light.spectrum import linear_rgb
from workbench.core.base.units import radians
from workbench.core.design.leds import colour_sectors, lamp_cell_mm, lamp_points, led_places
from workbench.core.design.lighting import Ambient, Lamp, LedMount, LedRing


@dataclass(frozen=True, kw_only=True, slots=True)
class Leds:
    """Point lights in the sensor frame."""

    position_mm: np.ndarray
    """Shape (L, 3), float64."""
    axis: np.ndarray
    """Unit emission axes, shape (L, 3), float64."""
    rgb: np.ndarray
    """Linear RGB power, shape (L, 3), float64."""
    exponent: np.ndarray
    """Radiant intensity falls as cos^exponent, shape (L,), float64."""
    cone: np.ndarray
    """Cosine of half the emission cone, shape (L,), float64."""
    size_mm: np.ndarray
    """Diameter of the emitting disc [mm], shape (L,), float64."""
    in_shell: np.ndarray
    """Whether the light sits in the transparent support rather than in the cavity, (L,), bool."""


def place_leds(ring: LedRing, lamps: Sequence[Lamp] = ()) -> Leds:
    """The points of light: the ring's LEDs in the order of azimuth, then the lamps' points.

    Colours fill equal sectors of the ring. A lamp has `Lamp.points` points.
    """
    return _joined([_ring_leds(ring), *(_lamp_leds(lamp) for lamp in lamps)])


def _ring_leds(ring: LedRing) -> Leds:
    position_mm, axis = led_places(ring)
    colours = np.array([linear_rgb(colour) for colour in ring.colours])
    factors = np.array(ring.powers) if ring.powers else np.ones(ring.count)
    rgb = ring.power * factors[:, None] * colours[colour_sectors(ring)]
    return Leds(
        position_mm=position_mm,
        axis=axis,
        rgb=rgb,
        exponent=np.full(ring.count, ring.emission_exponent),
        cone=np.full(ring.count, cone_cosine(ring.cone_deg)),
        size_mm=np.full(ring.count, ring.size_mm),
        in_shell=np.full(ring.count, ring.mount is LedMount.SHELL),
    )


def _lamp_leds(lamp: Lamp) -> Leds:
    position_mm, axis = lamp_points(lamp)
    count = len(position_mm)
    rgb = np.tile(lamp.power / count * np.array(linear_rgb(lamp.colour)), (count, 1))
    return Leds(
        position_mm=position_mm,
        axis=axis,
        rgb=rgb,
        exponent=np.full(count, lamp.emission_exponent),
        cone=np.full(count, cone_cosine(lamp.cone_deg)),
        size_mm=np.full(count, lamp_cell_mm(lamp)),
        in_shell=np.full(count, lamp.mount is LedMount.SHELL),
    )


def ambient_irradiance(ambient: Ambient, area_mm2: float) -> np.ndarray:
    """Irradiance of a skin of an area that takes the ambient light's power evenly [1/mm2], (3,)."""
    return ambient.power / area_mm2 * np.array(linear_rgb(ambient.colour))


def cone_cosine(cone_deg: float) -> float:
    """Cosine of half an emission cone; exactly 0 for the half space."""
    return 0.0 if cone_deg >= 180.0 else float(np.cos(radians(cone_deg) / 2.0))


def _joined(groups: Sequence[Leds]) -> Leds:
    return Leds(
        position_mm=np.concatenate([group.position_mm for group in groups]),
        axis=np.concatenate([group.axis for group in groups]),
        rgb=np.concatenate([group.rgb for group in groups]),
        exponent=np.concatenate([group.exponent for group in groups]),
        cone=np.concatenate([group.cone for group in groups]),
        size_mm=np.concatenate([group.size_mm for group in groups]),
        in_shell=np.concatenate([group.in_shell for group in groups]),
    )
