"""Image scores against their closed forms, and the score card of a synthetic press."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.optics.field.bake import bake_light
from sim.optics.proof.specimen import dent, finger
from sim.optics.studio.metrics import contact_box, contact_pixels, mae_grey, measure, psnr_dB, ssim
from sim.optics.studio.render import shoot
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.sensing import Contact, Metrics, TactileFrames


def plain(level: int) -> np.ndarray:
    return np.full((40, 40, 3), level, dtype=np.uint8)


def test_psnr_of_a_uniform_difference_of_10() -> None:
    """10 log10(255^2 / 100) = 28.13 dB, also where unsigned bytes would wrap."""
    assert psnr_dB(plain(100), plain(110)) == pytest.approx(28.1308, abs=1e-4)
    assert mae_grey(plain(110), plain(100)) == mae_grey(plain(100), plain(110)) == 10.0


def test_ssim_of_uniform_images_is_its_luminance_term() -> None:
    """(2 a b + c1) / (a^2 + b^2 + c1) with c1 = 6.5025, and 1 for equal images."""
    exact = (2 * 100 * 110 + 6.5025) / (100**2 + 110**2 + 6.5025)
    assert ssim(plain(100), plain(110)) == pytest.approx(exact, abs=1e-9)
    noise = np.random.default_rng(1).integers(0, 255, (40, 40, 3)).astype(np.uint8)
    assert ssim(noise, noise) == pytest.approx(1.0)


def test_contact_box_bounds_the_mask() -> None:
    """Rows 2 to 4 and columns 5 to 9; None for an empty mask."""
    mask = np.zeros((10, 12), dtype=bool)
    mask[2, 9] = mask[4, 5] = True
    assert contact_box(mask) == (slice(2, 5), slice(5, 10))
    assert contact_box(np.zeros((10, 12), dtype=bool)) is None


def make_contact(displacement: np.ndarray) -> Contact:
    """A press along -X with 0.5 N at half depth and 1.5 N at full depth."""
    frames, vertices = displacement.shape[:2]
    force = np.zeros((frames, 3))
    force[:, 0] = [0.5, 1.5]
    return Contact(
        displacement_mm=displacement,
        reaction_N=force,
        moment_Nmm=np.zeros((frames, 3)),
        indenter_pose=np.zeros((frames, 7)),
        residual=np.full(frames, 1e-4),
        penetration_mm=np.full(frames, 0.002),
        support_N=force,
        cut_N=np.zeros((frames, 3)),
        friction_ratio=np.zeros(frames),
        sliding=np.zeros((frames, vertices), dtype=bool),
        target_mm=np.array([15.0, 0.0, 22.0]),
        normal=np.array([1.0, 0.0, 0.0]),
        tangent_u=np.array([0.0, 0.0, 1.0]),
        grid_mm=0.5,
        active_radius_mm=9.0,
        particles=1,
        substeps=1,
        device="cpu",
    )


@pytest.fixture(scope="module")
def press(taichi_device: str) -> tuple[Metrics, TactileFrames]:
    mesh, optics = (
        finger(edge_mm=1.0),
        Optics(camera=Camera(width_px=160, height_px=120), light_model=LightModel.DIRECT),
    )
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 22.0), depth_mm=1.2, radius_mm=4.0)
    displacement = np.stack([0.5 * moved, moved])
    light = bake_light(mesh, optics.ring, model=optics.light_model)
    frames = shoot(mesh, light, optics, displacement_mm=displacement)
    return measure(mesh, make_contact(displacement), frames, light), frames


def test_stiffness_is_peak_force_over_indentation(press: tuple[Metrics, TactileFrames]) -> None:
    """1.5 N at a dent of 1.2 mm, whose centre is a vertex: 1.25 N/mm."""
    values = press[0].values
    assert values["peak_normal_force_N"] == pytest.approx(1.5)
    # Displacements are stored in float32.
    assert values["displacement_max_mm"] == pytest.approx(1.2, rel=1e-6)
    assert values["stiffness_N_per_mm"] == pytest.approx(1.25, rel=1e-6)


def test_every_score_is_finite_and_the_dent_beats_the_null(
    press: tuple[Metrics, TactileFrames],
) -> None:
    """The null (background) is no copy of the frame: PSNR below 40 dB, change above 1 grey."""
    values = press[0].values
    assert all(math.isfinite(value) for value in values.values())
    assert values["contact_null_psnr_dB"] < 40.0
    assert values["contact_null_ssim_1"] < 1.0
    assert values["contact_change_mean_grey"] > 1.0
    assert values["contact_change_max_grey"] >= 10.0
    assert values["contact_contrast_1"] > 0.0


def test_finger_fills_the_image_and_is_lit_from_three_sides(
    press: tuple[Metrics, TactileFrames],
) -> None:
    """A camera in a convex body sees skin in every pixel, and its ring lights all of it."""
    values = press[0].values
    assert values["image_covered_percent"] == 100.0
    # Skin below the LEDs' height of 0.5 mm lies behind all of them: one ring of 41.
    assert values["skin_lit_by_three_percent"] > 95.0
    assert 0.0 < values["image_evenness_p5_over_p95"] <= 1.0


def test_contact_pixels_are_the_deep_part_of_the_moved_ones(
    press: tuple[Metrics, TactileFrames],
) -> None:
    """A subset of the moved pixels whose depth changed by a tenth of the maximum or more."""
    frames = press[1]
    deep = contact_pixels(frames, -1)
    assert deep.any() and not (deep & ~frames.moved[-1]).any()
    assert deep.sum() < frames.moved[-1].sum()
    assert not contact_pixels(frames, 0).any()
