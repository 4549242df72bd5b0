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

from dataclasses import dataclass

import numpy as np

from sim.contact.studies.closed_forms import layer_response
from sim.material import moduli_MPa

WAVES = 2000
"""Waves of the integral over what sets a layer apart from a half-space."""
SHORTEST = 12.0
"""Their largest k t: shorter waves do not reach the bottom."""
DISTANCES = 400
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
        from scipy.special import j0

        wave = np.linspace(0.0, SHORTEST / self.thickness_mm, WAVES + 1)[1:]
        short = layer_response(wave * self.thickness_mm, self.poisson)
        lost = (1.0 - short) * self._half_space(wave) * wave
        reach = np.linspace(0.0, max(float(distance_mm.max(initial=0.0)), disc_mm), DISTANCES)
        kernel = lost * j0(np.outer(reach, wave)) / (2.0 * np.pi)
        held = np.trapezoid(kernel, wave, axis=1) + 0.5 * kernel[:, 0] * wave[0]
        return self._free(distance_mm, disc_mm) - np.interp(distance_mm, reach, held)

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


def pressure_MPa(
    layer: Layer, places_mm: np.ndarray, area_mm2: np.ndarray, inward_mm: np.ndarray
) -> np.ndarray:
    """Pressure at places that an object may touch, shape (n,); nowhere negative.

    Args:
        layer: The wall.
        places_mm: Of the undeformed skin, shape (n, 3).
        area_mm2: That each stands for, shape (n,).
        inward_mm: Its displacement, shape (n,).
    """
    from scipy.optimize import nnls

    apart_mm = np.linalg.norm(places_mm[:, None] - places_mm[None], axis=2)
    disc_mm = float(np.sqrt(area_mm2.mean() / np.pi))
    moved = layer.response(apart_mm, disc_mm) * area_mm2[None]
    scale = float(np.trace(moved)) / max(len(moved), 1)
    held = np.sqrt(LEAST_GAIN) * scale * np.eye(len(moved))
    found, _ = nnls(np.concatenate([moved, held]), np.append(inward_mm, np.zeros(len(moved))))
    return found
