"""Scores against the recorded photon images, and the recording itself."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core.base.errors import StoreError
from workbench.core.design.lighting import LightModel
from workbench.proof.validation.optics import light_images, light_models
from workbench.proof.validation.optics.light_images import (
    Score,
    box_around,
    fitted_gain,
    flat_exposure,
    reference,
    score,
    true_gain,
)
from workbench.proof.validation.optics.light_scenes import SCENES

WHOLE = (slice(None), slice(None))


def test_equal_images_score_one_and_a_grey_level_48_dB() -> None:
    """SSIM 1 and 100 dB for equal images; an error of one grey level everywhere is 48.13 dB."""
    light = np.full((20, 20, 3), 0.2, dtype=np.float32)
    assert score(light, light, WHOLE) == Score(ssim_1=1.0, psnr_dB=100.0)
    # A grey level is 1 / 255 of the display value; the slope of sRGB at 0.2 is 1.06.
    brighter = light + np.float32(1.0 / 255.0 / 1.06)
    assert score(brighter, light, WHOLE).psnr_dB == pytest.approx(48.13, abs=0.01)


def test_the_gain_is_that_of_least_squares() -> None:
    """A change half as strong as the truth, with noise across it, gets the gain 2."""
    truth = np.zeros((4, 4, 3))
    truth[0, 0] = 2.0
    assert fitted_gain(truth / 2.0, truth, WHOLE) == pytest.approx(2.0)
    assert fitted_gain(0.0 * truth, truth, WHOLE) == 0.0


def test_noise_of_a_bake_does_not_count_as_gain() -> None:
    """Noise of .3 of a change that is right: least squares read .92, a pair of bakes 1.00."""
    random = np.random.default_rng(0)
    truth = random.normal(size=(200, 200, 3))
    one, other = (truth + 0.3 * random.normal(size=truth.shape) for _ in range(2))
    assert fitted_gain(one, truth, WHOLE) == pytest.approx(1.0 / 1.09, abs=0.01)
    assert true_gain(one, other, truth) == pytest.approx(1.0, abs=0.01)
    assert true_gain(2.0 * one, 2.0 * other, truth) == pytest.approx(0.5, abs=0.01)
    assert true_gain(0.0 * one, other, truth) == 0.0


def test_the_box_has_six_pixels_about_the_dent_and_stays_in_the_image() -> None:
    """Pixels 10 to 20 across and 3 to 9 down: columns 4 to 26, rows 0 to 15."""
    uv = np.array([[10.0, 3.0], [20.0, 9.0]])
    assert box_around(uv, (30, 40)) == (slice(0, 15), slice(4, 26))


def test_dark_pixels_do_not_expose_an_image() -> None:
    """Half of the image sees nothing: the exposure is that of the other half."""
    radiance = np.zeros((10, 10, 3))
    radiance[:5] = 0.5
    assert flat_exposure(radiance) == pytest.approx(flat_exposure(radiance[:5]))


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_recorded_photons_leave_less_noise_than_models_are_judged_by(scene: object) -> None:
    """Half of the photons scores 0.995 or more against the other half, in every frame."""
    name = getattr(scene, "name", "")
    frames = reference(name).frames
    dents = {"finger": {"sphere", "cross", "tip", "contact"}}.get(
        name.split()[0], {"sphere", "edge"}
    )
    assert set(frames) == {"flat", *dents}
    assert all(frame.ceiling.ssim_1 >= 0.995 for frame in frames.values())
    assert all(frame.photons >= 1e9 for frame in frames.values())


def test_images_of_another_body_are_not_compared_with(monkeypatch: pytest.MonkeyPatch) -> None:
    """A family that was reshaped since: the file is refused, and a row that needs it fails."""
    monkeypatch.setattr(light_images, "body_digest", lambda body: f"another {body}")
    with pytest.raises(StoreError, match="shows another body as trunk shell"):
        reference.__wrapped__("trunk shell")


@pytest.mark.slow
def test_hybrid_reaches_the_photons_in_the_shell_of_a_finger(taichi_device: str) -> None:
    """One bake: 38 dB and 0.012 below the ceiling on every dent, far above showing no contact."""
    scene = next(found for found in SCENES if found.name == "finger shell")
    shown, every = light_models.rendered(scene, LightModel.HYBRID, 1), reference(scene.name)
    rest = every.frames["flat"]
    assert shown.rest.ssim_1 > 0.97 and shown.rest.psnr_dB > 41.0
    assert 0.95 < shown.fitted < 1.08
    for name, found in shown.dents.items():
        frame = every.frames[name]
        null = score(rest.light, frame.light, frame.box)
        assert found.ssim_1 >= max(frame.ceiling.ssim_1 - 0.012, null.ssim_1), name
        assert found.psnr_dB >= max(38.0, null.psnr_dB), name
