"""How skin and dent move in a window, as numbers."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.tasks.networks.motion import motion_numbers
from workbench.tasks.networks.shading import shading_numbers, shift_px, without_dots
from workbench.tasks.task import task_of

MM_PER_PX = 0.1875
STEPS = 7
"""Of a window of eight images."""


def cloud(rng: np.random.Generator, width: int = 96, grey: float = 600.0) -> np.ndarray:
    import cv2

    noise = rng.normal(size=(64, width)).astype(np.float32)
    return cv2.GaussianBlur(noise, (0, 0), 4.0) * grey + 128.0


def window(images: list[np.ndarray]) -> np.ndarray:
    return np.repeat(np.stack(images)[..., None], 3, axis=3).astype(np.int16)


def test_motion_is_told_in_millimetres_and_along_the_way() -> None:
    """A cloud that moves by two pixels from image to image, and one that stops halfway.

    The flow is that of smooth patterns: a fifth.
    """
    seen = cloud(np.random.default_rng(6))
    going = motion_numbers(window([seen[:, 2 * k : 2 * k + 64] for k in range(8)]), MM_PER_PX)
    places = [0, 2, 4, 6, 8, 8, 8, 8]
    stopping = motion_numbers(window([seen[:, p : p + 64] for p in places]), MM_PER_PX)
    assert going.shape == (17 * STEPS,)
    lengths_mm = np.exp(going[:STEPS])
    assert lengths_mm[0] == pytest.approx(0.375, rel=0.2)
    assert (np.exp(stopping[4:STEPS]) < 0.01).all()
    # Along the whole way, over that of an object; then the way so far; then over the longest step.
    along, so_far, share = (stopping[at * STEPS : (at + 1) * STEPS] for at in (6, 7, 8))
    assert along[:4] == pytest.approx(3.75, rel=0.25)
    assert np.abs(along[4:]).max() < 0.1
    assert so_far[-1] == pytest.approx(1.5, rel=0.25)
    assert share[:4].max() == pytest.approx(1.0, abs=0.02)


def test_motion_is_the_same_however_the_window_is_turned() -> None:
    """By a quarter, and by a half: all numbers, within what the flow tells apart."""
    seen = cloud(np.random.default_rng(7))
    images = [seen[:, k : k + 64] for k in range(8)]
    found = motion_numbers(window(images), MM_PER_PX)
    for turn in (1, 2):
        turned = motion_numbers(window([np.rot90(each, turn) for each in images]), MM_PER_PX)
        assert turned == pytest.approx(found, abs=0.12)


def test_dots_are_taken_out_of_the_shading() -> None:
    """Black discs of five pixels on a cloud: a grey level or two is left of their 128."""
    import cv2

    plain = np.repeat(cloud(np.random.default_rng(8), 64, 200.0)[..., None], 3, axis=2)
    dotted = plain.copy()
    for at in ((16, 16), (40, 20), (30, 45)):
        cv2.circle(dotted, at, 2, (0.0, 0.0, 0.0), -1)
    off = without_dots(dotted) - without_dots(plain)
    assert np.abs(dotted - plain).max() > 100.0
    assert np.abs(off).max() < 8.0 and np.abs(off).mean() < 0.3


def test_a_shift_explains_a_picture_that_moves_and_no_dent_that_grows() -> None:
    """By .4 px across and .2 up: found within .03, a fifteenth of the change is left.

    A round dent that grows by a tenth is shifted nowhere, and nearly all of the change is left.
    """
    across, down = np.meshgrid(np.arange(64.0), np.arange(64.0))

    def dent(x: float, y: float, height: float) -> np.ndarray:
        grey = height * np.exp(-((across - x) ** 2 + (down - y) ** 2) / 98.0)
        return np.repeat(grey[..., None], 3, axis=2)

    here, there, grown = dent(32.0, 32.0, 60.0), dent(32.4, 31.8, 60.0), dent(32.0, 32.0, 66.0)
    everywhere = np.ones((64, 64), bool)
    shift, left = shift_px(here, there, everywhere)
    assert shift == pytest.approx([0.4, -0.2], abs=0.03)
    assert left < 0.07 * np.sqrt(((there - here) ** 2).mean())
    shift, left = shift_px(here, grown, everywhere)
    assert np.abs(shift).max() < 1e-6
    assert left == pytest.approx(np.sqrt(((grown - here) ** 2).mean()), rel=1e-6)


def test_shading_tells_a_dent_that_grows_from_one_that_stays() -> None:
    """Growing by eight grey levels from image to image: the first seven numbers say so."""
    round_dent = np.exp(-((np.indices((64, 64)) - 32.0) ** 2).sum(axis=0) / 98.0)
    growing = shading_numbers(window([128.0 + 8.0 * k * round_dent for k in range(8)]))
    staying = shading_numbers(window([128.0 + 30.0 * round_dent] * 8))
    assert growing.shape == staying.shape == (6 * STEPS,)
    assert (growing[:STEPS] > np.log(0.5)).all()
    assert np.abs(growing[4 * STEPS :]).max() < 0.05
    assert staying[: 3 * STEPS] == pytest.approx(np.log(0.1), abs=1e-4)
    assert (np.diff(growing[STEPS : 2 * STEPS]) > 0.0).all()
    assert (np.diff(growing[2 * STEPS : 3 * STEPS]) < 0.0).all()


def test_what_is_out_of_sight_holds_nothing() -> None:
    """A quarter of the patch is black: the way in the middle and the shift are found as without."""
    seen = cloud(np.random.default_rng(9), grey=300.0)
    whole = window([seen[:, k : k + 64] for k in range(8)])
    part = whole.copy()
    part[:, :, :16] = 0
    found, wanted = (motion_numbers(each, MM_PER_PX) for each in (part, whole))
    assert found[:STEPS] == pytest.approx(wanted[:STEPS], abs=0.05)
    across, wanted_across = (shading_numbers(each)[4 * STEPS :: 2] for each in (part, whole))
    assert wanted_across == pytest.approx(-1.0, abs=0.25)
    assert across == pytest.approx(wanted_across, abs=0.15)
    black = np.zeros_like(whole)
    assert np.isfinite([*motion_numbers(black, MM_PER_PX), *shading_numbers(black)]).all()


def test_exposure_does_not_count() -> None:
    """A sensor that gets six tenths of the light: all numbers of the shading but the whole grey
    levels' rounding."""
    rng = np.random.default_rng(10)
    seen = cloud(rng, grey=300.0)
    bright = window([seen[:, k : k + 64] for k in range(8)])
    dim = np.rint(0.6 * bright).astype(np.int16)
    assert shading_numbers(dim) == pytest.approx(shading_numbers(bright), abs=0.1)


def test_light_that_drifts_over_a_plain_skin_is_no_shift() -> None:
    """Five grey levels brighter from image to image, with one pixel off: not a pixel's way."""
    images = [np.full((64, 64), 80.0 + 5.0 * k) for k in range(8)]
    for image in images:
        image[40, 40] += 1.0
    shifts = shading_numbers(window(images))[4 * STEPS :]
    assert np.abs(shifts).max() < 1.0


def test_slides_are_pressed_with_friction_about_the_designs() -> None:
    """As far as a cast sensor differs from its drawing, and never none."""
    import dataclasses

    from workbench.project.named_designs import load_design
    from workbench.tasks.task import Size

    design = load_design("geltip")
    for friction, wanted in ((0.3, (0.1, 0.5)), (0.1, (0.05, 0.3)), (1.9, (1.7, 2.0))):
        material = dataclasses.replace(design.material, friction=friction)
        made = task_of("slip").recipe(dataclasses.replace(design, material=material), Size.SMALL)
        assert made.vary.friction == pytest.approx(wanted)
