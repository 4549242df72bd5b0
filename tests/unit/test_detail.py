"""Fine textures in images: right in tilt, depth and light, and nothing where there is none."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from sim.optics.field.bake import bake_light
from sim.optics.field.table import look_up
from sim.optics.proof.detail_checks import (
    PATCH_MM,
    WAVES,
    PLANE_STRAIN_MPa,
    carried_contrast,
    tip_detail,
    wave_contrast,
)
from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.bundles import Spots
from sim.optics.raster.imager import Imager
from sim.optics.raster.shading import relight, shade, take
from sim.optics.studio.detail import Detail, open_detail, touched_pixels
from sim.optics.studio.detail_kernels import shade_points
from sim.optics.studio.render import Studio
from tests.synthetic_light import SHADED, lit
from workbench.core.design.camera import Camera, ImageSensor
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.design.optics import Markers, Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import Pattern, Texture
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sensing import Contact

pytestmark = pytest.mark.usefixtures("taichi_device")

RING = LedRing(radius_mm=3.0)
CLOSE = Camera(width_px=160, height_px=120, fov_x_deg=14.0)
TIP_MM = 14.0


def flat_patch_tilt_deg(imager: Imager, detail: Detail) -> float:
    """Steepest angle [degree] between normals with and without detail near the patch's middle.

    The imager must have looked at the frame; for waves that is atan(2 pi amplitude / period).
    """
    touched, fine = touched_pixels(imager, detail.pressure_MPa[0]), detail.seen(imager, 0)
    assert fine is not None
    near = np.linalg.norm(touched.place_mm[:, :2], axis=1) < 0.5 * PATCH_MM
    cosine = -np.einsum("pc,pc->p", touched.normal, fine.normal)[near]
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).max())


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(radius_mm=8.0, elastomer_mm=1.5, cylinder_mm=6.0, edge_mm=0.4)


@pytest.fixture(scope="module")
def moved(mesh: MembraneMesh) -> np.ndarray:
    return dent(mesh.outer, at_mm=(0.0, 0.0, TIP_MM), depth_mm=0.4, radius_mm=3.0)


def open_studio(mesh: MembraneMesh, model: LightModel, **optics: Any) -> Studio:
    light, table = lit(mesh, model, RING)
    seen = Optics(**{"camera": CLOSE, "ring": RING, "light_model": model, **optics})
    return Studio(mesh, light, seen, table=table)


def pressed(mesh: MembraneMesh, **fields: Any) -> Contact:
    """A press at the tip of which only what detail reads is known."""
    shown, count = tip_detail(mesh.outer), len(mesh.outer.points_mm)
    nothing = np.zeros((1, 3))
    known: dict[str, Any] = {
        "displacement_mm": np.zeros((1, count, 3), dtype=np.float32),
        **dict.fromkeys(("reaction_N", "moment_Nmm", "support_N", "cut_N"), nothing),
        **dict.fromkeys(("residual", "penetration_mm", "friction_ratio"), np.zeros(1)),
        "indenter_pose": shown.pose,
        "pressure_MPa": shown.pressure_MPa,
        "sliding": np.zeros((1, count), dtype=bool),
        **dict.fromkeys(("target_mm", "normal", "tangent_u"), np.zeros(3)),
        "grid_mm": 0.5,
        "active_radius_mm": 5.0,
        "particles": 1,
        "substeps": 1,
        "device": "none",
    }
    return Contact(**{**known, **fields})


def opened(mesh: MembraneMesh, indenter: Indenter, **fields: Any) -> Detail | None:
    return open_detail(
        indenter, mesh, pressed(mesh, **fields), young_MPa=PLANE_STRAIN_MPa, poisson=0.0
    )


def test_tilt_of_waves_is_two_pi_amplitude_over_period(
    mesh: MembraneMesh, moved: np.ndarray
) -> None:
    """Steepest tilt of 0.03 mm over 0.5 mm under full pressure: atan(pi 0.03 / 0.5) = 10.67."""
    studio = open_studio(mesh, LightModel.DIRECT)
    studio.imager.look(moved[None])
    found = flat_patch_tilt_deg(studio.imager, tip_detail(mesh.outer))
    # The skin is tilted to the waves by up to 5 degrees itself, which costs 1 - cos(5).
    assert found == pytest.approx(np.degrees(np.arctan(np.pi * 0.03 / 0.5)), rel=0.02)


@pytest.mark.parametrize(("share", "limit"), [(0.02, 0.35), (0.3, 0.85)])
def test_less_pressure_shows_less(
    mesh: MembraneMesh, moved: np.ndarray, share: float, limit: float
) -> None:
    """The valleys stay out of touch; even at 2 % of full pressure the crests show a little."""
    studio = open_studio(mesh, LightModel.DIRECT)
    detail, little = tip_detail(mesh.outer), tip_detail(mesh.outer, pressed=share)
    whole, part = (studio.detailed(moved, d) for d in (detail, little))
    plain = studio.linear(moved[None])[0].reshape(-1, 3)
    ratio = np.abs(part - plain).mean() / np.abs(whole - plain).mean()
    assert 0.02 < ratio < limit


@pytest.mark.slow
@pytest.mark.parametrize("model", [LightModel.DIRECT, LightModel.LINEAR])
def test_contrast_is_that_of_a_fine_mesh(model: LightModel) -> None:
    """Waves below the grid appear at their pitch with the witness's amplitude, within 10 %.

    Without detail nothing does: below 1 % of it.
    """
    shown, null = wave_contrast(model)
    # The witness's own edges, ten per period, lose 3 % of the tilt; with twenty this is 1.013.
    assert shown == pytest.approx(1.0, abs=0.1)
    assert abs(null) < 0.01


@pytest.mark.slow
def test_detail_and_skin_share_a_pattern_between_them() -> None:
    """Waves of 1.5 mm on a skin of 0.4 mm triangles: with detail the witness's contrast.

    The skin alone shows less, as its normals are averaged over triangles.
    """
    shown, alone = carried_contrast()
    # The split takes the mean square of edges that differ with direction.
    assert shown == pytest.approx(1.0, abs=0.1)
    assert 0.3 < alone < 0.9


def test_depth_follows_the_relief(mesh: MembraneMesh, moved: np.ndarray) -> None:
    """Depth differs by the 0.03 mm between crests and valleys, and by nothing in the mean."""
    studio = open_studio(mesh, LightModel.DIRECT)
    detail = tip_detail(mesh.outer)
    plain = studio.shoot(moved[None])
    fine = studio.shoot(moved[None], detail=detail)
    change = fine.depth_z_mm[1] - plain.depth_z_mm[1]
    assert np.array_equal(fine.depth_z_mm[0], plain.depth_z_mm[0], equal_nan=True)
    # The tip is seen along the waves' height, within 5 degrees; float32 depth resolves 1e-6.
    assert np.nanmax(change) == pytest.approx(0.015, rel=0.03)
    assert np.nanmin(change) == pytest.approx(-0.015, rel=0.03)
    touched = np.abs(change) > 1e-5
    assert abs(np.nanmean(change[touched])) < 1e-3


@pytest.mark.parametrize("model", SHADED)
def test_every_light_model_shows_it_inside_the_patch_alone(
    mesh: MembraneMesh, moved: np.ndarray, model: LightModel
) -> None:
    """Some pixel changes by 5 grey levels; none that sees no touched triangle changes at all."""
    studio, detail = open_studio(mesh, model), tip_detail(mesh.outer)
    plain = studio.shoot(moved[None])
    fine = studio.shoot(moved[None], detail=detail)
    touched = touched_pixels(studio.imager, detail.pressure_MPa[0])
    outside = np.ones(plain.moved[1].size, dtype=bool)
    outside[touched.pixel] = False
    for name in ("rgb", "depth_z_mm", "normal"):
        before, after = (getattr(f, name)[1] for f in (plain, fine))
        flat = before.reshape(outside.size, -1), after.reshape(outside.size, -1)
        assert np.array_equal(flat[0][outside], flat[1][outside], equal_nan=True)
    assert np.abs(fine.rgb[1].astype(int) - plain.rgb[1]).max() >= 5
    assert np.array_equal(fine.moved, plain.moved)


def test_no_seam_at_the_rim(mesh: MembraneMesh, moved: np.ndarray) -> None:
    """Where few corners are touched, little changes: below 15 % of what the middle shows."""
    studio, detail = open_studio(mesh, LightModel.DIRECT), tip_detail(mesh.outer)
    studio.imager.look(moved[None])
    touched = touched_pixels(studio.imager, detail.pressure_MPa[0])
    fine = detail.seen(studio.imager, 0)
    assert fine is not None
    change = np.abs(fine.change).max(axis=1)
    assert touched.share.min() < 0.1
    assert change[touched.share < 0.1].max() < 0.15 * change.max()


@pytest.mark.parametrize("model", SHADED)
def test_points_are_shaded_as_the_plain_twins(
    mesh: MembraneMesh, moved: np.ndarray, model: LightModel
) -> None:
    """Corner by corner `shade` of `relight`, and `look_up`, weighed: to single precision."""
    light, table = lit(mesh, model, RING)
    optics = Optics(camera=CLOSE, ring=RING, light_model=model)
    studio = Studio(mesh, light, optics, table=table)
    studio.imager.look(moved[None])
    touched = touched_pixels(studio.imager, tip_detail(mesh.outer).pressure_MPa[0])
    count = 200
    corners = np.ascontiguousarray(touched.corners[:count], dtype=np.int32)
    smooth = -touched.normal[:count].astype(np.float32)
    rough = smooth + np.random.default_rng(3).normal(0.0, 0.2, smooth.shape)
    tilted = (rough / np.linalg.norm(rough, axis=1, keepdims=True)).astype(np.float32)
    before, after = np.zeros((2, count, 3), dtype=np.float32)
    raster, shader = studio.imager.raster, studio.imager.shader
    shares = np.ascontiguousarray(touched.weights[:count])
    spots = Spots(corners=corners, shares=shares, smooth=smooth, tilted=tilted)
    light_of_skin = (shader.lights, shader.scattered, shader.law)
    run: Any = shade_points
    run(spots, raster.skin, raster.posed, *light_of_skin, before, after)
    away = raster.posed.to_camera.to_numpy()
    for normals, found in ((smooth, before), (tilted, after)):
        total = np.zeros((count, 3))
        for corner in range(3):
            vertex = corners[:, corner]
            part = np.zeros((count, 3))
            if model is not LightModel.TABLE:
                field = take(light, vertex)
                if model in (LightModel.DIRECT, LightModel.HYBRID):
                    still = mesh.outer.points_mm[vertex]
                    # The twin drops light from behind the smooth skin; shading does so again.
                    field = relight(field, still, still + moved[vertex], -normals, patch=None)
                part += shade(model, field, optics.coating, normals, away[vertex])
            if table is not None and light.scattered is not None:
                kept = light.scattered
                nodes, weights = kept.nodes[vertex], kept.weights[vertex]
                part += look_up(table.values[0], nodes, weights, kept.frame, normals)
            total += shares[:, corner : corner + 1] * part
        # Sums of nine lights and nine table entries in single precision.
        assert np.abs(found - total).max() < 2e-5 * np.abs(total).max()


def test_equal_normals_change_nothing(mesh: MembraneMesh, moved: np.ndarray) -> None:
    """Detail without pressure leaves every image bitwise as it was."""
    studio, detail = open_studio(mesh, LightModel.HYBRID), tip_detail(mesh.outer)
    none = dataclasses.replace(detail, pressure_MPa=np.zeros_like(detail.pressure_MPa))
    flat = dataclasses.replace(detail, pressure_MPa=np.full_like(detail.pressure_MPa, 1e-12))
    plain = studio.shoot(moved[None])
    for nothing in (none, flat):
        shown = studio.shoot(moved[None], detail=nothing)
        # At 1e-6 of the full pressure crests tilt by a millionth of the slope.
        assert np.abs(shown.rgb.astype(int) - plain.rgb).max() <= (nothing is flat)
    assert np.array_equal(studio.shoot(moved[None], detail=none).normal, plain.normal)


def test_ink_and_image_sensor_take_part(mesh: MembraneMesh, moved: np.ndarray) -> None:
    """With black dots the texture is dimmed under the ink; with a gamma of 1 it shows as well."""
    detail = tip_detail(mesh.outer)

    def contrast(**optics: Any) -> np.ndarray:
        studio = open_studio(mesh, LightModel.DIRECT, **optics)
        frames = [studio.shoot(moved[None], detail=d).rgb[1].astype(int) for d in (detail, None)]
        return np.abs(frames[0] - frames[1]).sum(axis=2)

    bare = contrast()
    inked = contrast(markers=Markers(visible=True, spacing_mm=1.0, diameter_mm=0.9))
    assert inked.sum() < 0.9 * bare.sum()
    plain = dataclasses.replace(CLOSE, sensor=ImageSensor(gamma=1.0))
    assert contrast(camera=plain).max() > 5


def test_what_shows_no_detail(mesh: MembraneMesh) -> None:
    """Smooth and soft objects, skins seen through pins, and presses without pressure."""
    waved = Indenter(size_mm=10.0, texture=WAVES)
    assert opened(mesh, waved) is not None
    assert opened(mesh, Indenter()) is None
    assert opened(mesh, dataclasses.replace(waved, soft=SoftBody())) is None
    assert opened(mesh, waved, pressure_MPa=np.zeros((0, 0), dtype=np.float32)) is None
    assert opened(dataclasses.replace(mesh, tips_mm=np.zeros((1, 3))), waved) is None
    wide = Texture(pattern=Pattern.WAVES, pitch_mm=60.0, height_mm=0.05)
    assert opened(mesh, Indenter(size_mm=10.0, texture=wide)) is None


def test_opened_detail_knows_object_and_skin(mesh: MembraneMesh) -> None:
    """Full pressure is pi E* d / l with E* = E / (1 - nu^2); the body reaches 5 mm up."""
    waved = Indenter(size_mm=10.0, texture=WAVES)
    found = open_detail(waved, mesh, pressed(mesh), young_MPa=0.145, poisson=0.45)
    assert found is not None
    exact = np.pi * 0.145 / (1.0 - 0.45**2) * 0.015 / 0.5
    assert found.filling.full_MPa == pytest.approx(exact, rel=3e-3)
    assert found.top_mm == 5.0


def test_baked_light_is_not_touched(mesh: MembraneMesh, moved: np.ndarray) -> None:
    """Frames with detail do not change those without that follow them."""
    light = bake_light(mesh, RING, model=LightModel.DIRECT)
    studio = Studio(mesh, light, Optics(camera=CLOSE, ring=RING))
    first = studio.shoot(moved[None]).rgb
    studio.shoot(moved[None], detail=tip_detail(mesh.outer))
    assert np.array_equal(studio.shoot(moved[None]).rgb, first)
