"""A built sensor looked at with fewer pixels than it was photographed with."""

from __future__ import annotations

import dataclasses

import cv2
import numpy as np
import pytest

from sim.optics.raster.photo_file import read_rgb
from sim.optics.studio.fitted_photos import fitted_photos
from sim.optics.studio.unit_residual import read_unit, unit_bytes
from tests.synthetic_light import lit
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.design.photo import Photo, photo
from workbench.core.design.unit import Unit, unit
from workbench.live.live_press import small
from workbench.pipeline.seen_optics import seen_optics

WIDTH_PX, HEIGHT_PX = 192, 144


def picture() -> np.ndarray:
    """A photograph, shape (H, W, 3), uint8: each colour climbs another way."""
    across = np.linspace(40.0, 200.0, WIDTH_PX)[None, :]
    down = np.linspace(60.0, 180.0, HEIGHT_PX)[:, None]
    rgb = np.stack([across + 0 * down, 0 * across + down, 0.5 * (across + down)], axis=2)
    return np.rint(rgb).astype(np.uint8)


def png() -> bytes:
    return cv2.imencode(".png", picture()[:, :, ::-1])[1].tobytes()


def built() -> Unit:
    """What a calibration writes, with a residual of two kernels."""
    rng = np.random.default_rng(2)
    data = unit_bytes(png(), rng.normal(size=(2, 4)), rng.normal(size=(2, 3)), np.ones(4))
    return unit("unit.npz", data)


def optics(width_px: int, height_px: int, shown: Photo | None, of: Unit | None) -> Optics:
    camera = Camera(width_px=width_px, height_px=height_px)
    model = LightModel("hybrid")
    return Optics(camera=camera, light_model=model, background=shown, unit=of)


def test_pixels_are_averaged_and_the_residual_stays() -> None:
    """Half as many each way: the mean of four, within half a grey level of rounding."""
    found = fitted_photos(optics(96, 72, photo("rest.png", png(), at=""), built()))
    four = picture().reshape(72, 2, 96, 2, 3).mean(axis=(1, 3)) / 255.0
    assert found.background is not None and found.unit is not None
    held, whole = read_unit(found.unit), read_unit(built())
    for shown in (found.background, held.idle):
        assert np.abs(read_rgb(shown, at="") - four).max() < 0.51 / 255.0
    assert np.array_equal(held.weights, whole.weights)
    assert np.array_equal(held.centres, whole.centres)


@pytest.mark.parametrize("size_px", [(192, 144), (384, 288), (96, 96)])
def test_what_does_not_fit_is_left_to_be_refused(size_px: tuple[int, int]) -> None:
    """As many pixels, more, or of another proportion."""
    given = optics(*size_px, photo("rest.png", png(), at=""), built())
    assert fitted_photos(given) == given
    assert fitted_photos(optics(*size_px, None, None)) == optics(*size_px, None, None)


@pytest.mark.usefixtures("taichi_device")
@pytest.mark.parametrize("way", ["preview", "data set"])
def test_fewer_pixels_show_the_photograph_at_rest(way: str) -> None:
    """By the page's preview, and by a data set's smaller camera, as the larger camera does."""
    from sim.optics.proof.specimen import finger
    from sim.optics.studio.render import Studio

    mesh = finger(edge_mm=1.0)
    whole = optics(WIDTH_PX, HEIGHT_PX, None, built())
    light, table = lit(mesh, whole.light_model)
    if way == "preview":
        fewer = small(whole, 96)
    else:
        camera = dataclasses.replace(whole.camera, width_px=96, height_px=72)
        fewer = seen_optics(dataclasses.replace(whole, camera=camera))
    still = np.zeros((1, *mesh.seen.points_mm.shape), dtype=np.float32)
    shown = Studio(mesh, light, fewer, table=table).shoot(still).rgb[0].astype(float)
    four = picture().reshape(72, 2, 96, 2, 3).mean(axis=(1, 3))
    assert np.abs(shown - four).mean() < 1.0
