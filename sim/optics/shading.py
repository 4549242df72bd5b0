"""Light leaving the skin toward the camera, per vertex and colour channel: the plain twins.

Images are shaded by `shade_kernels`; these say the same in NumPy, and tests compare the two.

Shading at vertices and interpolating is as good as shading pixels at mesh edges of 0.4 mm, and
faster: the moved patch has ten times fewer vertices than pixels.

`phong` is the paper's Eq. 4 and 5 without the ambient term, which is the background image:
I = sum over LEDs of kd (L . N) i + ks (R . V)^alpha i, R = 2 (L . N) N - L. Read with L toward the
light, N toward the camera, both products clamped at zero, and no highlight where L . N <= 0.

`glossy` is a diffuse base under a GGX lobe: radiance = sum of (rho (1 - F0) / pi + D G F) E (L . N)
with D = a^2 / (pi ((N . H)^2 (a^2 - 1) + 1)^2), Smith's height-correlated G / (4 (N.L) (N.V)), and
Schlick's F = F0 + (1 - F0) (1 - V . H)^5. Source: Walter et al., EGSR 2007; Heitz, JCGT 2014.
Left out: light scattered from skin to skin, and the bending of light between LED and skin.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.rays import RayCaster
from sim.optics.bake import SKIN_OFFSET_MM, emitted, toward
from sim.optics.gbuffer import MOVED_MM
from workbench.core.light import LightField
from workbench.core.lighting import PAPER, LightModel
from workbench.core.optics import Coating

EDGE_ON = 1e-6
"""Cosine below which light grazes the skin: single-precision rounding of a tangential field."""
FLOOR = 1e-3
"""Smallest cosine in a denominator [1]; at 1e-3 the surface is seen edge-on."""
FULL_SHADOW_MM = 0.03
"""Displacement from which a vertex takes the whole shadow of the dent [mm]. Skin that did not move
keeps its light, so a shadow must fade toward it, or it would end at a visible edge."""


def shade(
    model: LightModel,
    light: LightField,
    coating: Coating,
    normal: np.ndarray,
    to_camera: np.ndarray,
) -> np.ndarray:
    """Linear radiance per vertex, shape (N, 3), by the reflection law that belongs to the model.

    Args:
        model: The light model; the paper's fields use Phong, the others GGX.
        light: Light at these N vertices.
        coating: Reflectance of the skin.
        normal: Unit normals into the sensor, shape (N, 3).
        to_camera: Unit vectors from the vertices toward the camera along its ray, shape (N, 3).
    """
    reflect = phong if model in PAPER else glossy
    normal, to_camera = normal.astype(np.float32), to_camera.astype(np.float32)
    total = np.zeros((len(normal), 3), dtype=np.float32)
    for number, rgb in enumerate(light.led_rgb.astype(np.float32)):
        received = light.irradiance[number]
        share = reflect(coating, light.direction[number], normal, to_camera) * received
        total += share[:, None] * rgb
    return total


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


def relight(
    light: LightField,
    still_mm: np.ndarray,
    points_mm: np.ndarray,
    normals: np.ndarray,
    *,
    patch: RayCaster | None,
) -> LightField:
    """The light of `direct` and `hybrid` at moved vertices; `shade_kernels` has the equations.

    A vertex stays in shadow where the undeformed skin shadowed it, and falls into shadow where
    the moved patch comes between, the more the further it moved itself.

    Args:
        light: The field baked at these N vertices.
        still_mm: Their undeformed positions [mm], shape (N, 3).
        points_mm: Their deformed positions [mm], shape (N, 3).
        normals: Their outward unit normals, shape (N, 3).
        patch: Casts the moved triangles.
    """
    start = points_mm - SKIN_OFFSET_MM * normals
    travel_mm = np.linalg.norm(points_mm - still_mm, axis=1)
    share = np.log(np.maximum(travel_mm, MOVED_MM) / MOVED_MM) / np.log(FULL_SHADOW_MM / MOVED_MM)
    depth_of_shadow = np.minimum(share, 1.0)
    direction, irradiance = np.empty_like(light.direction), np.zeros_like(light.irradiance)
    virtual = light.model == LightModel.HYBRID
    for number, led in enumerate(light.led_mm):
        away = np.linalg.norm(led - still_mm, axis=1, keepdims=True)
        source = still_mm + away * light.direction[number] if virtual else led
        line = source - points_mm
        distance = np.linalg.norm(line, axis=1)
        line = line / distance[:, None]
        direction[number] = line
        if virtual:
            ratio = (away[:, 0] / distance) ** 2
        else:
            lobe = {
                "axis": light.led_axis[number],
                "exponent": float(light.led_exponent[number]),
                "cone": float(light.led_cone[number]),
            }
            then = emitted((led - still_mm) / away, away[:, 0], **lobe)
            ratio = emitted(line, distance, **lobe) / np.maximum(then, 1e-20)
        received = light.irradiance[number] * ratio
        if patch is not None:
            shadow = patch.occluded(start, line, distance)
            received = received * (1.0 - depth_of_shadow * shadow)
        irradiance[number] = np.where(_dot(line, normals) < 0.0, received, 0.0)
    return dataclasses.replace(light, direction=direction, irradiance=irradiance)


def take(light: LightField, vertices: np.ndarray) -> LightField:
    """The light field of some vertices only."""
    return dataclasses.replace(
        light, direction=light.direction[:, vertices], irradiance=light.irradiance[:, vertices]
    )


def straight(light: LightField, points_mm: np.ndarray) -> LightField:
    """The paper's linear field of the same LEDs at all vertices (V, 3): its background."""
    direction = [toward(led, points_mm)[0] for led in light.led_mm]
    return dataclasses.replace(
        light,
        model=str(LightModel.LINEAR),
        direction=np.stack(direction).astype(np.float32),
        irradiance=np.ones_like(light.irradiance),
    )


def _dot(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", left, right)
