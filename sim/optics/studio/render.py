"""Tactile images of a press: the camera's view of the deformed, lit skin.

A `Studio` is one camera of one sensor with its light. Opening it casts rays, projects the vertices
and shades the undeformed skin; frames then only draw, shade and compose what moved, on the compute
device (`imager`), which the process must have opened. How images are composed stands in `backdrop`,
what an absolute image adds in `absolute`.
"""

from __future__ import annotations

import numpy as np

from sim.optics.raster.display import looked_up
from sim.optics.raster.imager import Imager
from sim.optics.raster.markers import Coverage, centroids
from sim.optics.raster.raster_kernels import SAME
from sim.optics.studio.absolute import cast_change
from sim.optics.studio.detail import Detail, DetailPixels
from sim.optics.studio.studio_scene import StudioScene, open_scene
from workbench.core.base.check import expect
from workbench.core.base.errors import OpticsError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.camera import Camera
from workbench.core.design.optics import Composition, Optics
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sensing import TactileFrames


def shoot(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    *,
    table: NormalTable | None = None,
    camera: Camera | None = None,
    displacement_mm: np.ndarray | None = None,
    monitor: Monitor = silent,
) -> TactileFrames:
    """Render the background and one image per frame of displacement.

    Args:
        mesh: The undeformed skins.
        light: Light field baked on `mesh.seen`; its model decides the rendering.
        optics: Coating, markers, refractive index, background and cameras.
        table: For the models that look radiance up.
        camera: One of the sensor's cameras; None is the first.
        displacement_mm: Of the vertices of `mesh.seen` [mm], shape (K, V, 3); None renders the
            background.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If the camera is outside the cavity or sees nothing of the skin.
        OpticsError: If no light reaches what the camera sees, or a displacement is not finite.
    """
    studio = Studio(mesh, light, optics, table=table, camera=camera, monitor=monitor)
    if displacement_mm is None:
        displacement_mm = np.zeros((0, len(mesh.seen.points_mm), 3), dtype=np.float32)
    return studio.shoot(displacement_mm, monitor=monitor)


class Studio:
    """Camera, light and background of one sensor, ready for images of its deformed skin."""

    def __init__(
        self,
        mesh: MembraneMesh,
        light: LightField,
        optics: Optics,
        *,
        table: NormalTable | None = None,
        camera: Camera | None = None,
        radiance: np.ndarray | None = None,
        monitor: Monitor = silent,
    ) -> None:
        """Prepare one camera.

        Args:
            radiance: Of the undeformed vertices toward the camera, shape (V, 3), where the light
                model is `photons`.

        The others, and what is raised, are as for `shoot`.
        """
        expect(light.irradiance, f"L {len(mesh.seen.points_mm)}", name="light field")
        self._scene: StudioScene = open_scene(
            mesh, light, optics, table, camera or optics.camera, radiance, monitor
        )
        self.imager: Imager = self._scene.imager
        self._absolute = optics.composition is Composition.ABSOLUTE
        self.imager.whole_shadows = self._absolute
        view = self.imager.raster.view
        self.rays = view.rays
        """The rays of the image's pixels."""
        self.visible: np.ndarray = view.visible
        """Vertices that the camera sees of the undeformed skin, shape (V,), bool."""

    @property
    def to_camera(self) -> np.ndarray:
        """Unit vectors from the undeformed vertices along the bent ray, shape (V, 3), float32."""
        return self.imager.raster.view.to_camera

    @property
    def exposure(self) -> np.ndarray:
        """From radiance behind the cavity wall to display light, (H, W, 3), float32.

        The exposure, the gain of each colour, and what the lens keeps at each pixel.
        """
        back = self.imager.backdrop
        return (back.lens_share[:, None] * back.exposure).reshape(*self.imager.shape, 3)

    @property
    def vertex_pixels(self) -> np.ndarray:
        """u, v [px] and range [mm] of the undeformed vertices, shape (V, 3), float32.

        NaN where a vertex lies outside the image; hidden ones have their pixel.
        """
        view = self.imager.raster.view
        found = np.column_stack([view.start_pixel + 0.5 - view.pad_px, view.range_mm])
        size = np.array([view.width_px, view.height_px])
        inside = view.projects & (found[:, :2] >= 0.0).all(axis=1)
        inside &= (found[:, :2] <= size).all(axis=1)
        found[~inside] = np.nan
        return found

    def images(
        self, displacement_mm: np.ndarray, *, radiance: np.ndarray | None = None
    ) -> np.ndarray:
        """Images alone, shape (K, H, W, 3), uint8, of displacements [mm], shape (K, V, 3).

        Args:
            displacement_mm: Of the vertices of `mesh.seen` in each frame.
            radiance: Of each frame's vertices where the model is `photons`, shape (K, V, 3).

        Raises:
            OpticsError: If a displacement is not finite.
        """
        self._check(displacement_mm)
        if self._scene.plain and not self._absolute:
            return self.imager.images(displacement_mm, radiance)
        rows, columns = self.imager.shape
        found = np.empty((len(displacement_mm), rows, columns, 3), dtype=np.uint8)
        for number, moved in enumerate(displacement_mm):
            self.imager.look(moved[None], None if radiance is None else radiance[number, None])
            found[number] = self._developed(number + 1)
        return found

    def marked(self, displacement_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Image (H, W, 3), uint8, and dots of one displaced skin, (V, 3); as `images`.

        The dots are u, v [px], shape (M, 2), float32; NaN of those not seen.
        """
        return self.images(displacement_mm[None])[0], self.imager.marker_px()

    def linear(
        self, displacement_mm: np.ndarray, *, radiance: np.ndarray | None = None
    ) -> np.ndarray:
        """Linear radiance with ink, before the image sensor, (K, H, W, 3), float32; as `images`."""
        self._check(displacement_mm)
        if not self._absolute:
            return self.imager.linear(displacement_mm, radiance)
        rows, columns = self.imager.shape
        found = np.empty((len(displacement_mm), rows, columns, 3), dtype=np.float32)
        for number, moved in enumerate(displacement_mm):
            self.imager.look(moved[None], None if radiance is None else radiance[number, None])
            found[number] = self._linear().reshape(rows, columns, 3)
        return found

    def detailed(self, displacement_mm: np.ndarray, detail: Detail) -> np.ndarray:
        """Linear radiance of one displaced skin, (V, 3), with the detail of frame 0: (N, 3)."""
        self._check(displacement_mm[None])
        self.imager.look(displacement_mm[None])
        return self._linear(detail.seen(self.imager, 0))

    def radiance_at_vertices(self, displacement_mm: np.ndarray) -> np.ndarray:
        """Foreground radiance of all vertices of one displaced skin, (V, 3) to (V, 3), float32."""
        self._check(displacement_mm[None])
        self.imager.look(displacement_mm[None])
        raster = self.imager.raster
        entries = raster.vertex_list.to_numpy()[: raster.vertex_entries]
        radiance = self.imager.backdrop.undeformed.copy()
        radiance[entries] = raster.radiance.to_numpy()[entries]
        return radiance

    def shade_tilted(self, normals: np.ndarray) -> np.ndarray:
        """Radiance of the undeformed skin if its outward unit normals were these, both (V, 3)."""
        return self.imager.shader.undeformed(normals)

    def shoot(
        self,
        displacement_mm: np.ndarray,
        *,
        radiance: np.ndarray | None = None,
        detail: Detail | None = None,
        monitor: Monitor = silent,
    ) -> TactileFrames:
        """The background and one image per frame, with depth, normals and markers; as `images`.

        Args:
            detail: The object's fine relief in these frames.
        """
        self._check(displacement_mm)
        count = len(displacement_mm)
        frames = _blank(self._scene, count)
        for number, moved in enumerate(displacement_mm, start=1):
            monitor(0.3 + 0.7 * (number - 1) / count, f"image {number} of {count}")
            self.imager.look(moved[None], None if radiance is None else radiance[number - 1, None])
            fine = None if detail is None else detail.seen(self.imager, number - 1)
            self._expose(frames, number, fine)
        monitor(1.0, "images ready")
        return frames

    def _check(self, displacement_mm: np.ndarray) -> None:
        expect(displacement_mm, f"K {self.imager.raster.vertices} 3", name="displacement")
        for number, moved in enumerate(displacement_mm, start=1):
            if not np.isfinite(moved).all():
                raise OpticsError(
                    f"the displacement of frame {number} is not finite",
                    hint="the contact solver diverged: press less deep",
                    at="press.depth_mm",
                )

    def _expose(self, frames: TactileFrames, number: int, fine: DetailPixels | None) -> None:
        """Write frame `number`: only the pixels that moved differ from the background."""
        scene, raster, axis = self._scene, self.imager.raster, self.imager.backdrop.axis
        changed = raster.seen.triangle.to_numpy()[: raster.pixels] != SAME
        rgb = frames.rgb[number].reshape(-1, 3)
        if scene.plain and not self._absolute:
            self.imager.expose(rgb[None])
            if fine is not None:
                light = self._linear(fine) * self.exposure.reshape(-1, 3)
                rgb[fine.pixel] = looked_up(light[fine.pixel], self.imager.backdrop.curve)
        else:
            frames.rgb[number] = self._developed(number, fine)
        frames.moved[number].reshape(-1)[changed] = True
        normal = np.zeros((raster.pixels, 3), dtype=np.float32)
        depth = np.zeros(raster.pixels, dtype=np.float32)
        self.imager.describe(normal, depth)
        if fine is not None:
            normal[fine.pixel] = fine.normal
            depth[fine.pixel] += fine.away_mm * (raster.view.direction[fine.pixel] @ axis)
        frames.depth_z_mm[number].reshape(-1)[changed] = depth[changed]
        frames.normal[number].reshape(-1, 3)[changed] = normal[changed]
        if len(scene.dots_mm):
            frames.marker_uv_px[number] = self.imager.marker_px()

    def _linear(self, fine: DetailPixels | None = None) -> np.ndarray:
        """Linear light of the frame just looked at, with its detail, shape (N, 3), float32."""
        raster, back = self.imager.raster, self.imager.backdrop
        linear = np.empty((1, raster.pixels, 3), dtype=np.float32)
        self.imager.gather_light(linear)
        if fine is not None:
            factor = raster.view.transmittance[fine.pixel]
            if len(back.dots_mm):
                factor = factor * (1.0 + (back.ink_gain - 1.0) * self.imager.ink()[1][fine.pixel])
            brought = linear[0, fine.pixel] + factor[:, None] * fine.change
            linear[0, fine.pixel] = np.maximum(brought, 0.0)
        if self._absolute:
            linear[0] = np.maximum(linear[0] + cast_change(self.imager), 0.0)
        return linear[0]

    def _developed(self, number: int, fine: DetailPixels | None = None) -> np.ndarray:
        """The frame just looked at, through the image sensor: (H, W, 3), uint8."""
        raster = self.imager.raster
        linear = self._linear(fine)
        face = raster.seen.triangle.to_numpy()[: raster.pixels]
        away = raster.view.travelled_mm + raster.seen.away_mm.to_numpy()[: raster.pixels]
        range_mm = np.where(face == SAME, self._scene.range_mm, np.where(face >= 0, away, np.nan))
        rgb = self._scene.develop(linear, range_mm, number)
        if self._scene.unit is not None:
            normal = np.zeros((raster.pixels, 3), dtype=np.float32)
            self.imager.describe(normal, np.zeros(raster.pixels, dtype=np.float32))
            self._scene.add_residual(rgb, normal, face != SAME)
        return rgb


def _blank(scene: StudioScene, count: int) -> TactileFrames:
    """Frames that all show the background."""
    back, seen = scene.imager.backdrop, scene.seen
    rows, columns = scene.imager.shape
    depth = np.full(rows * columns, np.nan, dtype=np.float32)
    depth[seen.pixel] = seen.depth_z_mm
    normal = np.zeros((rows * columns, 3), dtype=np.float16)
    normal[seen.pixel] = seen.normal
    uv = centroids(Coverage(marker=back.marker, ink=back.ink), len(scene.dots_mm), columns)

    def repeated(array: np.ndarray) -> np.ndarray:
        return np.repeat(array[None], count + 1, axis=0)

    return TactileFrames(
        rgb=repeated(back.background_rgb.reshape(rows, columns, 3)),
        depth_z_mm=repeated(depth.reshape(rows, columns)),
        normal=repeated(normal.reshape(rows, columns, 3)),
        moved=np.zeros((count + 1, rows, columns), dtype=bool),
        marker_uv_px=repeated(uv),
        exposure=back.exposure,
        marker_mm=scene.dots_mm.astype(np.float32),
    )
