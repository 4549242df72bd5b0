"""Validation of what pixels see: drawing, projection, the paper's depth map, and dents.

Drawing what moved is compared with casting every ray on the whole deformed skin, projection through
the wall with rays of a finer image, the paper's depth map with the exact one. What a dent changes
in the image stands beside the null, an image of the background alone.
"""

from __future__ import annotations

import dataclasses
import time
from dataclasses import dataclass

import numpy as np

from sim.optics.camera.camera import depth_z, refracted_rays
from sim.optics.camera.projection import open_map, project_points, seeds
from sim.optics.field.bake import bake_light
from sim.optics.field.model import model_of
from sim.optics.field.table import tabulate
from sim.optics.light.lights import place_leds
from sim.optics.proof.published_depth import published_depth_z
from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.gbuffer import MOVED_MM, open_view
from sim.optics.raster.raster import Raster
from sim.optics.raster.raster_kernels import SAME
from sim.optics.raster.skin_view import open_skin_view
from sim.optics.studio.metrics import contact_box, contact_pixels, mae_grey, psnr_dB, ssim
from sim.optics.studio.render import Studio
from workbench.core.base.errors import OpticsError
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Baking, LightModel
from workbench.core.design.optics import Optics, Transport
from workbench.core.result.results import MembraneMesh, Skin
from workbench.core.result.sensing import TactileFrames

DENT_MM = (15.0, 0.0, 22.0)
"""Place of the test dent, on the cylinder at +X."""
DENT_DEPTH_MM = 1.2
DENT_RADIUS_MM = 4.0
QUICK = Baking(photons=200_000, nodes=800)
"""Enough where only what moves is asked for, not how bright it is."""
FINER = 3
"""Rays of the finer image between two of the coarse one; odd, so that most lie between them."""
CLEAR_MM = 0.1
"""Change of depth that belongs to the contact box of the paper's depth map [mm]."""


def standard_dent(skin: Skin) -> np.ndarray:
    """Displacement of the test dent [mm], shape (V, 3)."""
    return dent(skin, at_mm=DENT_MM, depth_mm=DENT_DEPTH_MM, radius_mm=DENT_RADIUS_MM)


@dataclass(frozen=True, kw_only=True, slots=True)
class DrawingCheck:
    """Drawing against casting, over the pixels that changed."""

    median_mm: float
    rare_mm: float
    """99.9th percentile of the distance between the places seen [mm]."""
    disagree_1: float
    """Share of the changed pixels that see skin in one only [1]."""
    folded_1: float
    """Share of the image's pixels that are cast in each frame [1]."""
    changed: int


def drawing_error(
    mesh: MembraneMesh, camera: Camera, displacement_mm: np.ndarray, *, index: float = 1.41
) -> DrawingCheck:
    """What each changed pixel sees drawn and cast on the whole deformed skin."""
    view = open_skin_view(mesh, camera, index=index)
    raster = Raster(view)
    raster.look(displacement_mm[None])
    count = raster.pixels
    face, drawn_mm = raster.seen.triangle.to_numpy()[:count], raster.seen.away_mm.to_numpy()[:count]
    changed = np.flatnonzero(face != SAME)
    from geometry.surface.rays import RayCaster

    caster = RayCaster(mesh.seen.points_mm + displacement_mm, mesh.seen.faces)
    cast_mm = caster.hits(view.origin_mm[changed], view.direction[changed])[0]
    drawn = face[changed] >= 0
    both = drawn & np.isfinite(cast_mm)
    gap = np.abs(drawn_mm[changed] - cast_mm)[both]
    median, rare = np.percentile(gap, (50.0, 99.9))
    return DrawingCheck(
        median_mm=float(median),
        rare_mm=float(rare),
        disagree_1=float(np.mean(drawn != np.isfinite(cast_mm))),
        folded_1=float(view.folded.mean()),
        changed=len(changed),
    )


def newton_error_px(
    mesh: MembraneMesh, camera: Camera, *, index: float = 1.41
) -> tuple[float, float, float]:
    """Median and 99th percentile [px] of projecting what a finer image sees; and the null.

    A camera with three times the pixels casts exact rays; where they meet the skin is projected
    through the coarse ray map, which knows every ninth of them. Folded places are left out. The
    null is the median without refraction.
    """
    fine = dataclasses.replace(
        camera, width_px=FINER * camera.width_px, height_px=FINER * camera.height_px
    )
    exact, ray_map = open_map(mesh, fine, index=index), open_map(mesh, camera, index=index)
    pad = exact.pad_px
    columns, rows = np.meshgrid(np.arange(fine.width_px), np.arange(fine.height_px))
    rows, columns = rows.ravel()[::7], columns.ravel()[::7]
    points = exact.hit_mm[rows + pad, columns + pad].astype(np.float64)
    sharp = ~exact.folded.reshape(fine.height_px, fine.width_px)[rows, columns]
    passing = exact.rays.transmittance.reshape(fine.height_px, fine.width_px)[rows, columns] > 0.0
    coarse = ray_map.folded.reshape(camera.height_px, camera.width_px)
    sharp &= passing & ~coarse[rows // FINER, columns // FINER] & np.isfinite(points).all(axis=1)
    points = points[sharp]
    uv = np.column_stack([columns, rows])[sharp] / FINER + 0.5 / FINER
    found = project_points(ray_map, points, seeds(ray_map, points)).xy + 0.5 - ray_map.pad_px
    straight = open_map(mesh, camera, index=1.0)
    null = project_points(straight, points, seeds(straight, points)).xy + 0.5 - straight.pad_px
    median, high = np.percentile(np.linalg.norm(found - uv, axis=1), (50.0, 99.0))
    return float(median), float(high), float(np.median(np.linalg.norm(null - uv, axis=1)))


@dataclass(frozen=True, kw_only=True, slots=True)
class PublishedCheck:
    """The paper's depth map against the exact one at index 1, in the contact box."""

    median_mm: float
    rare_mm: float
    """99th percentile [mm]."""
    null_median_mm: float
    """Of the depth of the undeformed skin."""
    null_rare_mm: float
    missing_1: float
    """Share of the box's pixels where it has no depth."""
    slower_1: float
    """Its time for a frame over that of drawing one."""


def published_depth_error(mesh: MembraneMesh, camera: Camera) -> PublishedCheck:
    """The test dent seen by the paper's chain and cast exactly."""
    moved = standard_dent(mesh.seen)
    start = time.perf_counter()
    published = published_depth_z(mesh.seen, camera, moved)
    published_s = time.perf_counter() - start
    rest, pressed = (_cast_depth(mesh, camera, shift) for shift in (0.0 * moved, moved))
    box = contact_box(np.abs(pressed - rest) > CLEAR_MM)
    if box is None:
        raise OpticsError("the camera does not see the dent", hint="put it nearer to the tip")
    error, null = np.abs(published - pressed)[box], np.abs(rest - pressed)[box]
    known = np.isfinite(error)
    return PublishedCheck(
        median_mm=float(np.median(error[known])),
        rare_mm=float(np.percentile(error[known], 99.0)),
        null_median_mm=float(np.nanmedian(null)),
        null_rare_mm=float(np.nanpercentile(null, 99.0)),
        missing_1=float(1.0 - known.mean()),
        slower_1=published_s / _drawing_s(mesh, camera, moved),
    )


def _cast_depth(mesh: MembraneMesh, camera: Camera, displacement_mm: np.ndarray) -> np.ndarray:
    """Exact depth along the optical axis without refraction [mm], (H, W); NaN without skin."""
    rays = refracted_rays(camera, mesh.cavity, 1.0)
    skin = mesh.seen
    deformed = dataclasses.replace(skin, points_mm=skin.points_mm + displacement_mm)
    seen = open_view(deformed, camera, rays).background
    depth = np.full(camera.width_px * camera.height_px, np.nan)
    depth[seen.pixel] = seen.depth_z_mm
    return depth.reshape(camera.height_px, camera.width_px)


def _drawing_s(mesh: MembraneMesh, camera: Camera, displacement_mm: np.ndarray) -> float:
    """Time of drawing a frame [s], after one to warm up; waits for the device."""
    raster = Raster(open_skin_view(mesh, camera, index=1.0))
    times = []
    for _ in range(4):
        start = time.perf_counter()
        raster.look(displacement_mm[None])
        depth_z(
            camera, raster.view.origin_mm + raster.seen.away_mm.to_numpy()[: raster.pixels, None]
        )
        times.append(time.perf_counter() - start)
    return float(np.median(times[1:]))


def optics_of(model: LightModel) -> Optics:
    """The default sensor with a small image and a quick bake."""
    return Optics(light_model=model, baking=QUICK, camera=Camera(width_px=320, height_px=240))


def dented(model: LightModel, mesh: MembraneMesh) -> TactileFrames:
    """Background and one image of the default sensor with the standard dent, by any light model."""
    optics, moved = optics_of(model), standard_dent(mesh.seen)
    traced = optics.transport
    light = bake_light(mesh, optics.ring, model=model, transport=traced)
    if not model_of(model).per_frame:
        table = None
        if model_of(model).tabulated:
            table = tabulate(light, mesh, optics.all_cameras, traced, model=model)
        return Studio(mesh, light, optics, table=table).shoot(moved[None])
    flat, pressed = (_radiance(mesh, optics, traced, shift) for shift in (None, moved))
    studio = Studio(mesh, light, optics, radiance=flat)
    return studio.shoot(moved[None], radiance=pressed[None])


def _radiance(
    mesh: MembraneMesh, optics: Optics, traced: Transport, displacement_mm: np.ndarray | None
) -> np.ndarray:
    from sim.optics.transport.paths import Photons
    from sim.optics.transport.radiance import trace_radiance

    leds = place_leds(optics.ring)
    found = trace_radiance(
        mesh,
        leds,
        optics.camera,
        traced,
        Photons(count=traced.baking.photons, seed=traced.baking.seed),
        displacement_mm=displacement_mm,
    )
    return found.radiance * np.float32(len(leds.rgb) / found.photons)


def recast_error_mm(edge_mm: float = 0.5) -> float:
    """Largest depth difference [mm] between a frame and a full cast of the deformed skin.

    A frame draws only what moved; casting all of the deformed skin anew must see the same.
    """
    mesh, optics = finger(edge_mm=edge_mm), Optics(light_model=LightModel("linear"))
    moved = standard_dent(mesh.seen)
    light = bake_light(mesh, optics.ring, model=LightModel("linear"))
    frames = Studio(mesh, light, optics).shoot(moved[None])
    deformed = dataclasses.replace(mesh.outer, points_mm=mesh.outer.points_mm + moved)
    rays = refracted_rays(optics.camera, mesh.cavity, optics.refractive_index)
    seen = open_view(deformed, optics.camera, rays).background
    depth_z_mm = frames.depth_z_mm[1].ravel()[seen.pixel]
    return float(np.abs(depth_z_mm - seen.depth_z_mm).max())


def still_pixels(mesh: MembraneMesh, optics: Optics, displacement_mm: np.ndarray) -> np.ndarray:
    """Pixels that see an unmoved triangle, or none, before and after, shape (H, W), bool.

    By casting every ray on the skin at rest and on the deformed one.
    """
    skin, camera = mesh.seen, optics.camera
    rays = refracted_rays(camera, mesh.cavity, optics.refractive_index)
    moved = (np.linalg.norm(displacement_mm, axis=1) > MOVED_MM)[skin.faces].any(axis=1)
    still = np.ones(camera.width_px * camera.height_px, dtype=bool)
    for points in (skin.points_mm, skin.points_mm + displacement_mm):
        view = open_view(dataclasses.replace(skin, points_mm=points), camera, rays)
        still &= (view.face < 0) | ~moved[view.face]
    return still.reshape(camera.height_px, camera.width_px)


def still_difference_grey(frames: TactileFrames, still: np.ndarray) -> int:
    """Largest difference [grey level] from the background in still pixels; must be 0."""
    change = frames.rgb[1:].astype(np.int16) - frames.rgb[0]
    return int(np.abs(change[:, still]).max(initial=0))


def dent_scores(frames: TactileFrames) -> dict[str, float]:
    """Mean change [grey level], PSNR [dB] and SSIM [1] of the null in the contact box.

    Raises:
        OpticsError: If the camera does not see the dent.
    """
    box = contact_box(contact_pixels(frames, 1))
    if box is None:
        raise OpticsError("the camera does not see the dent", hint="put it nearer to the tip")
    image, null = frames.rgb[1][box], frames.rgb[0][box]
    return {
        "change_grey": mae_grey(image, null),
        "null_psnr_dB": psnr_dB(null, image),
        "null_ssim_1": ssim(null, image),
    }
