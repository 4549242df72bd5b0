"""Shading on the device against the plain twins, for every light model."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from geometry.surface.rays import RayCaster
from sim.optics.field.model import model_of
from sim.optics.field.table import look_up
from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.gbuffer import look, open_view
from sim.optics.raster.shading import hidden_share, relight, shade, take
from sim.optics.studio.render import Studio
from tests.synthetic_light import SHADED, lit
from workbench.core.base.errors import OpticsError
from workbench.core.design.camera import Camera, ImageSensor
from workbench.core.design.lighting import Ambient, LedMount, LedRing, LightModel
from workbench.core.design.optics import Coating, Optics
from workbench.core.design.photo import photo
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.results import MembraneMesh

pytestmark = pytest.mark.usefixtures("taichi_device")

SMALL = Camera(width_px=160, height_px=120)
LOW = LedRing(count=3, radius_mm=12.5, mount=LedMount.SHELL, cone_deg=150.0)
"""LEDs in the shell light the skin at a graze, so that dents cast shadows."""


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.8)


def studio_of(
    mesh: MembraneMesh, model: LightModel, ring: LedRing
) -> tuple[Studio, LightField, NormalTable | None]:
    light, table = lit(mesh, model, ring)
    optics = Optics(camera=SMALL, light_model=model, ring=ring)
    return Studio(mesh, light, optics, table=table), light, table


def twin(
    mesh: MembraneMesh,
    studio: Studio,
    light: LightField,
    table: NormalTable | None,
    moved: np.ndarray,
    to_camera: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices near what moved and their radiance by NumPy."""
    seen = look(open_view(mesh.seen, SMALL, studio.rays), moved)
    rows = seen.vertices
    model = LightModel(light.model)
    here = take(light, rows)
    normals = seen.normals[rows]
    total = np.zeros((len(rows), 3))
    if model is not LightModel.TABLE:
        if not model_of(model).paper:
            still = mesh.seen.points_mm[rows]
            finest = studio.imager.shader.lit.finest_shadow
            points = seen.points_mm[rows]
            here = relight(here, still, points, normals, patch=seen.patch, finest=finest)
        total += shade(model, here, Optics().coating, -normals, to_camera[rows])
    if model_of(model).tabulated and table is not None and light.scattered is not None:
        known = light.scattered
        total += look_up(
            table.values[0], known.nodes[rows], known.weights[rows], known.frame, -normals
        )
    return rows, total


@pytest.mark.parametrize("ring", [LedRing(), LOW], ids=["cavity", "shell"])
@pytest.mark.parametrize("model", SHADED)
def test_kernel_and_twin_agree(mesh: MembraneMesh, model: LightModel, ring: LedRing) -> None:
    """Radiance of every moved vertex, shadows included, to single precision."""
    studio, light, table = studio_of(mesh, model, ring)
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 20.0), depth_mm=2.0, radius_mm=4.0)
    got = studio.radiance_at_vertices(moved)
    to_camera = studio.imager.raster.posed.to_camera.to_numpy()
    rows, exact = twin(mesh, studio, light, table, moved, to_camera)
    assert len(rows) > 300
    error = np.abs(got[rows] - exact).max(axis=1) / exact.max()
    # A shadow ray that passes along an edge may fall to either side.
    assert np.mean(error > 1e-4) < 0.01
    assert np.median(error) < 1e-5
    untouched = np.setdiff1d(np.arange(len(got)), rows)
    assert np.array_equal(got[untouched], studio.imager.backdrop.undeformed[untouched])


def test_dents_cast_shadows_in_this_comparison(mesh: MembraneMesh) -> None:
    """With light at a graze the twin's radiance without the patch is larger somewhere."""
    studio, light, _ = studio_of(mesh, LightModel.DIRECT, LOW)
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 20.0), depth_mm=2.0, radius_mm=4.0)
    seen = look(open_view(mesh.seen, SMALL, studio.rays), moved)
    rows = seen.vertices
    still, here = mesh.seen.points_mm[rows], take(light, rows)
    points, normals = seen.points_mm[rows], seen.normals[rows]
    dark = relight(here, still, points, normals, patch=seen.patch).irradiance
    bright = relight(here, still, points, normals, patch=None).irradiance
    assert (dark < 0.5 * bright).sum() > 20


def test_skin_that_faces_away_from_a_light_receives_none(mesh: MembraneMesh) -> None:
    """Unmoved skin keeps its light to the last digits; turned inside out it has none."""
    light, _ = lit(mesh, LightModel.DIRECT, LedRing())
    still, normals = mesh.seen.points_mm, mesh.seen.normals
    same = relight(light, still, still, normals, patch=None).irradiance
    faces = np.einsum("lvi,vi->lv", light.direction, normals) < -1e-3
    assert faces.mean() > 0.5
    np.testing.assert_allclose(same[faces], light.irradiance[faces], rtol=1e-4)
    assert not relight(light, still, still, -normals, patch=None).irradiance[faces].any()


def test_tilting_normals_to_themselves_changes_nothing(mesh: MembraneMesh) -> None:
    """`shade_tilted` of the skin's own normals is the undeformed foreground, bit by bit."""
    studio, _, _ = studio_of(mesh, LightModel.HYBRID, LedRing())
    same = studio.shade_tilted(mesh.outer.normals)
    assert np.array_equal(same, studio.imager.backdrop.undeformed)
    turned = mesh.outer.normals + np.array([0.2, 0.0, 0.0])
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    assert np.abs(studio.shade_tilted(turned) - same).max() > 0.01 * same.max()


def test_given_radiance_is_what_images_show(mesh: MembraneMesh) -> None:
    """The model photons takes radiance from outside: twice the light in the dent, nowhere else."""
    light, _ = lit(mesh, LightModel.PHOTONS)
    flat = np.tile(np.array([1.0, 0.5, 0.25], dtype=np.float32), (len(mesh.outer.points_mm), 1))
    optics = Optics(camera=SMALL, light_model=LightModel.PHOTONS)
    studio = Studio(mesh, light, optics, radiance=flat)
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 22.0), depth_mm=1.2, radius_mm=4.0)[None]
    before = studio.linear(0.0 * moved, radiance=flat[None])[0]
    after = studio.linear(moved, radiance=2.0 * flat[None])[0]
    changed = np.abs(after - before).max(axis=2) > 0.0
    assert 0.01 < changed.mean() < 0.5
    # Interpolation of equal values sums weights that add up to 1 in single precision.
    assert after[changed] == pytest.approx(2.0 * before[changed], rel=1e-5)
    with pytest.raises(OpticsError, match="radiance of every frame"):
        studio.images(moved)


def test_a_table_model_without_a_table_is_an_error(mesh: MembraneMesh) -> None:
    """The message names the model."""
    light, _ = lit(mesh, LightModel.HYBRID)
    with pytest.raises(OpticsError, match="hybrid looks radiance up"):
        Studio(mesh, light, Optics(camera=SMALL))


def test_an_exposure_too_small_says_so_instead_of_black(mesh: MembraneMesh) -> None:
    """Exposure 1e-6 would leave every grey level 0."""
    light, _ = lit(mesh, LightModel.LINEAR)
    camera = dataclasses.replace(SMALL, sensor=ImageSensor(exposure=1e-6))
    with pytest.raises(OpticsError, match="leaves the whole image black") as caught:
        Studio(mesh, light, Optics(camera=camera))
    assert caught.value.at == "optics.camera.sensor.exposure"


def test_noise_and_fall_off_pass_through_the_image_sensor(mesh: MembraneMesh) -> None:
    """With noise a flat frame differs from the background; with fall-off corners are darker."""
    light, _ = lit(mesh, LightModel.LINEAR)
    flat = np.zeros((1, len(mesh.outer.points_mm), 3), dtype=np.float32)
    plain = Studio(mesh, light, Optics(camera=SMALL)).shoot(flat)
    noisy = dataclasses.replace(SMALL, sensor=ImageSensor(noise=True))
    frames = Studio(mesh, light, Optics(camera=noisy)).shoot(flat)
    assert not np.array_equal(frames.rgb[0], frames.rgb[1])
    assert not frames.moved.any()
    dim = dataclasses.replace(SMALL, sensor=ImageSensor(vignetting=1.0))
    corner = Studio(mesh, light, Optics(camera=dim)).shoot(flat).rgb[1][0, 0].astype(int)
    assert (corner < plain.rgb[1][0, 0]).all()


def test_a_photograph_is_the_background_where_nothing_moved(mesh: MembraneMesh) -> None:
    """Frame 0 is the file, pixel by pixel; a dent adds the difference of the two foregrounds."""
    import cv2

    light, _ = lit(mesh, LightModel.DIRECT)
    picture = np.random.default_rng(3).integers(60, 180, (120, 160, 3), dtype=np.uint8)
    done, data = cv2.imencode(".png", picture[..., ::-1])
    file = photo("idle.png", data.tobytes(), at="optics.background")
    plain = Optics(camera=SMALL, light_model=LightModel.DIRECT)
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 22.0), depth_mm=1.2, radius_mm=4.0)[None]
    rendered = Studio(mesh, light, plain)
    studio = Studio(mesh, light, dataclasses.replace(plain, background=file))
    frames = studio.shoot(moved)
    assert done and np.array_equal(frames.rgb[0], picture)
    still = ~frames.moved[1]
    assert np.array_equal(frames.rgb[1][still], picture[still]) and 0.5 < still.mean() < 0.99
    flat = 0.0 * moved
    exact = rendered.linear(moved) - rendered.linear(flat) + studio.linear(flat)
    # Sums in another order, relative to a photograph's own light.
    assert studio.linear(moved) == pytest.approx(
        np.maximum(exact, 0.0), abs=1e-5 * float(exact.max())
    )


def test_ambient_light_adds_the_same_everywhere(mesh: MembraneMesh) -> None:
    """Power over area times albedo over pi, in the dent and beside it, of every physical model."""
    power, albedo = 0.3, 0.5
    coating = Coating(albedo=albedo, specular=0.0)
    a, b, c = (mesh.outer.points_mm[mesh.outer.faces[:, k]] for k in range(3))
    area_mm2 = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 20.0), depth_mm=2.0, radius_mm=4.0)
    for model in (LightModel.DIRECT, LightModel.HYBRID):
        light, table = lit(mesh, model, LedRing())
        found = []
        for glow in (Ambient(), Ambient(power=power, colour="#ff0080")):
            optics = Optics(camera=SMALL, light_model=model, coating=coating, ambient=glow)
            studio = Studio(mesh, light, optics, table=table)
            found.append(studio.radiance_at_vertices(moved))
        # Linear light of #ff0080: its blue is 128 of 255.
        exact = power / area_mm2 * albedo / np.pi * np.array([1.0, 0.0, 128 / 255])
        assert found[1] - found[0] == pytest.approx(
            np.broadcast_to(exact, found[0].shape), abs=2e-6 * float(found[0].max())
        )


def test_the_edge_of_a_shadow_is_as_wide_as_its_light() -> None:
    """Behind a half plane the hidden share of a disc rises as its lens does, in eighths.

    A plane's edge 4 mm away and a disc of radius 2 mm 8 mm away: the penumbra is 2 mm wide.
    """
    edge = np.array([[0.0, -50.0, 4.0], [0.0, 50.0, 4.0], [50.0, 50.0, 4.0], [50.0, -50.0, 4.0]])
    patch = RayCaster(edge, np.array([[0, 1, 2], [0, 2, 3]]))
    x = np.linspace(-1.5, 1.5, 61)
    start = np.column_stack([x, 0.01 * x, np.zeros_like(x)])
    line = np.tile([0.0, 0.0, 8.0], (len(x), 1))
    got = hidden_share(patch, start, line, np.full(len(x), 2.0))
    # The edge seen from x crosses the disc's plane at -2 x from its middle, in radii -x.
    across = np.clip(-x, -1.0, 1.0)
    exact = (np.arccos(across) - across * np.sqrt(1.0 - across**2)) / np.pi
    assert np.abs(got - exact).max() <= 0.16, "a point of eight is an eighth"
    assert np.abs(got - exact).mean() < 0.05
    assert got[0] == 0.0 and got[-1] == 1.0
