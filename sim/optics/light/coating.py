"""Light that the skin returns to the camera, by the paper's law and by ours: the plain twins.

`phong` is the paper's Eq. 4 and 5 without the ambient term, which is the background image:
I = sum over LEDs of kd (L . N) i + ks (R . V)^alpha i, R = 2 (L . N) N - L. Read with L toward the
light, N toward the camera, both products clamped at zero, and no highlight where L . N <= 0.

`glossy` is a diffuse base under a GGX lobe: radiance = sum of (rho (1 - F0) / pi + D G F) E (L . N)
with D = a^2 / (pi ((N . H)^2 (a^2 - 1) + 1)^2), Smith's height-correlated G / (4 (N.L) (N.V)), and
Schlick's F = F0 + (1 - F0) (1 - V . H)^5. Source: Walter et al., EGSR 2007; Heitz, JCGT 2014.
"""

from __future__ import annotations

import numpy as np

from workbench.core.design.optics import Coating

EDGE_ON = 1e-6
"""Cosine below which light grazes the skin: single-precision rounding of a tangential field."""
FLOOR = 1e-3
"""Smallest cosine in a denominator [1]; at 1e-3 the surface is seen edge-on."""


def phong(
    coating: Coating, direction: np.ndarray, normal: np.ndarray, to_camera: np.ndarray
) -> np.ndarray:
    """Eq. 4 of the paper for one light of unit intensity, shape (N,)."""
    facing = _dot(direction, normal)
    mirrored = 2.0 * facing * _dot(normal, to_camera) - _dot(direction, to_camera)
    lobe = np.maximum(mirrored, 0.0) ** np.float32(coating.phong_exponent)
    lit = coating.phong_diffuse * facing + coating.phong_specular * lobe
    # A field along the skin meets a flat skin edge-on; the sign of its rounding decides nothing.
    return np.where(facing > EDGE_ON, lit, np.float32(0.0))


def glossy(
    coating: Coating, direction: np.ndarray, normal: np.ndarray, to_camera: np.ndarray
) -> np.ndarray:
    """Radiance per perpendicular irradiance [1/sr] of diffuse plus GGX, cosine included, (N,)."""
    cos_light = _dot(direction, normal)
    cos_view = np.maximum(_dot(normal, to_camera), FLOOR)
    half = direction + to_camera
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), FLOOR)
    squared = np.float32(coating.roughness**2)
    spread = _dot(normal, half) ** 2 * (squared - 1.0) + 1.0
    lobe = squared / (np.pi * spread**2)
    lit = np.maximum(cos_light, FLOOR)
    smith_light = lit * np.sqrt(cos_view**2 * (1.0 - squared) + squared)
    smith_view = cos_view * np.sqrt(lit**2 * (1.0 - squared) + squared)
    # A surface of reflectance 0 is matte at every angle: below 0.02 the lobe fades edge-on, too.
    edge_on = min(50.0 * coating.specular, 1.0)
    away = 1.0 - np.clip(_dot(to_camera, half), 0.0, 1.0)
    fresnel = coating.specular + (edge_on - coating.specular) * away**5
    highlight = lobe * fresnel * 0.5 / (smith_light + smith_view)
    base = coating.albedo * (1.0 - coating.specular) / np.pi
    return (base + highlight) * np.maximum(cos_light, 0.0)


def _dot(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", left, right)
