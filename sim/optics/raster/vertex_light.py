"""A light field, its table and the coating as the plain arrays that vertices are shaded from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.surface import face_areas
from sim.optics.field.model import model_of
from sim.optics.field.table import mean_reflectance
from sim.optics.light.lights import ambient_irradiance
from workbench.core.base.errors import OpticsError
from workbench.core.design.optics import Optics
from workbench.core.result.light import TILTS, LightField, NormalTable, Scattered
from workbench.core.result.results import Skin

SHADOW_SPAN_MM = 2.0
"""Distance between what casts a shadow in a dent and what it falls on [mm]: dents of 1 to 3 mm."""


@dataclass(frozen=True, kw_only=True, slots=True)
class VertexLight:
    """L lights on V vertices."""

    way_of_lighting: int
    """As in `shade_kernels`."""
    light: np.ndarray
    """Baked direction and irradiance, shape (V, L, 4), float32."""
    led_mm: np.ndarray
    """Shape (L, 3), float32."""
    led_axis: np.ndarray
    """Shape (L, 3), float32."""
    led_rgb: np.ndarray
    """Shape (L, 3), float32."""
    led_shape: np.ndarray
    """Exponent and cosine of half the cone, shape (L, 2), float32."""
    led_radius_mm: np.ndarray
    """Of the emitting discs [mm], shape (L,), float32."""
    table: np.ndarray
    """Of this camera, shape (1, N, TILTS, TILTS, 3), float32."""
    nodes: np.ndarray
    """`Scattered.nodes`, shape (V, 3), int32."""
    weights: np.ndarray
    """`Scattered.weights`, shape (V, 3), float32."""
    node_frames: np.ndarray
    """`Scattered.frame`, shape (N, 3, 3), float32."""
    diffuse: float
    specular: float
    gloss: float
    """Phong's exponent, or the roughness of GGX."""
    ambient: np.ndarray
    """Radiance of the skin in light that comes evenly from all sides, shape (3,), float32."""
    finest_shadow: float
    """Radius of a light over its distance whose penumbra is as wide as a triangle [1]."""


def vertex_light(
    light: LightField, table: NormalTable | None, optics: Optics, skin: Skin, *, camera: int
) -> VertexLight:
    """Arrays for one camera.

    Args:
        light: The baked field; `light.model` decides.
        table: For the models that look radiance up.
        optics: Its coating and ambient light.
        skin: What the light falls on.
        camera: Number of the camera in the table.

    Raises:
        OpticsError: If a table is wanted and missing.
    """
    model = model_of(light.model)
    scattered = light.scattered
    if model.tabulated and (table is None or scattered is None):
        raise OpticsError(
            f"the light model {light.model} looks radiance up, but there is no table of it",
            hint="bake the light and tabulate it first",
            at="optics.light_model",
        )
    vertices = light.irradiance.shape[1]
    if scattered is None or table is None or not model.tabulated:
        scattered, values = _no_table(vertices)
    else:
        values = table.values[camera : camera + 1]
    phong, coating = model.paper, optics.coating
    baked = np.concatenate([light.direction, light.irradiance[..., None]], axis=2)
    return VertexLight(
        way_of_lighting=int(model.shading),
        light=np.ascontiguousarray(baked.transpose(1, 0, 2), dtype=np.float32),
        led_mm=light.led_mm.astype(np.float32),
        led_axis=light.led_axis.astype(np.float32),
        led_rgb=light.led_rgb.astype(np.float32),
        led_shape=np.column_stack([light.led_exponent, light.led_cone]).astype(np.float32),
        led_radius_mm=(light.led_size_mm / 2.0).astype(np.float32),
        table=np.ascontiguousarray(values, dtype=np.float32),
        nodes=scattered.nodes.astype(np.int32),
        weights=scattered.weights.astype(np.float32),
        node_frames=np.ascontiguousarray(scattered.frame, dtype=np.float32),
        diffuse=coating.phong_diffuse if phong else coating.albedo,
        specular=coating.phong_specular if phong else coating.specular,
        gloss=coating.phong_exponent if phong else coating.roughness,
        ambient=np.zeros(3, np.float32) if phong else ambient_radiance(optics, skin),
        finest_shadow=_edge_mm(skin) / (2.0 * SHADOW_SPAN_MM),
    )


def ambient_radiance(optics: Optics, skin: Skin) -> np.ndarray:
    """Radiance of a skin whose whole area takes the power of the ambient light, (3,), float32.

    The same from everywhere: irradiance times the mean reflectance, over pi.
    """
    falling = ambient_irradiance(
        optics.ambient, float(face_areas(skin.points_mm, skin.faces).sum())
    )
    return (falling * mean_reflectance(optics.coating) / np.pi).astype(np.float32)


def _edge_mm(skin: Skin) -> float:
    """Edge of an equilateral triangle of the skin's median area [mm]."""
    area_mm2 = np.median(face_areas(skin.points_mm, skin.faces))
    return float(np.sqrt(area_mm2 * 4.0 / np.sqrt(3.0)))


def _no_table(vertices: int) -> tuple[Scattered, np.ndarray]:
    """What stands in for a table in the models that have none; no kernel reads it."""
    from workbench.core.result.light import AZIMUTHS, SINES

    bins = np.zeros((1, 3, AZIMUTHS * (len(SINES) - 1)), dtype=np.float32)
    nothing = Scattered(
        frame=np.eye(3, dtype=np.float32)[None],
        first=bins,
        rest=bins,
        nodes=np.zeros((vertices, 3), dtype=np.int32),
        weights=np.zeros((vertices, 3), dtype=np.float32),
        balance={},
        photons=0,
    )
    return nothing, np.zeros((1, 1, TILTS, TILTS, 3), dtype=np.float32)
