"""Light leaving the skin toward the camera, per vertex and colour channel: the plain twins.

Images are shaded by `shade_kernels`; these say the same in NumPy, and tests compare the two.

Shading at vertices and interpolating is as good as shading pixels at mesh edges of 0.4 mm, and
faster: the moved patch has ten times fewer vertices than pixels.

`coating` has the two laws of reflection.
Left out: light scattered from skin to skin, and the bending of light between LED and skin.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.surface.rays import RayCaster
from sim.optics.field.lines import SKIN_OFFSET_MM, toward
from sim.optics.field.model import Shading, background_model, model_of
from sim.optics.light.coating import glossy, phong
from sim.optics.light.lobe import emitted
from sim.optics.raster.gbuffer import MOVED_MM
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Coating
from workbench.core.result.light import LightField

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
    reflect = phong if model_of(model).paper else glossy
    normal, to_camera = normal.astype(np.float32), to_camera.astype(np.float32)
    total = np.zeros((len(normal), 3), dtype=np.float32)
    for number, rgb in enumerate(light.led_rgb.astype(np.float32)):
        received = light.irradiance[number]
        share = reflect(coating, light.direction[number], normal, to_camera) * received
        total += share[:, None] * rgb
    return total


def relight(
    light: LightField,
    still_mm: np.ndarray,
    points_mm: np.ndarray,
    normals: np.ndarray,
    *,
    patch: RayCaster | None,
    finest: float = 0.0,
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
        finest: Least radius of a light over its distance, `VertexLight.finest_shadow`.
    """
    start = points_mm - SKIN_OFFSET_MM * normals
    travel_mm = np.linalg.norm(points_mm - still_mm, axis=1)
    share = np.log(np.maximum(travel_mm, MOVED_MM) / MOVED_MM) / np.log(FULL_SHADOW_MM / MOVED_MM)
    depth_of_shadow = np.minimum(share, 1.0)
    direction, irradiance = np.empty_like(light.direction), np.zeros_like(light.irradiance)
    virtual = model_of(light.model).shading is Shading.HYBRID
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
            finest_mm = finest * distance * depth_of_shadow
            radius_mm = np.maximum(light.led_size_mm[number] / 2.0, finest_mm)
            shadow = hidden_share(patch, start, line * distance[:, None], radius_mm)
            received = received * (1.0 - depth_of_shadow * shadow)
        irradiance[number] = np.where(np.einsum("ij,ij->i", line, normals) < 0.0, received, 0.0)
    return dataclasses.replace(light, direction=direction, irradiance=irradiance)


def hidden_share(
    patch: RayCaster, start_mm: np.ndarray, line_mm: np.ndarray, radius_mm: np.ndarray
) -> np.ndarray:
    """Share of each light's disc that a patch hides, shape (N,): of four points, or of eight.

    Args:
        patch: Casts the moved triangles.
        start_mm: Where the lights are looked at from, shape (N, 3).
        line_mm: From there to the middle of the disc, which faces the place, shape (N, 3).
        radius_mm: Of the discs, shape (N,).
    """
    way = line_mm / np.linalg.norm(line_mm, axis=1, keepdims=True)
    helper = np.where(np.abs(way[:, :1]) > 0.7, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    across = np.cross(way, helper)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    along = np.cross(way, across)
    hidden = []
    for out, first in ((np.sqrt(0.75), 0.0), (0.5, np.pi / 4.0)):
        for turn in first + np.arange(4) * np.pi / 2.0:
            aside = np.cos(turn) * across + np.sin(turn) * along
            line = line_mm + out * radius_mm[:, None] * aside
            length = np.linalg.norm(line, axis=1)
            hidden.append(patch.occluded(start_mm, line / length[:, None], length))
    share = np.array(hidden)
    outer = share[:4].mean(axis=0)
    return np.where((outer > 0.0) & (outer < 1.0), share.mean(axis=0), outer)


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
        model=str(background_model()),
        direction=np.stack(direction).astype(np.float32),
        irradiance=np.ones_like(light.irradiance),
    )
