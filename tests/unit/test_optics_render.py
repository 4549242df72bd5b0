"""Images: exact background, markers, messages, and what may not change what."""

from __future__ import annotations

import dataclasses
import inspect
from typing import Any

import numpy as np
import pytest

from sim.optics.camera.camera import refracted_rays
from sim.optics.field.bake import bake_light
from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.gbuffer import open_view
from sim.optics.raster.markers import ink, place_markers, print_dots
from sim.optics.studio.render import shoot
from tests.synthetic_light import SHADED, lit
from workbench.core.base.errors import Cancelled, DesignError, OpticsError
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing, LightModel
from workbench.core.design.optics import Coating, Markers, Optics
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sensing import TactileFrames

pytestmark = pytest.mark.usefixtures("taichi_device")

SMALL = Camera(width_px=160, height_px=120)
DENT_MM = (15.0, 0.0, 22.0)


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=1.0)


def render(mesh: MembraneMesh, optics: Optics, **shape: Any) -> TactileFrames:
    light, table = lit(mesh, optics.light_model, optics.ring)
    shape = {"at_mm": DENT_MM, "depth_mm": 1.2, "radius_mm": 4.0, **shape}
    moved = dent(mesh.outer, **shape)
    frames = np.stack([0.5 * moved, moved])
    return shoot(mesh, light, optics, table=table, displacement_mm=frames)


@pytest.mark.parametrize("model", SHADED)
def test_unmoved_pixels_are_exactly_the_background(mesh: MembraneMesh, model: LightModel) -> None:
    """Grey difference 0 outside the moved mask, in image, depth and normal."""
    frames = render(mesh, Optics(camera=SMALL, light_model=model))
    still = ~frames.moved[1:]
    assert 0.01 < 1.0 - still[1].mean() < 0.5
    for images in (frames.rgb, frames.depth_z_mm, frames.normal):
        repeated = np.broadcast_to(images[:1], images[1:].shape)
        gaps = images.dtype.kind == "f"
        assert np.array_equal(images[1:][still], repeated[still], equal_nan=gaps)


@pytest.mark.parametrize("model", SHADED)
def test_a_dent_shows_in_every_colour(mesh: MembraneMesh, model: LightModel) -> None:
    """Red, green and blue each change by 10 grey levels or more somewhere in the dent."""
    frames = render(mesh, Optics(camera=SMALL, light_model=model))
    change = np.abs(frames.rgb[2].astype(int) - frames.rgb[0]).max(axis=(0, 1))
    assert (change >= 10).all()
    assert np.isfinite(frames.normal).all() and np.isfinite(frames.exposure).all()


def test_frame_zero_is_the_background_alone(mesh: MembraneMesh) -> None:
    """Without displacement there is one image; it equals frame 0 of a press."""
    optics = Optics(camera=SMALL, light_model=LightModel.DIRECT)
    light = bake_light(mesh, optics.ring, model=optics.light_model)
    alone = shoot(mesh, light, optics)
    assert alone.rgb.shape == (1, 120, 160, 3) and not alone.moved.any()
    assert np.array_equal(alone.rgb[0], render(mesh, optics).rgb[0])


def test_no_displacement_is_the_background(mesh: MembraneMesh) -> None:
    """A displacement below 1e-3 mm moves no pixel."""
    frames = render(mesh, Optics(camera=SMALL, light_model=LightModel.DIRECT), depth_mm=0.9e-3)
    assert not frames.moved.any()
    assert np.array_equal(frames.rgb[2], frames.rgb[0])


def test_normals_face_the_camera(mesh: MembraneMesh) -> None:
    """On the axis the skin's normal points straight back at the camera: (0, 0, -1)."""
    frames = render(mesh, Optics(camera=SMALL, light_model=LightModel.DIRECT))
    # float16 resolves 5e-4; the centre pixels lie 0.5 px = 0.2 mm from the axis on R 15.
    assert frames.normal[0, 60, 80].astype(float) == pytest.approx([0, 0, -1], abs=0.05)
    assert np.linalg.norm(frames.normal[0].astype(float), axis=2) == pytest.approx(1.0, abs=2e-3)


def test_light_comes_from_a_camera_free_bake() -> None:
    """bake_light takes skins, lights, model and what photons meet: no camera, marker or press."""
    assert list(inspect.signature(bake_light).parameters) == [
        "mesh",
        "ring",
        "lamps",
        "model",
        "transport",
        "monitor",
    ]


def test_coating_and_camera_change_the_image_without_a_new_bake(mesh: MembraneMesh) -> None:
    """One light field serves two cameras and two coatings."""
    optics = Optics(camera=SMALL, light_model=LightModel.DIRECT)
    light = bake_light(mesh, optics.ring, model=optics.light_model)
    first = shoot(mesh, light, optics)
    glossy = dataclasses.replace(optics, coating=Coating(specular=0.9, albedo=0.1))
    narrow = dataclasses.replace(optics, camera=dataclasses.replace(SMALL, fov_x_deg=60.0))
    assert not np.array_equal(shoot(mesh, light, glossy).rgb, first.rgb)
    assert not np.array_equal(shoot(mesh, light, narrow).depth_z_mm, first.depth_z_mm)


def test_a_single_colour_lights_a_single_channel(mesh: MembraneMesh) -> None:
    """Blue LEDs leave red and green at 0, and blue is exposed to 0.8, not saturated."""
    frames = render(
        mesh,
        Optics(camera=SMALL, ring=LedRing(colours=("#0000ff",)), light_model=LightModel.DIRECT),
    )
    assert not frames.rgb[0][..., :2].any()
    assert np.percentile(frames.rgb[0][..., 2], 99) == pytest.approx(204, abs=1)


def test_a_dent_shadows_the_skin_behind_it(mesh: MembraneMesh) -> None:
    """One LED at +X low in a shell, a deep dent above it: a moved vertex behind goes dark."""
    ring = LedRing(
        count=1, radius_mm=12.5, phase_deg=0.0, mount=LedMount.SHELL, colours=("#ff0000",)
    )
    frames = render(
        mesh,
        Optics(camera=SMALL, ring=ring, light_model=LightModel.DIRECT),
        depth_mm=2.5,
        radius_mm=5.0,
    )
    darkest = frames.rgb[2][..., 0][frames.moved[2]].min()
    before = frames.rgb[0][..., 0][frames.moved[2]].min()
    assert darkest < 0.2 * before


def test_light_that_misses_the_view_is_an_error_not_a_black_image(mesh: MembraneMesh) -> None:
    """LEDs turned to the base light nothing above them."""
    with pytest.raises(OpticsError) as caught:
        render(
            mesh, Optics(camera=SMALL, ring=LedRing(tilt_deg=180.0), light_model=LightModel.DIRECT)
        )
    assert "no light reaches" in caught.value.message and "black" in caught.value.message
    assert caught.value.at == "optics.ring.tilt_deg" and "tilt" in caught.value.hint


def test_a_blind_camera_is_an_error(mesh: MembraneMesh) -> None:
    """A camera turned to the open base is refused by shoot, with exit status 2."""
    camera = dataclasses.replace(SMALL, wxyz=(0.0, 1.0, 0.0, 0.0))
    with pytest.raises(DesignError, match="of the pixels see the skin") as caught:
        render(mesh, Optics(camera=camera, light_model=LightModel.DIRECT))
    assert caught.value.exit_code == 2


def test_a_displacement_that_is_not_finite_names_its_frame(mesh: MembraneMesh) -> None:
    """Frame 2 holds a NaN."""
    optics = Optics(camera=SMALL, light_model=LightModel.DIRECT)
    light = bake_light(mesh, optics.ring, model=optics.light_model)
    displacement = np.zeros((2, len(mesh.outer.points_mm), 3), dtype=np.float32)
    displacement[1, 5, 0] = np.nan
    with pytest.raises(OpticsError, match="frame 2 is not finite"):
        shoot(mesh, light, optics, displacement_mm=displacement)


def test_a_light_field_of_another_mesh_is_a_bug(mesh: MembraneMesh) -> None:
    """Vertex counts must agree."""
    other = finger(edge_mm=2.0)
    light = bake_light(other, LedRing(), model=LightModel.LINEAR)
    with pytest.raises(ValueError, match="light field has shape"):
        shoot(mesh, light, Optics(camera=SMALL, light_model=LightModel.DIRECT))


def test_cancelling_stops_between_images(mesh: MembraneMesh) -> None:
    """The monitor's Cancelled passes through bake and shoot."""

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stopped")

    light = bake_light(mesh, LedRing(), model=LightModel.LINEAR)
    with pytest.raises(Cancelled):
        bake_light(mesh, LedRing(), model=LightModel.LINEAR, monitor=stop)
    with pytest.raises(Cancelled):
        shoot(mesh, light, Optics(camera=SMALL, light_model=LightModel.DIRECT), monitor=stop)


def test_markers_keep_their_distance(mesh: MembraneMesh) -> None:
    """No two dots are nearer than the spacing, and no vertex is farther than it from a dot."""
    centres = place_markers(mesh.outer, Markers(visible=True, spacing_mm=3.0))
    gaps = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    assert gaps[~np.eye(len(centres), dtype=bool)].min() >= 3.0
    reach = np.linalg.norm(mesh.outer.points_mm[:, None] - centres[None], axis=2).min(axis=1)
    assert reach.max() < 3.0


def test_hidden_markers_are_none() -> None:
    """Invisible markers have no centres and leave the image alone."""
    assert place_markers(finger(edge_mm=2.0).outer, Markers(visible=False)).shape == (0, 3)


def test_the_tip_marker_sits_in_the_image_centre(mesh: MembraneMesh) -> None:
    """The first dot is the highest vertex, on the optical axis: 80, 60 px; dots out of view NaN."""
    frames = render(
        mesh, Optics(camera=SMALL, markers=Markers(visible=True), light_model=LightModel.DIRECT)
    )
    assert frames.marker_uv_px.shape[0] == 3
    # The axis passes between four pixels, whose shares balance to a tenth of a pixel.
    assert frames.marker_uv_px[0, 0] == pytest.approx([80.0, 60.0], abs=0.1)
    hidden = np.isnan(frames.marker_uv_px[0]).all(axis=1)
    assert 0.1 < hidden.mean() < 0.9


def test_markers_follow_the_skin(mesh: MembraneMesh) -> None:
    """Moving the tip region 1 mm toward +X moves the tip dot by f / depth = 134 / 41.7 px."""
    optics = Optics(
        camera=SMALL,
        markers=Markers(visible=True),
        refractive_index=1.0,
        light_model=LightModel.DIRECT,
    )
    light = bake_light(mesh, optics.ring, model=optics.light_model)
    sideways = np.zeros((1, len(mesh.outer.points_mm), 3), dtype=np.float32)
    sideways[0, mesh.outer.points_mm[:, 2] > 38.0, 0] = 1.0
    frames = shoot(mesh, light, optics, displacement_mm=sideways)
    shift = frames.marker_uv_px[1, 0] - frames.marker_uv_px[0, 0]
    focal = 160 / (2 * np.tan(np.radians(50.0)))
    # A dot 2.5 px wide is located by its inked pixels to about a twentieth of its width.
    assert shift == pytest.approx([focal / 41.7, 0.0], abs=0.15)


def test_skipping_triangles_without_ink_changes_nothing(mesh: MembraneMesh) -> None:
    """Coverage with all triangles searched equals coverage with the marked ones only."""
    # Wide gaps: with dots 2 mm apart every triangle of this mesh is near one.
    markers = Markers(visible=True, spacing_mm=8.0)
    view = open_view(mesh.outer, SMALL, refracted_rays(SMALL, mesh.cavity, 1.41))
    dots = print_dots(mesh.outer, markers, SMALL)
    everywhere = dataclasses.replace(dots, inked=np.ones_like(dots.inked))
    seen = view.background
    few, all_of_them = (
        ink(
            seen,
            dots=each,
            skin=mesh.outer,
            camera=SMALL,
            rays=view.rays,
        ).ink
        for each in (dots, everywhere)
    )
    assert np.array_equal(few, all_of_them)
    assert 0.0 < few.mean() < 0.3 and dots.inked.mean() < 0.9
