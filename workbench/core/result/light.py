"""What baking gives: light on the skin, and radiance tabulated over the tilt of its normal.

Sensor frame; mm; float32. V vertices of the skin that the camera looks at (`MembraneMesh.seen`),
L points of light, N nodes (a coarser skin on which traced light is gathered), B directions.

A node has a frame (t, b, n): n is the unit normal of the undeformed skin into the sensor, t and b
complete it. Directions are binned in that frame; the table is square in the two tangential
components of the deformed unit normal, from -`TILT_SPAN` to +`TILT_SPAN` in `TILTS` steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core.base.check import expect

AZIMUTHS = 24
"""Bins of direction about the normal."""
SINES = (0.0, 0.02, 0.05, 0.09, 0.15, 0.23, 0.34, 0.48, 0.65, 0.82, 0.93, 0.98, 1.0)
"""Borders of the bins of direction in the cosine to the normal, dense near grazing."""
TILTS = 17
"""Steps of 6 degrees: against 9, dents in a skin of roughness .2 gained up to 2.6 dB against
photons; one of thirteen lost .9. More were not tried."""
TILT_SPAN = 0.85
"""Largest tangential component of a normal in the table [1]: tilted by 58 degrees."""
FLATTEST = 0.02
"""Smallest squared component of a tabulated normal along n: the table's corners lie beyond."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scattered:
    """Traced light by direction at the nodes: perpendicular irradiance [1/mm2] per bin.

    Bin e * AZIMUTHS + a holds azimuths about 2 pi a / AZIMUTHS from t toward b, and cosines to n
    between SINES[e] and SINES[e + 1]. Directions point from the skin to where light comes from.
    Power is that of the lights (`LightField.led_rgb`), so units cancel with the exposure.
    """

    frame: np.ndarray
    """Rows t, b, n of each node, shape (N, 3, 3), float32."""
    first: np.ndarray
    """Light that met nothing but clear walls, per colour, shape (N, 3, B), float32."""
    rest: np.ndarray
    """Light that was scattered or reflected on its way, shape (N, 3, B), float32."""
    nodes: np.ndarray
    """The three nodes about each vertex of the skin, shape (V, 3), int32."""
    weights: np.ndarray
    """Their weights, which sum to 1, shape (V, 3), float32."""
    balance: dict[str, float]
    """Where the emitted power went, as shares: `absorbed` by the coating, left through the `base`,
    `leaked`, cut off by `roulette` and `depth`; they sum to 1."""
    photons: int

    def __post_init__(self) -> None:
        count = AZIMUTHS * (len(SINES) - 1)
        expect(self.frame, "N 3 3", name="node frames")
        expect(self.first, f"N 3 {count}", name="unscattered light")
        expect(self.rest, f"N 3 {count}", name="scattered light")
        expect(self.nodes, "V 3", name="nodes of vertices")
        expect(self.weights, "V 3", name="weights of nodes")


@dataclass(frozen=True, kw_only=True, slots=True)
class LightField:
    """Light arriving at each vertex of the skin that the camera looks at (`MembraneMesh.seen`)."""

    model: str
    """Name of the `LightModel`."""
    direction: np.ndarray
    """Unit vector from vertex to light along its path, shape (L, V, 3), float32.

    With traced light the mean direction of unscattered photons: a virtual LED stands there as far
    away as the real one."""
    irradiance: np.ndarray
    """Perpendicular irradiance of the undeformed vertex, shadowed, shape (L, V), float32: 1 for
    the paper's fields, [1/mm2] per unit of power for the others; 0 where no light arrives."""
    led_mm: np.ndarray
    """Positions of the lights [mm], shape (L, 3), float64."""
    led_axis: np.ndarray
    """Unit emission axes, shape (L, 3), float64."""
    led_rgb: np.ndarray
    """Linear RGB power, shape (L, 3), float64."""
    led_exponent: np.ndarray
    """Radiant intensity falls as cos^exponent of the angle to the axis, shape (L,), float64."""
    led_cone: np.ndarray
    """Cosine of half the emission cone, shape (L,), float64; 0 is the half space."""
    led_size_mm: np.ndarray
    """Diameter of the emitting disc [mm], shape (L,), float64."""
    scattered: Scattered | None = None
    """For the models that trace photons."""


@dataclass(frozen=True, kw_only=True, slots=True)
class NormalTable:
    """Radiance toward each camera for tilted normals, without the lights that `LightField` holds.

    Of `hybrid` the scattered light only, of `table` all light. At node i, camera c, the normal
    x t + y b + sqrt(1 - x^2 - y^2) n has the radiance at row (x / TILT_SPAN + 1) / 2 (TILTS - 1),
    column likewise with y, interpolated.
    """

    values: np.ndarray
    """Radiance, shape (C, N, TILTS, TILTS, 3), float32."""

    def __post_init__(self) -> None:
        expect(self.values, f"C N {TILTS} {TILTS} 3", name="table of radiance")


@dataclass(frozen=True, kw_only=True, slots=True)
class VertexRadiance:
    """Radiance toward one camera at the vertices of the seen skin, from one batch of photons."""

    radiance: np.ndarray
    """Sum over the batch's photons, power per photon 1 of its light, shape (V, 3), float32."""
    photons: int
    """Photons emitted in this batch, all lights together."""
    balance: dict[str, float]
    """As in `Scattered`."""
