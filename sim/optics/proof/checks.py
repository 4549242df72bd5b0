"""Validation of the optics room: each function measures one thing and returns its number(s).

Projection, Snell, Fresnel, irradiance and depth are compared with closed forms, the fields with the
properties that define them. `plane_checks`, `view_checks`, `sensor_checks`, `map_checks`,
`transport_checks` and `baked_light_checks` have the rest.
"""

from __future__ import annotations

import numpy as np

from sim.optics.camera.camera import focal_px, pixel_centres, project, refracted_rays, unproject
from sim.optics.camera.refraction import refract
from sim.optics.field.bake import bake_light
from sim.optics.light.lights import place_leds
from sim.optics.proof.specimen import finger
from sim.optics.raster.gbuffer import open_view
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.result.results import MembraneMesh

ANGLES_DEG = np.linspace(0.0, 89.0, 90)
SILICONE_INDEX = 1.41
TURN = (0.9, 0.3, -0.3, 0.1)
"""Quaternion of the round trip's camera, before it is made a unit one."""
DISTORTIONS: dict[LensModel, tuple[tuple[float, ...], ...]] = {
    LensModel.OPENCV: ((), (-0.12, 0.01, 0.0012, -0.0008, 0.001)),
    LensModel.OPENCV_FISHEYE: ((), (0.05, -0.02, 0.004, -0.0005)),
}
"""None, and one of the size that small wide-angle lenses have; our choice."""


def round_trip_px(lens: LensModel) -> float:
    """Largest error [px] of pixel to point to pixel, over the image of a turned camera."""
    length = np.linalg.norm(TURN)
    w, x, y, z = (float(q / length) for q in TURN)
    worst = 0.0
    for distortion in DISTORTIONS.get(lens, ((),)):
        camera = Camera(
            lens=lens, distortion=distortion, position_mm=(1.0, -2.0, 3.0), wxyz=(w, x, y, z)
        )
        centres = pixel_centres(camera)
        range_mm = np.linspace(5.0, 50.0, len(centres))
        points = unproject(camera, centres, range_mm=range_mm)
        worst = max(worst, float(np.abs(project(camera, points) - centres).max()))
    return worst


def edge_angle_error_deg(lens: LensModel) -> float:
    """Error [degree] of the angle between the image's left and right edge, against fov_x_deg.

    Of a distorted lens without its tangential terms, which do not enter the field of view.
    """
    worst = 0.0
    for distortion in DISTORTIONS.get(lens, ((),)):
        if lens is LensModel.OPENCV and distortion:
            k1, k2, _, _, k3 = distortion
            distortion = (k1, k2, 0.0, 0.0, k3)
        camera = Camera(lens=lens, distortion=distortion)
        row = camera.height_px / 2.0
        edges = np.array([[0.0, row], [camera.width_px, row]])
        points = unproject(camera, edges, range_mm=np.ones(2))
        left, right = points - np.asarray(camera.position_mm)
        between = float(np.degrees(np.arccos(left @ right)))
        worst = max(worst, abs(between - camera.fov_x_deg))
    return worst


def snell_error() -> float:
    """Largest error [1] of n1 sin a = n2 sin b from 0 to 89 degrees, into and out of silicone."""
    worst = 0.0
    for index_from, index_to in ((1.0, SILICONE_INDEX), (SILICONE_INDEX, 1.0)):
        sine = np.sin(np.radians(ANGLES_DEG))
        passes = index_from * sine < index_to
        bent, _ = _at_angles(index_from, index_to)
        error = index_from * sine[passes] - index_to * bent[passes, 0]
        worst = max(worst, float(np.abs(error).max()))
    return worst


def fresnel_error() -> float:
    """Largest error [1] of the transmittance into silicone against `exact_transmittance`."""
    _, transmittance = _at_angles(1.0, SILICONE_INDEX)
    exact = exact_transmittance(np.radians(ANGLES_DEG), 1.0, SILICONE_INDEX)
    return float(np.abs(transmittance - exact).max())


def exact_transmittance(angle: np.ndarray, index_from: float, index_to: float) -> np.ndarray:
    """Share of unpolarised light that passes, by the trigonometric form of Fresnel, shape (N,).

    Rs = (sin(a - b) / sin(a + b))^2, Rp = (tan(a - b) / tan(a + b))^2; at normal incidence
    T = 4 n m / (n + m)^2, and beyond the critical angle 0.

    Args:
        angle: From the normal, shape (N,), in [0, pi / 2).
        index_from: Where the light comes from [1].
        index_to: Behind the surface [1].
    """
    found = np.full(len(angle), 4.0 * index_from * index_to / (index_from + index_to) ** 2)
    sine = np.sin(angle) * index_from / index_to
    found[sine >= 1.0] = 0.0
    slanted = (angle > 0.0) & (sine < 1.0)
    a, b = angle[slanted], np.arcsin(sine[slanted])
    reflect_s = (np.sin(a - b) / np.sin(a + b)) ** 2
    reflect_p = (np.tan(a - b) / np.tan(a + b)) ** 2
    found[slanted] = 1.0 - 0.5 * (reflect_s + reflect_p)
    return found


def _at_angles(index_from: float, index_to: float) -> tuple[np.ndarray, np.ndarray]:
    angle = np.radians(ANGLES_DEG)
    direction = np.column_stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)])
    normal = np.broadcast_to([0.0, 0.0, 1.0], direction.shape)
    return refract(direction, normal, index_from=index_from, index_to=index_to)


def tangency_error_deg(mesh: MembraneMesh, ring: LedRing) -> float:
    """Largest angle [degree] between the `plane_target` field and the skin's tangent plane."""
    light = bake_light(mesh, ring, model=LightModel("plane_target"))
    sine = np.einsum("lvi,vi->lv", light.direction, mesh.outer.normals)
    straight = bake_light(mesh, ring, model=LightModel("linear"))
    # Where the light falls along the normal there is no plane and the field is the straight line.
    fallback = (light.direction == straight.direction).all(axis=2)
    return float(np.degrees(np.arcsin(np.abs(sine[~fallback]).max())))


def irradiance_error(mesh: MembraneMesh, ring: LedRing) -> float:
    """Largest relative error of the `direct` field against (m + 1) / (2 pi) cos^m / r^2.

    Valid on convex skins, where no vertex is in shadow; points behind the LED receive nothing.
    """
    light = bake_light(mesh, ring, model=LightModel("direct"))
    leds, exponent = place_leds(ring), ring.emission_exponent
    line = mesh.outer.points_mm[None] - leds.position_mm[:, None]
    square = np.einsum("lvi,lvi->lv", line, line)
    cosine = np.einsum("lvi,li->lv", line, leds.axis) / np.sqrt(square)
    exact = (exponent + 1.0) / (2.0 * np.pi) * np.maximum(cosine, 0.0) ** exponent / square
    # Within half a degree of the LED's own plane the cosine is rounding.
    lit = cosine > 0.01
    return float((np.abs(light.irradiance[lit] / exact[lit] - 1.0)).max())


def depth_error_mm(mesh: MembraneMesh, *, radius_mm: float, cylinder_mm: float) -> float:
    """Largest error [mm] of depth_z against the closed form of cylinder and sphere, unrefracted.

    A ray o + t d meets the sphere at t^2 + 2 t (o - c).d + |o - c|^2 - R^2 = 0, and the cylinder
    likewise in x and y; the sphere counts above the cylinder's end.
    """
    camera = Camera(width_px=160, height_px=120)
    rays = refracted_rays(camera, mesh.cavity, 1.0)
    seen = open_view(mesh.outer, camera, rays).background
    direction = rays.direction[seen.pixel].astype(np.float64)
    origin = np.asarray(camera.position_mm)
    flat = np.array([1.0, 1.0, 0.0])
    along = _far_root(direction * flat, origin * flat, radius_mm)
    on_tip = origin[2] + along * direction[:, 2] > cylinder_mm
    tip = _far_root(direction, origin - [0.0, 0.0, cylinder_mm], radius_mm)
    exact = np.where(on_tip, tip, along) * direction[:, 2]
    return float(np.abs(seen.depth_z_mm - exact).max())


def _far_root(direction: np.ndarray, offset: np.ndarray, radius_mm: float) -> np.ndarray:
    square = np.einsum("ij,ij->i", direction, direction)
    middle = direction @ offset / square
    # Rays from below may miss the whole sphere; the caller takes the cylinder for those.
    return -middle + np.sqrt(np.maximum(middle**2 - (offset @ offset - radius_mm**2) / square, 0.0))


def axis_error_px() -> float:
    """Distance [px] of the centre pixel's bent ray from the optical axis on a centred finger."""
    camera = Camera(width_px=161, height_px=121)
    rays = refracted_rays(camera, finger(edge_mm=0.5).cavity, SILICONE_INDEX)
    middle = rays.direction[(camera.height_px // 2) * camera.width_px + camera.width_px // 2]
    return float(np.hypot(middle[0], middle[1]) / middle[2] * focal_px(camera))
