"""Opening a studio: rays, light on the undeformed skin, background, exposure and ink."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from sim.optics.camera.camera import focal_px, rotation_camera_to_sensor
from sim.optics.camera.lens import ANGULAR
from sim.optics.field.model import model_of
from sim.optics.light.places import camera_field, check_camera
from sim.optics.raster.backdrop import Backdrop, at_pixels
from sim.optics.raster.display import choose_exposure, encode, grey_table, looked_up
from sim.optics.raster.gbuffer import GBuffer, Hits, describe
from sim.optics.raster.image_sensor import develop, fixed_exposure, kept_light
from sim.optics.raster.imager import Imager
from sim.optics.raster.raster import Raster
from sim.optics.raster.shader import Shader
from sim.optics.raster.shading import straight
from sim.optics.raster.skin_view import SkinView, open_skin_view
from sim.optics.raster.vertex_light import vertex_light
from sim.optics.studio.printed import Printed, printed_on
from sim.optics.studio.unit_residual import UnitResidual, places, read_unit, slopes
from workbench.core.base.errors import OpticsError
from workbench.core.base.monitor import Monitor
from workbench.core.design.camera import LEAST_KEPT, Camera
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.results import MembraneMesh


@dataclass(frozen=True, kw_only=True, slots=True)
class StudioScene:
    """What all frames of one studio share."""

    camera: Camera
    imager: Imager
    seen: GBuffer
    """What the pixels see of the undeformed skin; faces numbered as in the tree."""
    range_mm: np.ndarray
    """Length of each pixel's line of sight to the undeformed skin [mm], shape (N,); NaN."""
    dots_mm: np.ndarray
    """Reference places of dots or tips [mm], shape (M, 3), float64."""
    unit: UnitResidual | None
    """What the built sensor shows beyond its design's light."""

    @property
    def plain(self) -> bool:
        """Whether each pixel's grey level follows from its own light alone."""
        return develops_plainly(self.camera) and self.unit is None

    def add_residual(self, rgb: np.ndarray, normal: np.ndarray, changed: np.ndarray) -> None:
        """Add the unit's residual to an image (H, W, 3), uint8, in place, where it changed, (N,).

        Args:
            normal: Unit normals facing the camera, (N, 3), where it changed; 0 without skin.
        """
        if self.unit is None:
            return
        rest = np.zeros((len(changed), 3), dtype=np.float32)
        rest[self.seen.pixel] = self.seen.normal
        pixel = np.flatnonzero(changed & rest.any(axis=1) & normal.any(axis=1))
        slope = slopes(normal[pixel], rest[pixel], self.camera)
        change = self.unit.change(slope, places(pixel, rgb.shape[1], rgb.shape[0]))
        flat = rgb.reshape(-1, 3)
        flat[pixel] = np.clip(np.round(flat[pixel] + change), 0, 255).astype(np.uint8)

    def develop(self, linear: np.ndarray, range_mm: np.ndarray, number: int) -> np.ndarray:
        """Grey levels of linear light (N, 3) behind the image sensor, shape (H, W, 3), uint8."""
        rows, columns = self.imager.shape
        return develop(
            linear.reshape(rows, columns, 3),
            self.camera,
            exposure=self.imager.backdrop.exposure,
            range_mm=range_mm.reshape(rows, columns),
            frame=number,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Radiances:
    """Radiance per undeformed vertex toward the camera, shape (V, 3), float32 each."""

    undeformed: np.ndarray
    """As the vertices of a frame are shaded."""
    behind: np.ndarray
    """As the background is; another where the light model renders it by straight lines."""


def develops_plainly(camera: Camera) -> bool:
    """Whether each pixel's grey level follows from its own light alone: no noise and no blur."""
    return not camera.sensor.noise and camera.aperture_mm == 0.0


def behind_photo(camera: Camera) -> Camera:
    """The camera whose blur and noise a photograph of its own holds already."""
    sensor = dataclasses.replace(camera.sensor, noise=False)
    return dataclasses.replace(camera, aperture_mm=0.0, sensor=sensor)


def open_scene(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    table: NormalTable | None,
    camera: Camera,
    radiance: np.ndarray | None,
    monitor: Monitor,
) -> StudioScene:
    """Everything a studio needs, in plain arrays and on the device.

    Raises:
        DesignError: If the camera is outside the cavity or sees nothing of the skin.
        OpticsError: If the image would be black, saying why.
    """
    monitor(0.0, "camera rays")
    check_camera(mesh, camera, at=camera_field(optics, camera))
    view = open_skin_view(mesh, camera, index=optics.refractive_index)
    monitor(0.2, "light on the skin")
    raster = Raster(view)
    number = _number_of(camera, optics, table)
    shader = Shader(raster, vertex_light(light, table, optics, mesh.seen, camera=number))
    if shader.given:
        if radiance is None:
            raise OpticsError(
                "the light model photons needs the radiance of the undeformed skin",
                hint="trace its photons first",
                at="optics.light_model",
            )
        undeformed = radiance.astype(np.float32) + shader.lit.ambient
    else:
        undeformed = shader.undeformed()
    radiances = _Radiances(
        undeformed=undeformed,
        behind=_background_radiance(mesh, light, optics, raster, undeformed),
    )
    monitor(0.25, "background")
    seen = _background_buffer(mesh, camera, view)
    printed = printed_on(mesh, LightModel(light.model), optics, camera, view, seen)
    # The photograph is what the first camera saw; the others' backgrounds are rendered.
    if camera != optics.camera:
        optics = dataclasses.replace(optics, background=None, unit=None)
    unit = None if optics.unit is None else read_unit(optics.unit)
    if unit is not None and optics.background is None:
        optics = dataclasses.replace(optics, background=unit.idle)
    backdrop = _backdrop(optics, camera, view, seen, radiances, printed)
    range_mm = np.full(len(view.direction), np.nan, dtype=np.float32)
    first = view.layer_start[seen.pixel]
    range_mm[seen.pixel] = view.travelled_mm[seen.pixel] + view.layer_mm[first]
    if optics.background is not None:
        camera = behind_photo(camera)
    scene = StudioScene(
        camera=camera,
        imager=Imager(raster, shader, backdrop),
        seen=seen,
        range_mm=range_mm,
        dots_mm=printed.dots.centres_mm,
        unit=unit,
    )
    if develops_plainly(camera):
        return scene
    # The background passes through the image sensor like every other frame.
    developed = scene.develop(backdrop.background, range_mm, 0).reshape(-1, 3)
    shown = dataclasses.replace(backdrop, background_rgb=developed)
    return dataclasses.replace(scene, imager=Imager(raster, shader, shown))


def _number_of(camera: Camera, optics: Optics, table: NormalTable | None) -> int:
    """Number of a camera in the table."""
    if table is None or len(table.values) == 1:
        return 0
    return optics.all_cameras.index(camera)


def _background_radiance(
    mesh: MembraneMesh, light: LightField, optics: Optics, raster: Raster, undeformed: np.ndarray
) -> np.ndarray:
    """Radiance of the background per undeformed vertex, shape (V, 3), float32."""
    model = model_of(light.model)
    if not model.paper or model.straight:
        return undeformed
    lines = straight(light, mesh.seen.points_mm)
    return Shader(raster, vertex_light(lines, None, optics, mesh.seen, camera=0)).undeformed()


def _background_buffer(mesh: MembraneMesh, camera: Camera, view: SkinView) -> GBuffer:
    pixel = np.flatnonzero(np.diff(view.layer_start) > 0)
    layer = view.layer_start[pixel]
    found = Hits(
        pixel=pixel,
        distance_mm=view.layer_mm[layer],
        face=view.layer_face[layer],
        weights=view.layer_weights[layer],
    )
    return describe(found, view.faces, mesh.seen.normals, camera, view.rays)


def _backdrop(
    optics: Optics,
    camera: Camera,
    view: SkinView,
    seen: GBuffer,
    radiances: _Radiances,
    printed: Printed,
) -> Backdrop:
    dots, gain, coverage = printed.dots, printed.gain, printed.coverage
    factor = (1.0 + (gain - 1.0) * coverage.ink)[:, None].astype(np.float32)
    bare = at_pixels(view, radiances.behind)
    foreground = at_pixels(view, radiances.undeformed)
    # White tips on black skin are what must not be overexposed; black dots never are.
    bright = bare * factor if gain > 1.0 else bare
    lens_share = kept_light(camera).reshape(-1)
    falling = bright[seen.pixel] * lens_share[seen.pixel, None]
    exposure = fixed_exposure(camera, falling)
    _expect_light(falling, view.transmittance[seen.pixel], exposure)
    background, remainder, inked = bare * factor, bare - foreground, 1
    if optics.background is not None:
        from sim.optics.studio.background import photo_light, tied_exposure

        photo = photo_light(optics.background, camera).reshape(-1, 3)
        # Where the lens keeps nothing a photograph is dark, and must not be divided by that.
        lens_share = np.maximum(lens_share, LEAST_KEPT)
        if camera.sensor.exposure == 0.0:
            exposure = tied_exposure(photo[seen.pixel], falling)
        background = (photo / (exposure * lens_share[:, None])).astype(np.float32)
        remainder, inked = background - foreground * factor, 0
    curve = grey_table(camera.sensor)
    return Backdrop(
        undeformed=radiances.undeformed,
        background=background,
        remainder=remainder,
        inked_background=inked,
        background_rgb=looked_up(background * (exposure * lens_share[:, None]), curve),
        exposure=exposure.astype(np.float32),
        lens_share=lens_share,
        curve=curve,
        ink=coverage.ink,
        marker=coverage.marker,
        ink_gain=gain,
        dot_radius_mm=dots.radius_mm,
        dots_mm=dots.centres_mm.astype(np.float32),
        dot_start=printed.start,
        dot_of=printed.of,
        camera_mm=np.array(camera.position_mm, dtype=np.float32),
        axis=rotation_camera_to_sensor(camera)[:, 2].astype(np.float32),
        focal_px=focal_px(camera),
        angular=int(camera.lens in ANGULAR),
    )


def _expect_light(shown: np.ndarray, transmittance: np.ndarray, exposure: np.ndarray) -> None:
    """Refuse a background that would be black.

    Raises:
        OpticsError: Saying whether walls, lights or the exposure are the cause.
    """
    if not transmittance.any():
        raise OpticsError(
            "the cavity's wall reflects every line of sight back: the image would be black",
            hint="turn the camera so that it looks at the wall less flatly",
            at="optics.camera.wxyz",
        )
    if not shown.any() or not exposure.any():
        raise OpticsError(
            "no light reaches the part of the skin that the camera sees: the image would be black",
            hint="tilt or move the LEDs so that they shine on the skin (tilt_deg 0 is up)",
            at="optics.ring.tilt_deg",
        )
    if not encode(shown, exposure).any():
        chosen = choose_exposure(shown)
        raise OpticsError(
            f"exposure {exposure.max():g} leaves the whole image black",
            hint=f"set exposure to 0, which chooses {chosen:.3g} here",
            at="optics.camera.sensor.exposure",
        )
