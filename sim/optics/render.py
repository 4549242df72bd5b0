"""Tactile images of a press: the camera's view of the deformed, lit skin.

Composition, as in the paper: image = background + (foreground deformed - foreground undeformed).
Where nothing moved the two foregrounds are one and the same and the image is the background,
exactly. For `linear` and `plane_target` the background is rendered with the linear field and the
foreground with the chosen one; `direct` renders both with its one physical model.
Source: SimTac, "Online image rendering". Left out: noise, blur, and the shadow that a dent casts
on skin that did not move.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.camera import refracted_rays
from sim.optics.display import choose_exposure, encode
from sim.optics.gbuffer import GBuffer, Moved, View, interpolate, look, open_view
from sim.optics.markers import (
    INK_REFLECTANCE,
    TIP_REFLECTANCE,
    Coverage,
    Dots,
    centroids,
    dots_at,
    ink,
    no_ink,
    print_dots,
)
from sim.optics.places import check_camera
from sim.optics.shading import directions_to_camera, relight, shade, straight, take
from workbench.core.check import expect
from workbench.core.errors import OpticsError
from workbench.core.light import LightField
from workbench.core.lighting import LightModel
from workbench.core.monitor import Monitor, silent
from workbench.core.optics import Optics
from workbench.core.results import MembraneMesh
from workbench.core.sensing import TactileFrames

LEAST_ALBEDO = 0.01
"""Darkest skin that white tips are compared with [1]: carbon-black silicone returns 2 to 5 %."""


@dataclass(frozen=True, kw_only=True)
class _Scene:
    """What all frames of one call share."""

    view: View
    light: LightField
    model: LightModel
    optics: Optics
    foreground: np.ndarray
    """Undeformed foreground radiance per vertex, shape (V, 3), float32."""
    bare: np.ndarray
    """Background radiance per pixel without ink, shape (N, 3), float32."""
    remainder: np.ndarray
    """Background minus undeformed foreground per pixel, shape (N, 3), float32: what a deformed
    foreground is added to. Zero where both come from one field."""
    dots: Dots
    ink_gain: float
    """Radiance of ink over that of the bare skin [1]."""
    coverage: Coverage
    exposure: float


def shoot(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    *,
    displacement_mm: np.ndarray | None = None,
    monitor: Monitor = silent,
) -> TactileFrames:
    """Render the background and one image per frame of displacement.

    Args:
        mesh: The undeformed skins.
        light: Light field baked on `mesh.seen`; its model decides the rendering.
        optics: Camera, coating, markers, refractive index.
        displacement_mm: Of the vertices of `mesh.seen` [mm], shape (K, V, 3); None renders the
            background.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If the camera is outside the cavity or sees nothing of the skin.
        OpticsError: If no light reaches what the camera sees, or a displacement is not finite.
    """
    vertices = len(mesh.seen.points_mm)
    expect(light.irradiance, f"L {vertices}", name="light field")
    if displacement_mm is None:
        displacement_mm = np.zeros((0, vertices, 3), dtype=np.float32)
    expect(displacement_mm, f"K {vertices} 3", name="displacement")
    return Studio(mesh, light, optics, monitor=monitor).shoot(displacement_mm, monitor=monitor)


class Studio:
    """Camera, light and background of one sensor, ready for images of its deformed skin."""

    def __init__(
        self,
        mesh: MembraneMesh,
        light: LightField,
        optics: Optics,
        *,
        monitor: Monitor = silent,
    ) -> None:
        self._scene = _open_scene(mesh, light, optics, monitor)

    def shoot(self, displacement_mm: np.ndarray, *, monitor: Monitor = silent) -> TactileFrames:
        """The background and one image per frame of displacement [mm], shape (K, V, 3).

        Raises:
            OpticsError: If a displacement is not finite.
        """
        frames = _blank(self._scene, len(displacement_mm))
        for number, displacement in enumerate(displacement_mm, start=1):
            note = f"image {number} of {len(displacement_mm)}"
            monitor(0.3 + 0.7 * (number - 1) / len(displacement_mm), note)
            if not np.isfinite(displacement).all():
                raise OpticsError(
                    f"the displacement of frame {number} is not finite",
                    hint="the contact solver diverged: press less deep",
                    at="press.depth_mm",
                )
            _expose(self._scene, look(self._scene.view, displacement), frames, number)
        monitor(1.0, "images ready")
        return frames


def _open_scene(mesh: MembraneMesh, light: LightField, optics: Optics, monitor: Monitor) -> _Scene:
    monitor(0.0, "camera rays")
    check_camera(mesh, optics.camera)
    rays = refracted_rays(optics.camera, mesh.cavity, optics.refractive_index)
    monitor(0.1, "undeformed skin")
    view = open_view(mesh.seen, optics.camera, rays)
    seen = view.background
    monitor(0.2, "background")
    foreground, behind = _undeformed_radiance(view, light, optics)
    bare, remainder = (np.zeros((len(rays.direction), 3), dtype=np.float32) for _ in range(2))
    bare[seen.pixel] = _to_pixels(view, behind, seen)
    remainder[seen.pixel] = bare[seen.pixel] - _to_pixels(view, foreground, seen)
    dots, gain = _dots(mesh, LightModel(light.model), optics)
    coverage = ink(
        no_ink(len(bare)),
        seen.pixel,
        seen,
        dots=dots,
        skin=mesh.seen,
        camera=optics.camera,
        rays=rays,
    )
    # White tips on black skin are what must not be overexposed; black dots never are.
    shown = _inked(bare, coverage.ink, gain) if gain > 1.0 else bare
    exposure = choose_exposure(shown[seen.pixel])
    if exposure == 0.0:
        raise OpticsError(
            "no light reaches the part of the skin that the camera sees: the image would be black",
            hint="tilt or move the LEDs so that they shine on the skin (tilt_deg 0 is up)",
            at="optics.ring.tilt_deg",
        )
    return _Scene(
        view=view,
        light=light,
        model=LightModel(light.model),
        optics=optics,
        foreground=foreground,
        bare=bare,
        remainder=remainder,
        dots=dots,
        ink_gain=gain,
        coverage=coverage,
        exposure=exposure,
    )


def _dots(mesh: MembraneMesh, model: LightModel, optics: Optics) -> tuple[Dots, float]:
    """What is printed on the seen skin: tips of pins, else markers; and its gain."""
    if len(mesh.tips_mm):
        coating = optics.coating
        albedo = coating.albedo if model is LightModel.DIRECT else coating.phong_diffuse
        dots = dots_at(mesh.seen, mesh.tips_mm, mesh.tip_radius_mm, optics.camera)
        return dots, TIP_REFLECTANCE / max(albedo, LEAST_ALBEDO)
    return print_dots(mesh.seen, optics.markers, optics.camera), INK_REFLECTANCE


def _undeformed_radiance(
    view: View, light: LightField, optics: Optics
) -> tuple[np.ndarray, np.ndarray]:
    """Radiance of foreground and background per undeformed vertex, each (V, 3), float32."""
    model, skin = LightModel(light.model), view.skin
    to_camera = _to_camera(view, view.background, skin.points_mm)
    foreground = shade(model, light, optics.coating, -skin.normals, to_camera)
    if model is not LightModel.PLANE_TARGET:
        return foreground, foreground
    field = straight(light, skin.points_mm)
    return foreground, shade(LightModel.LINEAR, field, optics.coating, -skin.normals, to_camera)


def _to_pixels(view: View, radiance: np.ndarray, seen: GBuffer) -> np.ndarray:
    """Vertex radiance (V, 3) at the pixels of a g-buffer, dimmed by the cavity wall, (P, 3)."""
    arriving = interpolate(radiance, view.skin.faces, seen)
    return arriving * view.rays.transmittance[seen.pixel, None]


def _to_camera(view: View, seen: GBuffer, points_mm: np.ndarray) -> np.ndarray:
    camera_mm = np.asarray(view.camera.position_mm)
    return directions_to_camera(seen, view.rays, view.skin.faces, points_mm, camera_mm)


def _blank(scene: _Scene, count: int) -> TactileFrames:
    """Frames that all show the background."""
    rays, seen = scene.view.rays, scene.view.background
    shape = (rays.height_px, rays.width_px)
    depth = np.full(len(scene.bare), np.nan, dtype=np.float32)
    depth[seen.pixel] = seen.depth_z_mm
    normal = np.zeros((len(scene.bare), 3), dtype=np.float16)
    normal[seen.pixel] = seen.normal
    rgb = encode(_inked(scene.bare, scene.coverage.ink, scene.ink_gain), scene.exposure)
    uv = centroids(scene.coverage, len(scene.dots.centres_mm), rays.width_px)

    def repeated(array: np.ndarray) -> np.ndarray:
        return np.repeat(array[None], count + 1, axis=0)

    return TactileFrames(
        rgb=repeated(rgb.reshape(*shape, 3)),
        depth_z_mm=repeated(depth.reshape(shape)),
        normal=repeated(normal.reshape(*shape, 3)),
        moved=np.zeros((count + 1, *shape), dtype=bool),
        marker_uv_px=repeated(uv),
        exposure=scene.exposure,
    )


def _inked(radiance: np.ndarray, share: np.ndarray, gain: float) -> np.ndarray:
    return radiance * (1.0 + (gain - 1.0) * share)[:, None]


def _expose(scene: _Scene, moved: Moved, frames: TactileFrames, number: int) -> None:
    """Write frame `number`: only the pixels that moved differ from the background."""
    pixels, seen = moved.pixels, moved.seen
    if not pixels.size:
        return
    view = scene.view
    after = scene.remainder.copy()
    after[seen.pixel] += _to_pixels(view, _moved_radiance(scene, moved), seen)
    image = after[pixels]
    coverage = ink(
        scene.coverage,
        pixels,
        seen,
        dots=scene.dots,
        skin=view.skin,
        camera=view.camera,
        rays=view.rays,
    )
    image = _inked(np.maximum(image, 0.0), coverage.ink[pixels], scene.ink_gain)
    frames.rgb[number].reshape(-1, 3)[pixels] = encode(image, scene.exposure)
    depth = frames.depth_z_mm[number].reshape(-1)
    depth[pixels] = np.nan
    depth[seen.pixel] = seen.depth_z_mm
    normal = frames.normal[number].reshape(-1, 3)
    normal[pixels] = 0.0
    normal[seen.pixel] = seen.normal
    frames.moved[number].reshape(-1)[pixels] = True
    frames.marker_uv_px[number] = centroids(
        coverage, len(scene.dots.centres_mm), view.rays.width_px
    )


def _moved_radiance(scene: _Scene, moved: Moved) -> np.ndarray:
    """Foreground radiance per vertex of the deformed skin, shape (V, 3)."""
    vertices = moved.vertices
    points, normals = moved.points_mm[vertices], moved.normals[vertices]
    if scene.model is LightModel.DIRECT:
        exponent = scene.optics.ring.emission_exponent
        light = relight(
            scene.light,
            vertices,
            points,
            normals,
            travel_mm=np.linalg.norm(points - scene.view.skin.points_mm[vertices], axis=1),
            emission_exponent=exponent,
            patch=moved.patch,
        )
    else:
        light = take(scene.light, vertices)
    to_camera = _to_camera(scene.view, moved.seen, moved.points_mm)[vertices]
    radiance = scene.foreground.copy()
    radiance[vertices] = shade(scene.model, light, scene.optics.coating, -normals, to_camera)
    return radiance
