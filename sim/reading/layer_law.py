"""The pressure under a displacement that was read: a bonded elastic layer, in closed form.

A pressure p on a layer of thickness t that is bonded to something rigid and free of shear on top
moves its surface, wave by wave, by

    u(k) = p(k) (1 - nu) / (mu k) L(k t),

L being 1 for short waves, which see a half-space, and less for long ones (`layer_response`). Under
an object that only pushes, p is nowhere negative, and it vanishes where nothing touches.
Source: Johnson, Contact Mechanics, 1985, sections 3.4 and 5.8.
Left out: large strains, curvature of the skin, friction, a wall over gel or air.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from sim.contact.studies.closed_forms import layer_response
from sim.material import moduli_MPa

WAVES = 2000
"""Waves of the integral over what sets a layer apart from a half-space."""
SHORTEST = 12.0
"""Their largest k t: shorter waves do not reach the bottom."""
DISTANCES = 120
"""Of a thickness."""
LEAST_GAIN = 1e-6
"""Of the pressure that is penalised, over the stiffness of the layer."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Layer:
    """An elastic layer."""

    thickness_mm: float
    young_MPa: float
    poisson: float

    def compliance(self, wave_per_mm: np.ndarray) -> np.ndarray:
        """u(k) / p(k) [mm/MPa] of waves k > 0, same shape."""
        return self._half_space(wave_per_mm) * layer_response(
            wave_per_mm * self.thickness_mm, self.poisson
        )

    def _half_space(self, wave_per_mm: np.ndarray) -> np.ndarray:
        shear_MPa, _ = moduli_MPa(self.young_MPa, self.poisson)
        return (1.0 - self.poisson) / (shear_MPa * wave_per_mm)

    def response(self, distance_mm: np.ndarray, disc_mm: float) -> np.ndarray:
        """Displacement [mm/N] at distances from the middle of a disc that carries 1 N, same shape.

        Args:
            distance_mm: Of any shape.
            disc_mm: Radius of the disc, small against the thickness.
        """
        shear_MPa, _ = moduli_MPa(self.young_MPa, self.poisson)
        farthest = max(float(distance_mm.max(initial=0.0)), disc_mm) / self.thickness_mm
        reach, held = _held_back(self.poisson, max(1, math.ceil(farthest)))
        scale = (1.0 - self.poisson) / (2.0 * np.pi * shear_MPa * self.thickness_mm)
        at_mm = reach * self.thickness_mm
        return self._free(distance_mm, disc_mm) - scale * np.interp(distance_mm, at_mm, held)

    def _free(self, distance_mm: np.ndarray, disc_mm: float) -> np.ndarray:
        """The same of a half-space: Johnson, section 3.4, uniform pressure in a circle."""
        from scipy.special import ellipe, ellipk

        shear_MPa, _ = moduli_MPa(self.young_MPa, self.poisson)
        scale = 2.0 * (1.0 - self.poisson) / (np.pi**2 * shear_MPa * disc_mm**2)
        ratio = distance_mm / disc_mm
        far = np.maximum(ratio, 1.0)
        outside = far * (ellipe(far**-2) - (1.0 - far**-2) * ellipk(np.minimum(far**-2, 1 - 1e-12)))
        inside = ellipe(np.minimum(ratio, 1.0) ** 2)
        return scale * disc_mm * np.where(ratio < 1.0, inside, outside)


@functools.lru_cache(maxsize=32)
def _held_back(poisson: float, farthest: int) -> tuple[np.ndarray, np.ndarray]:
    """What the bottom keeps from moving, by the distance over the thickness.

    Returns:
        Distances r / t up to `farthest`, and the integral over x = k t of (1 - L(x)) J0(x r / t):
        of all layers of one Poisson's ratio the same.
    """
    from scipy.special import j0

    waves = np.linspace(0.0, SHORTEST, WAVES + 1)[1:]
    lost = 1.0 - layer_response(waves, poisson)
    reach = np.linspace(0.0, farthest, DISTANCES * farthest)
    kernel = lost * j0(np.outer(reach, waves))
    return reach, np.trapezoid(kernel, waves, axis=1) + 0.5 * kernel[:, 0] * waves[0]


def influence_mm_per_MPa(layer: Layer, places_mm: np.ndarray, area_mm2: np.ndarray) -> np.ndarray:
    """By how much pressure on the area of each place moves each place, shape (n, n).

    Args:
        layer: The wall.
        places_mm: Of the undeformed skin, shape (n, 3).
        area_mm2: That each stands for, shape (n,).
    """
    apart_mm = np.linalg.norm(places_mm[:, None] - places_mm[None], axis=2)
    disc_mm = float(np.sqrt(area_mm2.mean() / np.pi))
    return layer.response(apart_mm, disc_mm) * area_mm2[None]


def pressure_MPa(influence: np.ndarray, inward_mm: np.ndarray) -> np.ndarray:
    """Pressure at places that an object may touch, shape (n,); nowhere negative.

    Args:
        influence: Of the places on each other, shape (n, n) [mm/MPa].
        inward_mm: Their displacement, shape (n,).
    """
    from scipy.optimize import nnls

    scale = float(np.trace(influence)) / max(len(influence), 1)
    held = np.sqrt(LEAST_GAIN) * scale * np.eye(len(influence))
    rows = np.concatenate([influence, held])
    found, _ = nnls(rows, np.append(inward_mm, np.zeros(len(influence))))
    return found
