"""How far an elastic skin follows a fine relief under pressure.

Westergaard's wave: a half-space of plane-strain modulus E* = E / (1 - nu^2) pressed with the mean
pressure p against the rigid wave d cos(2 pi x / l) touches all of it from

    p* = pi E* d / l                                                             on;

below, it touches where sin^2(pi x / l) < q = p / p*, and the gap elsewhere follows by integrating
its slope. With t^2 the depth below the crest over the height H = 2 d of the wave (t = |sin|), it is

    gap / H = t sqrt(t^2 - q) - q arcosh(t / sqrt(q))         d gap / d height = -sqrt(1 - q / t^2)

for t^2 > q, and 0 at the crests, which are followed always. The valley is filled by the share
1 - sqrt(1 - q) + q arcosh(1 / sqrt(q)): 0.46 at q = 1/4, 0.73 at 1/2, 1 from 1 on.
Source: K. L. Johnson, Contact Mechanics, 1985, section 13.2, after H. M. Westergaard, 1939.

Exact for waves. Other patterns are treated as a wave of their height range and of their slope: for
the wave p* = E* rms(slope) / sqrt(2), and that is taken for all. Left out: that crossed ridges and
dots need some 1.4 times the pressure; friction; that the skin is a layer and not a half-space,
which matters for periods beyond its thickness; pressure that differs within one period.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.objects.fine_surface import FineSurface

LEAST_SHARE = 1e-6
"""Smallest share of the full pressure that is told from none."""
PRESSURES = 65
"""Shares of the full pressure at which the mean gap is tabulated."""
MOST_HEIGHTS = 2000
"""Heights of the relief that stand for all in that mean."""


def full_pressure_MPa(slope_rms: float, plane_strain_MPa: float) -> float:
    """Pressure p* at which all of a relief is touched."""
    return plane_strain_MPa * slope_rms / 2.0**0.5


def gap_share(depth_share: np.ndarray, pressure_share: np.ndarray) -> np.ndarray:
    """Gap between skin and relief over the relief's height, shape (N,).

    Args:
        depth_share: Depth below the crest over the relief's height, t^2 in [0, 1], shape (N,).
        pressure_share: q = p / p*, shape (N,) or ().
    """
    q = np.clip(pressure_share, LEAST_SHARE, 1.0)
    square = np.maximum(depth_share, q)
    ratio = np.sqrt(square / q)
    return np.sqrt(square * (square - q)) - q * np.arccosh(np.maximum(ratio, 1.0))


def followed_slope(depth_share: np.ndarray, pressure_share: np.ndarray) -> np.ndarray:
    """Slope of the skin over that of the relief, in [0, 1], shape (N,); arguments as above."""
    q = np.clip(pressure_share, LEAST_SHARE, 1.0)
    return 1.0 - np.sqrt(1.0 - q / np.maximum(depth_share, q))


@dataclass(frozen=True, kw_only=True, slots=True)
class Filling:
    """The skin over one relief."""

    surface: FineSurface
    full_MPa: float
    """p* of the relief."""
    shares: np.ndarray
    """Shares of p* from 0 to 1, shape (P,)."""
    mean_gap_mm: np.ndarray
    """Mean gap at each [mm], shape (P,)."""

    def heights(
        self, place_mm: np.ndarray, pressure_MPa: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Height of the skin [mm], (N,), and its slopes along body X and Y, (N, 2).

        Without mean, whatever the pressure: how deep the object sits is the contact stage's
        matter. So the height falls to 0 with the pressure, and no step shows at a patch's rim.

        Args:
            place_mm: Body X and Y, shape (N, 2).
            pressure_MPa: Shape (N,).
        """
        height, slopes = self.surface.read(place_mm)
        range_mm = self.surface.high_mm - self.surface.low_mm
        depth = np.clip((self.surface.high_mm - height) / range_mm, 0.0, 1.0)
        share = np.clip(pressure_MPa / self.full_MPa, 0.0, 1.0)
        skin = height + range_mm * gap_share(depth, share)
        skin -= np.interp(share, self.shares, self.mean_gap_mm)
        return skin, slopes * followed_slope(depth, share)[:, None]


def filling(surface: FineSurface, plane_strain_MPa: float) -> Filling:
    """A relief and the elastomer that is pressed on it."""
    heights = np.sort(surface.raster[..., 0], axis=None).astype(np.float64)
    if len(heights) > MOST_HEIGHTS:
        # Middles of equal parts of the distribution.
        parts = (np.arange(MOST_HEIGHTS) + 0.5) / MOST_HEIGHTS
        heights = heights[(parts * len(heights)).astype(np.int64)]
    range_mm = surface.high_mm - surface.low_mm
    depth = np.clip((surface.high_mm - heights) / range_mm, 0.0, 1.0)
    # Even in the root, as the gap falls steeply at little pressure.
    shares = np.linspace(0.0, 1.0, PRESSURES) ** 2
    means = [range_mm * float(gap_share(depth, np.array(share)).mean()) for share in shares]
    return Filling(
        surface=surface,
        full_MPa=full_pressure_MPa(surface.slope_rms, plane_strain_MPa),
        shares=shares,
        mean_gap_mm=np.array(means),
    )
