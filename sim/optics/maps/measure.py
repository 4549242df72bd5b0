"""All maps of a design from its baked light and its cameras, in seconds.

With several cameras a vertex counts as seen when any camera sees it; millimetres per pixel,
incidence and everything about grey levels are those of the camera that has the most pixels there.
Of models without a physical scale (the paper's fields) the maps of illumination and glare are left
out; so is the sensitivity to a force of skins with a gap behind them, whose stiffness depends on
where it ends.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.camera import refracted_rays
from sim.optics.image_sensor import vignette
from sim.optics.maps import glare, lighting, seeing, signal
from sim.optics.maps.judging import Draft, judged
from sim.optics.render import Studio
from workbench.core.camera import Camera
from workbench.core.light import LightField, NormalTable
from workbench.core.lighting import PAPER, LightModel
from workbench.core.maps import DesignerMaps
from workbench.core.monitor import Monitor, part, silent
from workbench.core.optics import Optics
from workbench.core.results import MembraneMesh, Skin


@dataclass(frozen=True, kw_only=True, slots=True)
class _Look:
    """What one camera tells of each vertex; NaN where it does not see it."""

    visible: np.ndarray
    mm_per_pixel: np.ndarray
    incidence_deg: np.ndarray
    jacobian: np.ndarray
    noise: np.ndarray
    glare: np.ndarray


def designer_maps(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    table: NormalTable | None = None,
    *,
    young_MPa: float,
    monitor: Monitor = silent,
) -> DesignerMaps:
    """Every map of a design.

    Args:
        mesh: The skins.
        light: Baked light; any model but `photons`.
        optics: Cameras and coating.
        table: Of the models that have one.
        young_MPa: Of the elastomer, for the sensitivity to a force.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If a camera is outside the cavity or sees nothing of the skin.
        OpticsError: If no light reaches what a camera sees.
    """
    cameras = optics.all_cameras
    looks = []
    for number, camera in enumerate(cameras):
        monitor(0.8 * number / len(cameras), f"maps of camera {number + 1} of {len(cameras)}")
        span = part(monitor, 0.8 * number / len(cameras), 0.8 * (number + 1) / len(cameras))
        looks.append(_look(mesh, light, optics, table, camera, span))
    monitor(0.8, "maps")
    best = _best(looks)
    maps = [*_seen(best), *_lit(mesh, light), *_felt(mesh, best, young_MPa)]
    if LightModel(light.model) not in PAPER:
        maps.append(_washed_out(best))
    areas = seeing.vertex_areas_mm2(mesh.seen.points_mm, mesh.seen.faces)
    found = tuple(judged(draft, areas) for draft in maps)
    monitor(1.0, "maps ready")
    return DesignerMaps(maps=found)


def _look(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    table: NormalTable | None,
    camera: Camera,
    monitor: Monitor,
) -> _Look:
    studio = Studio(
        mesh, light, optics, table=table, camera=camera, monitor=part(monitor, 0.0, 0.6)
    )
    skin, visible, sensor = mesh.seen, studio.visible, camera.sensor
    inward = -skin.normals
    uv = studio.vertex_pixels[:, :2]

    shown = display_light(studio, camera)
    return _Look(
        visible=visible,
        mm_per_pixel=seeing.mm_per_pixel(skin.points_mm, skin.faces, uv, visible),
        incidence_deg=seeing.incidence_deg(inward, studio.to_camera, visible),
        jacobian=signal.tilt_jacobian(shown, inward, sensor),
        noise=signal.noise_grey(shown(inward), sensor),
        glare=_glare(mesh, light, optics, studio, camera),
    )


def display_light(studio: Studio, camera: Camera) -> Callable[[np.ndarray], np.ndarray]:
    """Display light (V, 3) of the undeformed skin at its pixels, by its inward normals (V, 3).

    Wall and lens dim it; of vertices outside the image it is not dimmed.
    """
    pixel, seen = _pixels(studio, camera, camera)
    share = studio.rays.transmittance[pixel] * vignette(camera).reshape(-1)[pixel]
    dimmed = studio.exposure * np.where(seen, share, 1.0)[:, None]
    return lambda inward: dimmed * studio.shade_tilted(-inward)


def _pixels(studio: Studio, camera: Camera, image: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Pixel of each vertex in an image of the same camera, and whether it has one, (V,) each."""
    uv = studio.vertex_pixels[:, :2]
    place = np.nan_to_num(uv * (image.width_px / camera.width_px)).astype(int)
    column = np.clip(place[:, 0], 0, image.width_px - 1)
    row = np.clip(place[:, 1], 0, image.height_px - 1)
    return row * image.width_px + column, np.isfinite(uv.sum(axis=1))


def _glare(
    mesh: MembraneMesh, light: LightField, optics: Optics, studio: Studio, camera: Camera
) -> np.ndarray:
    """Glare over the skin's radiance at each vertex, shape (V,), as the nearest pixel sees it."""
    small = glare.small(camera)
    rays = refracted_rays(small, mesh.cavity, optics.refractive_index)
    shining = glare.glare_radiance(small, rays, mesh.cavity, light, optics.refractive_index)
    pixel, in_image = _pixels(studio, camera, small)
    found = shining.mean(axis=1)[pixel]
    # Both as they arrive in the air of the cavity: T / n^2 of the radiance in the solid.
    leaving = rays.transmittance[pixel] / optics.refractive_index**2
    skin = leaving * studio.shade_tilted(mesh.seen.normals).mean(axis=1)
    ratio = found / np.maximum(skin, 1e-12)
    return np.where(studio.visible & in_image, ratio, np.nan).astype(np.float32)


def _best(looks: Sequence[_Look]) -> _Look:
    """At each vertex the camera with the most pixels there."""
    if len(looks) == 1:
        return looks[0]
    # A vertex that one camera sees without a whole triangle still belongs to that camera.
    sizes = np.stack(
        [
            np.where(look.visible, np.nan_to_num(look.mm_per_pixel, nan=1e9), np.inf)
            for look in looks
        ]
    )
    chosen = np.argmin(sizes, axis=0)
    every = np.arange(len(chosen))

    def taken(name: str) -> np.ndarray:
        return np.stack([getattr(look, name) for look in looks])[chosen, every]

    return _Look(
        visible=np.any([look.visible for look in looks], axis=0),
        mm_per_pixel=taken("mm_per_pixel"),
        incidence_deg=taken("incidence_deg"),
        jacobian=taken("jacobian"),
        noise=taken("noise"),
        glare=taken("glare"),
    )


def _seen(best: _Look) -> list[Draft]:
    return [
        Draft(
            name="visible",
            label="Seen by a camera",
            unit="1",
            values=best.visible.astype(np.float32),
            score_name="skin_seen_percent",
            score="percent",
            better="more",
            meaning="1 where a camera sees the skin at rest; the rest is blind.",
        ),
        Draft(
            name="mm_per_pixel",
            label="Skin per pixel",
            unit="mm",
            values=best.mm_per_pixel,
            score_name="mm_per_pixel_median_mm",
            score="median",
            better="less",
            meaning="Length of skin that one pixel covers, foreshortening included.",
        ),
        Draft(
            name="incidence",
            label="Angle of view",
            unit="deg",
            values=best.incidence_deg,
            score_name="incidence_median_deg",
            score="median",
            better="less",
            meaning="Between the skin's normal and the refracted line of sight; 90 is edge-on.",
        ),
    ]


def _lit(mesh: MembraneMesh, light: LightField) -> list[Draft]:
    """Illumination by each LED and in all, and how distinct the colours' directions are."""
    inward = -mesh.seen.normals
    found = [
        Draft(
            name="separability",
            label="Separate colours",
            unit="1",
            values=lighting.separability(light),
            score_name="led_separability_median_1",
            score="median",
            better="more",
            meaning="1 where three colours come from directions at right angles, 0 where from one.",
        )
    ]
    if LightModel(light.model) in PAPER:
        return found
    total = lighting.light_in_all(light, inward).mean(axis=1)
    scale = max(float(np.percentile(total, 99)), 1e-30)
    found.append(
        Draft(
            name="illumination",
            label="Light in all",
            unit="1",
            values=(total / scale).astype(np.float32),
            score_name="light_evenness_p5_over_p95_1",
            score="evenness",
            better="more",
            meaning="Light on the skin, scattered light included, over its brightest percent.",
        )
    )
    each = lighting.light_of_each(light, inward)
    scale = max(float(np.percentile(each, 99.5)), 1e-30)
    return found + [
        Draft(
            name=f"led_{number:02d}",
            label=f"Light of LED {number}",
            unit="1",
            values=(row / scale).astype(np.float32),
            score_name=f"led_{number:02d}_reach_percent",
            score="reach",
            better="more",
            meaning="Unscattered light of this LED over the brightest of all; its score is the "
            "share of skin with a tenth of that or more.",
        )
        for number, row in enumerate(each, start=1)
    ]


def _felt(mesh: MembraneMesh, best: _Look, young_MPa: float) -> list[Draft]:
    """What tilts and dents change in the image."""
    unseen = ~best.visible
    resolved = np.where(unseen, np.nan, signal.resolvability(best.jacobian, best.noise))
    slope_deg = signal.dent_slope_deg(signal.DENT_MM)
    depth = np.where(unseen, np.nan, signal.sensitivity_grey(best.jacobian, slope_deg))
    found = [
        Draft(
            name="resolvability",
            label="Normal resolvability",
            unit="1/deg",
            values=resolved.astype(np.float32),
            score_name="normal_resolvability_median_per_deg",
            score="median",
            better="more",
            meaning="Standard deviations of pixel noise for one degree of tilt, in the direction "
            "that shows least.",
        ),
        Draft(
            name="sensitivity_depth",
            label="Sensitivity to depth",
            unit="grey/0.1 mm",
            values=depth.astype(np.float32),
            score_name="sensitivity_median_grey_per_0.1mm",
            score="median",
            better="more",
            meaning="Mean change under a ball of 6 mm pressed 0.1 mm deep.",
        ),
    ]
    if mesh.backing_mm or len(mesh.tips_mm):
        return found
    depth_mm = signal.depth_at_force_mm(signal.FORCE_N, young_MPa, wall_mm(mesh))
    force = signal.sensitivity_grey(best.jacobian, signal.dent_slope_deg(depth_mm))
    found.append(
        Draft(
            name="sensitivity_force",
            label="Sensitivity to force",
            unit="grey/0.1 N",
            values=np.where(unseen, np.nan, force).astype(np.float32),
            score_name="sensitivity_median_grey_per_0.1N",
            score="median",
            better="more",
            meaning="Mean change under a ball of 6 mm pressed with 0.1 N, on the wall's thickness.",
        )
    )
    return found


def _washed_out(best: _Look) -> Draft:
    return Draft(
        name="glare",
        label="Direct glare",
        unit="1",
        values=best.glare,
        score_name="glare_percent",
        score="share_over_1",
        better="less",
        meaning="LEDs and their mirror images in front of the skin, over the skin's radiance; the "
        "score is the share of seen skin that an LED outshines.",
    )


def wall_mm(mesh: MembraneMesh) -> np.ndarray:
    """Thickness of the elastomer below each outer vertex along its normal [mm], shape (V,).

    Where the inward normal misses the inner skin (at the rim) the nearest distance stands in.
    """
    from scipy.spatial import KDTree

    from geometry.rays import RayCaster

    skin: Skin = mesh.outer
    caster = RayCaster(mesh.inner.points_mm, mesh.inner.faces)
    distance = caster.hits(skin.points_mm, -skin.normals)[0]
    nearest = KDTree(mesh.inner.points_mm).query(skin.points_mm)[0]
    return np.where(distance < 3.0 * nearest, distance, nearest)
