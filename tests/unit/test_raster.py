"""Drawing what moved, against casting every ray; composition against its definition."""

import dataclasses

import numpy as np
import pytest

from sim.optics.camera.camera import depth_z, rotation_camera_to_sensor
from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.gbuffer import look, open_view
from sim.optics.raster.imager import Imager
from sim.optics.raster.raster import Raster
from sim.optics.raster.raster_kernels import SAME
from sim.optics.raster.skin_view import SkinView, open_skin_view
from sim.optics.studio.render import Studio
from sim.specimens import skins_only
from tests.synthetic_light import lit
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Markers, Optics
from workbench.core.result.results import MembraneMesh, Skin
from workbench.core.result.sensing import TactileFrames

pytestmark = pytest.mark.usefixtures("taichi_device")

SMALL = Camera(width_px=160, height_px=120)
TILTED = Camera(
    width_px=160,
    height_px=120,
    fov_x_deg=110.0,
    position_mm=(3.0, -2.0, 0.6),
    wxyz=(0.9938, 0.08, -0.06, 0.04),
)
FISHEYE = dataclasses.replace(SMALL, lens=LensModel.EQUIDISTANT, fov_x_deg=150.0)
MEDIAN_MM, RARE_MM = 1e-3, 0.02


def ridged(skin: Skin, height_mm: float) -> Skin:
    """A skin with a groove along one side: not convex, as a trunk's or a paw's is.

    Points move inward by height exp(-(angle / 0.35)^2) sin(pi z / 30) about azimuth 0.7 rad.
    """
    points = skin.points_mm.copy()
    angle = np.arctan2(points[:, 1], points[:, 0]) - 0.7
    groove = height_mm * np.exp(-((angle / 0.35) ** 2))
    groove *= np.sin(np.pi * np.clip(points[:, 2] / 30.0, 0.0, 1.0))
    radial = points * [1.0, 1.0, 0.0]
    radial /= np.maximum(np.linalg.norm(radial, axis=1, keepdims=True), 1e-9)
    points -= groove[:, None] * radial
    first, second, third = (points[skin.faces[:, corner]] for corner in range(3))
    area = np.cross(second - first, third - first)
    normals = np.zeros_like(points)
    for corner in range(3):
        np.add.at(normals, skin.faces[:, corner], area)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Skin(points_mm=points, faces=skin.faces, normals=normals)


def grooved() -> MembraneMesh:
    """A finger whose three skins have a groove 4 mm deep."""
    mesh = finger(edge_mm=0.8)
    outer, inner, cavity = (ridged(s, 4.0) for s in (mesh.outer, mesh.inner, mesh.cavity))
    return skins_only(outer=outer, inner=inner, cavity=cavity)


@pytest.fixture(scope="module")
def smooth() -> MembraneMesh:
    return finger(edge_mm=0.8)


DENTS = {
    "dent": ((15.0, 0.0, 22.0), 1.2, 4.0),
    "deep tip": ((0.0, 0.0, 42.0), 6.0, 5.0),
    "dent that hides skin": ((0.0, -15.0, 12.0), 11.0, 5.0),
    "skin pulled away": ((0.0, 15.0, 20.0), -6.0, 6.0),
    "dent in the groove": ((9.0, 8.0, 20.0), 1.0, 4.0),
    "dent at the edge of the image": ((0.0, 15.0, 9.0), 1.2, 4.0),
}


def drawn_and_cast(
    mesh: MembraneMesh, camera: Camera, name: str, index: float = 1.41
) -> tuple[np.ndarray, np.ndarray, np.ndarray, SkinView]:
    """Depths [mm] of the changed pixels drawn and cast, the pixels, and the view."""
    view = open_skin_view(mesh, camera, index=index)
    at_mm, depth_mm, radius_mm = DENTS[name]
    moved = dent(mesh.outer, at_mm=at_mm, depth_mm=depth_mm, radius_mm=radius_mm)
    raster = Raster(view)
    raster.look(moved[None])
    count = raster.pixels
    face, away = raster.seen.triangle.to_numpy()[:count], raster.seen.away_mm.to_numpy()[:count]
    changed = np.flatnonzero(face != SAME)
    drawn = np.full(count, np.nan)
    drawn[changed] = depth_z(camera, view.origin_mm + away[:, None] * view.direction)[changed]
    drawn[face < 0] = np.nan
    twin = look(open_view(mesh.outer, camera, view.rays), moved)
    cast = np.full(count, np.nan)
    cast[twin.seen.pixel] = twin.seen.depth_z_mm
    assert np.array_equal(changed, twin.pixels)
    return drawn[changed], cast[changed], changed, view


@pytest.mark.parametrize(("frame", "exact"), [(0, [10.0, 4.0, 6.0]), (1, [9.0, 13.0, 10.0])])
def test_corners_are_blended_by_the_weights_of_the_second_and_third(
    frame: int, exact: list[float]
) -> None:
    """At (1/4, 5/8): an eighth of the first corner, a quarter and five eighths of the others."""
    import taichi as ti
    import taichi.math as tm

    from sim.optics.light.kernel_types import IntegerRows, Vectors
    from sim.optics.raster.compose_kernels import blend

    @ti.kernel
    def blended(
        values: Vectors,  # pyright: ignore
        faces: IntegerRows,  # pyright: ignore
        first: ti.i32,  # pyright: ignore
        out: Vectors,  # pyright: ignore
    ):
        # Taichi reads these annotations, so they may not be put off to the future.
        for i in range(1):
            out[i] = blend(values, first, faces, 1, tm.vec2(0.25, 0.625))

    one = [[8, 0, 0], [0, 8, 0], [0, 0, 8], [80, 16, 8]]
    other = [[88, 24, 16], [8, 8, 16], [8, 16, 8], [16, 8, 8]]
    faces, found = np.array([[0, 1, 2], [3, 1, 2]], np.int32), np.zeros((1, 3), np.float32)
    blended(np.array([*one, *other], np.float32), faces, 4 * frame, found)
    np.testing.assert_array_equal(found[0], exact)


@pytest.mark.parametrize(
    ("camera", "name"),
    [
        *((camera, name) for camera in (SMALL, TILTED, FISHEYE) for name in list(DENTS)[:4]),
        (SMALL, "dent at the edge of the image"),
        (FISHEYE, "dent at the edge of the image"),
    ],
)
def test_drawing_equals_casting(smooth: MembraneMesh, camera: Camera, name: str) -> None:
    """The same pixels change, and their depth_z differs by rounding only."""
    drawn, cast, changed, _ = drawn_and_cast(smooth, camera, name)
    assert len(changed) > 100
    assert np.array_equal(np.isnan(drawn), np.isnan(cast))
    error = np.abs(drawn - cast)[np.isfinite(drawn)]
    assert np.median(error) <= MEDIAN_MM
    assert np.percentile(error, 99.9) <= RARE_MM


@pytest.mark.parametrize("name", ["dent", "dent in the groove", "dent that hides skin"])
def test_drawing_equals_casting_where_the_cavity_is_not_convex(name: str) -> None:
    """Some rays cross three walls, some pixels are folded; all see what casting sees."""
    drawn, cast, changed, view = drawn_and_cast(grooved(), TILTED, name)
    assert len(changed) > 100
    # A ray along the groove's flank can pass through the very edge of a triangle, and either miss.
    assert np.mean(np.isnan(drawn) != np.isnan(cast)) < 1e-3
    error = np.abs(drawn - cast)[np.isfinite(drawn) & np.isfinite(cast)]
    assert np.median(error) <= MEDIAN_MM
    assert np.percentile(error, 99.9) <= RARE_MM
    assert view.folded.any()


def test_changed_normals_are_those_of_the_caster(smooth: MembraneMesh) -> None:
    """Vertex normals of the deformed skin agree to single precision."""
    moved = dent(smooth.outer, at_mm=(15.0, 0.0, 22.0), depth_mm=1.2, radius_mm=4.0)
    view = open_skin_view(smooth, SMALL, index=1.41)
    raster = Raster(view)
    raster.look(moved[None])
    twin = look(open_view(smooth.outer, SMALL, view.rays), moved)
    assert np.array_equal(raster.vertex_list.to_numpy()[: raster.vertex_entries], twin.vertices)
    error = raster.posed.turned.to_numpy()[twin.vertices] - twin.normals[twin.vertices]
    # Areas of 0.3 mm2 come from differences of coordinates near 40 mm, rounded at 4e-6 mm.
    assert np.abs(error).max() < 1e-4


def test_a_deep_dent_hides_the_skin_behind_it(smooth: MembraneMesh) -> None:
    """Pixels whose own triangle did not move come nearer."""
    drawn, _, changed, view = drawn_and_cast(smooth, SMALL, "dent that hides skin", index=1.0)
    at_mm, depth_mm, radius_mm = DENTS["dent that hides skin"]
    moved = dent(smooth.outer, at_mm=at_mm, depth_mm=depth_mm, radius_mm=radius_mm)
    still = ~(np.linalg.norm(moved, axis=1) > 1e-3)[view.faces].any(axis=1)
    first = view.layer_start[changed]
    hidden = still[view.layer_face[first]]
    before = depth_z(SMALL, view.origin_mm + _first_mm(view)[:, None] * view.direction)[changed]
    assert hidden.sum() > 50
    assert (drawn[hidden] < before[hidden]).all()


def _first_mm(view: SkinView) -> np.ndarray:
    has = np.diff(view.layer_start) > 0
    distance = np.full(len(has), np.nan)
    distance[has] = view.layer_mm[view.layer_start[:-1][has]]
    return distance


def press(mesh: MembraneMesh, frames: int = 5) -> np.ndarray:
    """Dents of growing depth at growing azimuths, the third one flat [mm], (frames, V, 3)."""
    found = [
        dent(
            mesh.outer,
            at_mm=(15.0 * np.cos(0.5 * k), 15.0 * np.sin(0.5 * k), 20.0),
            depth_mm=0.0 if k == 2 else 0.4 + 0.3 * k,
            radius_mm=4.0,
        )
        for k in range(frames)
    ]
    return np.stack(found)


def studio_of(mesh: MembraneMesh, model: LightModel, **optics: object) -> Studio:
    light, table = lit(mesh, model)
    chosen = Optics(camera=SMALL, light_model=model, **optics)  # pyright: ignore[reportArgumentType]
    return Studio(mesh, light, chosen, table=table)


def shot(studio: Studio, frames: np.ndarray) -> TactileFrames:
    return studio.shoot(frames)


def test_images_alone_are_those_of_shoot(smooth: MembraneMesh) -> None:
    """`images` gives the same bytes as `shoot`, with markers; a flat frame is the background."""
    studio = studio_of(smooth, LightModel.HYBRID, markers=Markers(visible=True))
    frames = press(smooth)
    images, all_of_it = studio.images(frames), shot(studio, frames)
    assert np.array_equal(images, all_of_it.rgb[1:])
    assert np.array_equal(images[2], all_of_it.rgb[0])
    assert not np.array_equal(images[3], all_of_it.rgb[0])


def test_a_batch_is_bitwise_its_frames(smooth: MembraneMesh) -> None:
    """Frames drawn four at a time equal frames drawn alone."""
    studio = studio_of(smooth, LightModel.HYBRID, markers=Markers(visible=True))
    frames = press(smooth)
    alone = np.concatenate([studio.images(frame[None]) for frame in frames])
    imager = Imager.from_state(studio.imager.state())
    roomy = _with_room(imager, 4)
    assert np.array_equal(roomy.images(frames), alone)
    assert np.array_equal(imager.images(frames), alone)


def _with_room(imager: Imager, frames: int) -> Imager:
    from sim.optics.raster.shader import Shader

    raster = Raster(imager.raster.view, frames=frames)
    return Imager(raster, Shader(raster, imager.shader.lit), imager.backdrop)


def test_linear_light_encodes_to_the_images(smooth: MembraneMesh) -> None:
    """Encoding `linear` by the plain twin gives `images` to one grey level."""
    from sim.optics.raster.display import encode

    studio = studio_of(smooth, LightModel.DIRECT, markers=Markers(visible=True))
    frames = press(smooth)
    encoded = encode(studio.linear(frames), studio.imager.backdrop.exposure)
    # Both use one table; a float that rounds to the other side of a step differs by one.
    assert np.abs(encoded.astype(int) - studio.images(frames)).max() <= 1


def test_vertices_have_the_pixels_that_see_them(smooth: MembraneMesh) -> None:
    """The pixel at a visible vertex's coordinates sees a place within two pixels of it."""
    studio = studio_of(smooth, LightModel.LINEAR)
    view = studio.imager.raster.view
    uv = studio.vertex_pixels
    shown = np.flatnonzero(studio.visible)
    assert 0.4 < studio.visible.mean() < 0.95
    assert np.isfinite(uv[shown]).all()
    cell = np.minimum(uv[shown, :2].astype(int), [159, 119])
    pixel = cell[:, 1] * 160 + cell[:, 0]
    seen = view.origin_mm[pixel] + _first_mm(view)[pixel, None] * view.direction[pixel]
    gap = np.linalg.norm(seen - view.points_mm[shown], axis=1)
    # A pixel is up to range / focal = 45 / 67 mm wide, and wider on skin seen at a slant.
    assert np.nanmedian(gap) < 0.4
    ranges = np.linalg.norm(view.points_mm[shown] - np.asarray(SMALL.position_mm), axis=1)
    # The bent way is longer than the straight line, by little; interpolated over pixels of 0.4 mm.
    assert (uv[shown, 2] >= ranges - 0.02).all() and np.median(uv[shown, 2] - ranges) < 0.5


def test_a_ridge_hides_skin_from_the_camera() -> None:
    """Behind a groove 8 mm deep vertices have a pixel and are not visible."""
    mesh = finger(edge_mm=0.8)
    outer, inner, cavity = (ridged(s, 8.0) for s in (mesh.outer, mesh.inner, mesh.cavity))
    deep = skins_only(outer=outer, inner=inner, cavity=cavity)
    view = open_skin_view(deep, SMALL, index=1.0)
    assert (view.projects & ~view.visible).any()
    assert view.visible.any()


def test_the_axis_is_the_cameras(smooth: MembraneMesh) -> None:
    """The backdrop of a tilted camera keeps its own axis, for depth_z."""
    studio = Studio(smooth, lit(smooth, LightModel.LINEAR)[0], Optics(camera=TILTED))
    axis = rotation_camera_to_sensor(TILTED)[:, 2]
    assert studio.imager.backdrop.axis == pytest.approx(axis, abs=1e-6)
