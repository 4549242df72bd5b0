"""Photographs as backgrounds: what is converted, and what is refused with value and remedy."""

from __future__ import annotations

import dataclasses
import io

import cv2
import numpy as np
import pytest
from PIL import Image

from sim.optics.raster.display import encode, grey_table, looked_up
from sim.optics.studio.background import photo_light, tied_exposure
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, ImageSensor
from workbench.core.design.photo import Photo, photo

CAMERA = Camera(width_px=64, height_px=48)


def saved(image: np.ndarray, name: str = "idle.png") -> Photo:
    """A file as OpenCV writes it."""
    done, data = cv2.imencode(name[name.index(".") :], image)
    assert done
    return photo(name, data.tobytes(), at="optics.background")


def picture(channels: int = 3, dtype: type = np.uint8) -> np.ndarray:
    """48 x 64 pixels without a pattern."""
    full = np.iinfo(dtype).max
    random = np.random.default_rng(1)
    return random.integers(0, full, (48, 64, channels), dtype=dtype, endpoint=True)


def refusal(file: Photo) -> DesignError:
    """The error of a background."""
    with pytest.raises(DesignError) as caught:
        photo_light(file, CAMERA)
    assert caught.value.at == "optics.background" and caught.value.hint
    return caught.value


def test_a_photograph_is_shown_as_it_is() -> None:
    """Its light is shown as the file again, to the grey level, by each curve of a sensor."""
    image = picture()
    light = photo_light(saved(image), CAMERA)
    assert light.dtype == np.float32
    assert np.array_equal(encode(light, 1.0), image[:, :, ::-1])
    curve = (0.0, 0.3, 0.55, 0.75, 0.9, 1.0)
    for sensor in (ImageSensor(gamma=1.8), ImageSensor(response=curve)):
        light = photo_light(saved(image), dataclasses.replace(CAMERA, sensor=sensor))
        assert np.array_equal(looked_up(light, grey_table(sensor)), image[:, :, ::-1])


def test_each_colour_is_tied_to_the_photograph() -> None:
    """Exposure and white balance are found again from light that both know, noise apart."""
    random = np.random.default_rng(2)
    rendered = random.uniform(0.01, 0.1, (4000, 3))
    true = np.array([5.0, 2.0, 9.0])
    taken = np.clip(true * rendered, 0.0, 1.0)
    # Half of the blue would be cut off at white, and must not count.
    taken[::2, 2] = 1.0
    assert tied_exposure(taken, rendered) == pytest.approx(true, rel=1e-6)
    no_blue = rendered * [1.0, 1.0, 0.0]
    got = tied_exposure(taken, no_blue)
    assert got[:2] == pytest.approx(true[:2])
    assert true[1] < got[2] < true[0]


def test_grey_and_16_bit_files_are_converted() -> None:
    """Grey fills the three colours; 65535 is 255, to half a grey level."""
    grey = picture(1)
    shown = encode(photo_light(saved(grey), CAMERA), 1.0)
    assert np.array_equal(shown, np.repeat(grey, 3, axis=2))
    deep = picture(3, np.uint16)
    shown = encode(photo_light(saved(deep), CAMERA), 1.0)
    # The display's table steps by 0.05 grey levels at most.
    assert np.abs(shown[:, :, ::-1] - deep / 257.0).max() <= 0.53


def test_transparent_places_are_black() -> None:
    """Nothing shines where the file has no picture."""
    image = picture(4)
    image[:, :, 3] = 0
    assert not photo_light(saved(image), CAMERA).any()


def test_another_size_is_refused() -> None:
    """Both sizes are in the message, both ways out in the hint."""
    error = refusal(saved(picture()[:40]))
    assert "has 64 x 40 pixels, the camera 64 x 48" in error.message
    assert "height_px = 40" in error.hint and "64 x 48" in error.hint


@pytest.mark.parametrize("ending", ["jpg", "tif"])
def test_cmyk_is_refused(ending: str) -> None:
    """Four inks are no colours of light."""
    buffer = io.BytesIO()
    format_name = {"jpg": "JPEG", "tif": "TIFF"}[ending]
    Image.new("CMYK", (64, 48), (10, 20, 30, 40)).save(buffer, format=format_name)
    error = refusal(photo(f"print.{ending}", buffer.getvalue(), at="optics.background"))
    assert "print." in error.message and "CMYK" in error.message and "RGB" in error.hint


@pytest.mark.parametrize("data", [b"", b"not a picture", b"\x89PNG\r\n\x1a\n" + bytes(40)])
def test_a_broken_file_is_refused(data: bytes) -> None:
    """Its name and size are told."""
    error = refusal(photo("idle.png", data, at="optics.background"))
    assert f"idle.png ({len(data)} bytes) cannot be read" in error.message


def test_numbers_with_a_fraction_are_refused() -> None:
    """A TIFF of floats has no white."""
    error = refusal(saved(np.ones((48, 64, 3), np.float32), "deep.tif"))
    assert "float32" in error.message


def test_another_format_is_refused_by_its_name() -> None:
    """A design takes picture files only."""
    with pytest.raises(DesignError, match=r"notes\.txt is not a picture"):
        photo("notes.txt", b"", at="optics.background")
