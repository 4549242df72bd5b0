"""Designer maps against closed forms."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from geometry.surface.surface import vertex_areas_mm2
from sim.optics.camera.camera import project, refracted_rays
from sim.optics.field.bake import bake_light
from sim.optics.maps import lighting, pixel_glare, seeing, signal
from sim.optics.maps.judging import weighted_percentiles
from sim.optics.maps.measure import designer_maps
from sim.optics.proof.specimen import finger
from sim.optics.studio.render import Studio
from workbench.core.design.camera import Camera, ImageSensor
from workbench.core.design.lighting import Baking, LightModel
from workbench.core.design.optics import Optics
from workbench.core.press.press_case import PressCase
from workbench.core.result.light import LightField
from workbench.core.result.results import Skin
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design


def plane(height_mm: float, half_mm: float = 10.0, count: int = 41) -> Skin:
    """A level square of triangles, normals up."""
    line = np.linspace(-half_mm, half_mm, count)
    x, y = np.meshgrid(line, line, indexing="xy")
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height_mm)])
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + count + 1]),
            np.column_stack([corner, corner + count + 1, corner + count]),
        ]
    ).astype(np.int32)
    return Skin(points_mm=points, faces=faces, normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)))


def field(direction: np.ndarray, rgb: np.ndarray, **changes: np.ndarray) -> LightField:
    """Lights of irradiance 1 from directions (L, 3) on one vertex."""
    count = len(direction)
    light = LightField(
        model="direct",
        direction=direction[:, None].astype(np.float32),
        irradiance=np.ones((count, 1), dtype=np.float32),
        led_mm=10.0 * direction,
        led_axis=-direction,
        led_rgb=rgb,
        led_exponent=np.ones(count),
        led_cone=np.zeros(count),
        led_size_mm=np.ones(count),
    )
    return dataclasses.replace(light, **changes)


def test_skin_per_pixel_of_a_level_plane_is_its_distance_over_the_focal_length() -> None:
    """A plane across the axis of a pinhole at distance z has z / f millimetres per pixel."""
    camera = Camera(width_px=200, height_px=160, fov_x_deg=90.0, position_mm=(0.0, 0.0, 0.0))
    skin = plane(20.0)
    uv = project(camera, skin.points_mm)
    found = seeing.mm_per_pixel(skin.points_mm, skin.faces, uv, np.ones(len(uv), dtype=bool))
    assert found == pytest.approx(np.full(len(uv), 20.0 / 100.0), rel=1e-5)


def test_skin_that_nobody_sees_has_no_pixels() -> None:
    """A vertex all of whose triangles have an unseen corner has no value."""
    skin = plane(20.0)
    uv = skin.points_mm[:, :2] * 5.0
    visible = skin.points_mm[:, 0] < 0.0
    found = seeing.mm_per_pixel(skin.points_mm, skin.faces, uv, visible)
    assert np.isnan(found[skin.points_mm[:, 0] > 1.0]).all()


def test_vertex_areas_sum_to_the_area() -> None:
    """20 mm by 20 mm are 400 mm2."""
    skin = plane(0.0)
    assert vertex_areas_mm2(skin.points_mm, skin.faces).sum() == pytest.approx(400.0)


def test_colours_at_right_angles_are_fully_separable() -> None:
    """Three colours along x, y and z have |det| = 1; from one direction 0."""
    assert lighting.separability(field(np.eye(3), np.eye(3)))[0] == pytest.approx(1.0)
    same = np.tile([0.0, 0.6, 0.8], (3, 1))
    assert lighting.separability(field(same, np.eye(3)))[0] == pytest.approx(0.0, abs=1e-6)


def test_white_lights_are_not_separable() -> None:
    """Lights of one colour have equal light vectors in all channels: |det| = 0."""
    assert lighting.separability(field(np.eye(3), np.ones((3, 3))))[0] == pytest.approx(0, abs=1e-6)


def test_light_of_an_led_has_its_cosine() -> None:
    """At 60 degrees half of the perpendicular irradiance arrives; from behind none."""
    slanted = np.array([[np.sqrt(0.75), 0.0, 0.5], [0.0, 0.0, -1.0]])
    light = field(slanted, np.eye(3)[:2])
    inward = np.array([[0.0, 0.0, 1.0]])
    assert lighting.light_of_each(light, inward)[:, 0] == pytest.approx([0.5, 0.0])


def test_resolvability_is_the_smallest_singular_value_over_noise() -> None:
    """Equal to NumPy's SVD of J with rows divided by their noise."""
    rng = np.random.default_rng(1)
    jacobian = rng.normal(size=(50, 3, 2)).astype(np.float32)
    noise = rng.uniform(0.5, 2.0, size=(50, 3))
    exact = np.linalg.svd(jacobian / noise[:, :, None], compute_uv=False)[:, -1]
    # The closed form subtracts two nearly equal numbers in single precision.
    assert signal.resolvability(jacobian, noise) == pytest.approx(exact, abs=2e-3)


def test_tilt_of_a_matte_skin_under_one_light_is_the_derivative_of_its_cosine() -> None:
    """Display light 0.5 N . L with L 45 degrees off: dI / d tilt toward L = 0.5 sin 45 per rad."""
    inward = np.array([[0.0, 0.0, 1.0]])
    toward = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])

    def shade(normals: np.ndarray) -> np.ndarray:
        return np.repeat(0.5 * (normals @ toward)[:, None], 3, axis=1)

    jacobian = signal.tilt_jacobian(shade, inward, ImageSensor(gamma=1.0))
    size = np.linalg.norm(jacobian[0, 0])
    exact = 255.0 * 0.5 * np.sqrt(0.5) * np.pi / 180.0
    # Central differences over 2 degrees: sin(2 deg) / 2 deg is 2e-4 off.
    assert size == pytest.approx(exact, rel=1e-3)


def test_noise_follows_the_photon_transfer_curve() -> None:
    """Linear sensor at half of a full well of 10,000 e-: sqrt(5000 + 9) / 10000 * 255 grey."""
    sensor = ImageSensor(noise=True, gamma=1.0)
    found = signal.noise_grey(np.full((1, 3), 0.5), sensor)
    shot = 255.0 * np.sqrt(5009.0) / 10000.0
    assert found[0] == pytest.approx(np.full(3, np.hypot(shot, np.sqrt(1 / 12))), rel=1e-6)


def test_without_noise_only_rounding_is_left() -> None:
    """Whole grey levels are off by 1 / sqrt(12) on average."""
    found = signal.noise_grey(np.full((1, 3), 0.5), ImageSensor())
    assert found[0] == pytest.approx(np.full(3, 0.288675), rel=1e-5)


def test_depth_at_a_force_inverts_dimitriadis() -> None:
    """The depth found puts the force back; on a very thick layer it is Hertz's."""
    thickness = np.array([2.0, 1e6])
    depth = signal.depth_at_force_mm(0.1, 0.145, thickness)
    chi = np.sqrt(3.0 * depth) / thickness
    series = 1 + 1.133 * chi + 1.283 * chi**2 + 0.769 * chi**3 + 0.0975 * chi**4
    force = 16 / 9 * 0.145 * np.sqrt(3.0) * depth**1.5 * series
    assert force == pytest.approx([0.1, 0.1], rel=1e-5)
    assert depth[1] == pytest.approx((0.1 * 9 / 16 / 0.145 / np.sqrt(3.0)) ** (2 / 3), rel=1e-4)


def test_camera_looks_an_led_in_the_face() -> None:
    """A disc of 1 mm2 with unit power and a Lambertian lobe has the radiance 1 / pi on its axis."""
    up = np.array([[0.0, 0.0, 1.0]])
    size = np.array([np.sqrt(4.0 / np.pi)])
    light = field(up, np.eye(3)[:1], led_size_mm=size)
    eye = np.zeros((2, 3))
    aside = np.array([0.2, 0.0, 1.0]) / np.sqrt(1.04)
    found = pixel_glare.led_radiance(eye, np.vstack([up, aside]), light, np.full(2, np.inf))
    assert found[:, 0] == pytest.approx([1.0 / np.pi, 0.0])


def test_an_led_beside_the_camera_is_mirrored_by_the_wall_above() -> None:
    """LED 4 mm aside, flat wall at 10 mm: its image is seen where the wall is hit 2 mm aside."""
    camera = Camera(width_px=80, height_px=80, fov_x_deg=60.0, position_mm=(0.0, 0.0, 0.0))
    wall = plane(10.0)
    light = field(np.array([[0.4, 0.0, 0.0]]), np.eye(3)[:1])
    light = dataclasses.replace(
        light, led_mm=np.array([[4.0, 0.0, 0.0]]), led_axis=np.array([[0.0, 0.0, 1.0]])
    )
    rays = refracted_rays(camera, wall, 1.5)
    found = pixel_glare.glare_radiance(camera, rays, wall, light, 1.5)[:, 0].reshape(80, 80)
    row, column = np.unravel_index(int(found.argmax()), found.shape)
    focal = 40.0 / np.tan(np.radians(30.0))
    assert abs(column + 0.5 - (40.0 + focal * 0.2)) < 4.0
    assert abs(row + 0.5 - 40.0) < 4.0
    # Fresnel's reflectance of glass near normal incidence is 4 %, on a disc of radiance 4 / pi^2.
    assert found.max() == pytest.approx(0.04 * 4.0 / np.pi**2, rel=0.02)


@pytest.mark.parametrize("brighter", [1.0, 2.0, 40.0])
def test_skin_is_overexposed_where_its_pixel_is_at_the_ceiling(
    brighter: float, taichi_device: str
) -> None:
    """As many vertices as have a pixel with a colour of 255 in the image at rest, of the exposure
    that suits the design and of longer ones; the figure is their share of the seen skin."""
    mesh, optics = finger(), Optics(light_model=LightModel("direct"))
    light = bake_light(mesh, optics.ring, model=optics.light_model)
    usual = float(Studio(mesh, light, optics).imager.backdrop.exposure[0])
    camera = dataclasses.replace(optics.camera, sensor=ImageSensor(exposure=brighter * usual))
    optics = dataclasses.replace(optics, camera=camera)
    found = designer_maps(mesh, light, optics, young_MPa=0.1).named("overexposed")

    studio = Studio(mesh, light, optics)
    column, row = np.nan_to_num(studio.vertex_pixels[:, :2]).astype(int).T
    image = studio.images(np.zeros((1, *mesh.seen.points_mm.shape), np.float32))[0]
    white = (image[row % len(image), column % image.shape[1]] == 255).any(axis=1)
    seen = studio.visible
    assert np.isnan(found.values[~seen]).all()
    # Of the brightest colour 254.5 and more rounds to the ceiling.
    assert np.mean(white[seen] != (found.values[seen] > 0)) < 0.02
    areas = vertex_areas_mm2(mesh.seen.points_mm, mesh.seen.faces)[seen]
    share = 100.0 * float(areas[white[seen]].sum() / areas.sum())
    assert found.score == pytest.approx(share, abs=2.0)
    assert (found.score > 30.0) == (brighter == 40.0)


def test_percentiles_are_weighted_by_area() -> None:
    """Nine tenths of the area at 1, a tenth at 2: the median is 1, the 95th percentile near 2."""
    marks = weighted_percentiles(np.array([1.0, 2.0]), np.array([9.0, 1.0]))
    assert marks[0] == 1.0 and marks[-1] == 2.0
    assert 1.0 <= marks[3] < 1.2 and marks[5] == pytest.approx(2.0)


def test_maps_ask_for_the_table_that_a_plan_makes() -> None:
    """However the light is baked: images and maps take the one table of a plan."""
    for photons in (Baking().photons, 100_000):
        design = load_design("pad").replace("optics.baking.photons", photons)
        calls = plan(design, PressCase())
        assert calls["maps"].inputs.table.key == calls["table"].key
