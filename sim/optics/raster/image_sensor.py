"""From radiance on the pixels to the image that an image sensor gives.

In this order, each left out at its default:

    defocus     a disc of c = focal_px aperture |1 / range - 1 / focus| pixels, a thin lens
    fall-off    light falls to ((1 - v) + v cos^4) (1 + k1 r^2 + k2 r^4 + k3 r^6)
    exposure    display light = radiance x exposure x 10^(gain / 20) x gain of the colour
    noise       electrons N = Poisson(light well / g) + Normal(0, read), light = N g / well, with
                g = 10^(gain / 20): variance of light = light g / well + (read g / well)^2
    display     light^(1 / gamma), a measured curve, or that of sRGB, to 8 bits

Each pixel's light is spread by its own disc: images are shared out to layers of growing Gaussian
blur with the disc's variance, c^2 / 16 along each axis, and summed, so no light is lost or made.
Source: Potmesil and Chakravarty, SIGGRAPH 1981 (circle of confusion); EMVA Standard 1288 (photon
transfer). Left out: that nearer skin hides light blurred from behind it, the shape of the
aperture, colour filters, dark current and fixed patterns.
"""

from __future__ import annotations

import functools
import hashlib

import numpy as np

from sim.optics.camera.camera import axis_cosines, focal_px
from sim.optics.raster.display import choose_exposure, grey_table, looked_up
from workbench.core.base.check import expect
from workbench.core.design.camera import Camera, falloff_share

SHARP_PX = 0.1
"""Standard deviation up to which a whole image counts as sharp [px]: 1 % beside a step."""
FIRST_BLUR_PX = 0.8
"""Of the first layer [px]; a sampled Gaussian narrower than this has less than its variance."""
BLUR_RATIO = 1.5
"""Between the layers' standard deviations [1]; a sum of two neighbours stays near a Gaussian."""
KERNEL_REACH = 4.0
"""Half width of a kernel in standard deviations [1]: 6e-5 of the light is beyond."""


def develop(
    linear: np.ndarray,
    camera: Camera,
    *,
    exposure: np.ndarray | float,
    range_mm: np.ndarray | None = None,
    frame: int = 0,
) -> np.ndarray:
    """8-bit image of radiance, shape (H, W, 3); at the sensor's defaults that of `encode`.

    Args:
        linear: Radiance, shape (H, W, 3), float32.
        camera: Lens and image sensor.
        exposure: Display light per radiance, gains included, as `fixed_exposure` gives it.
        range_mm: Length of each line of sight [mm], shape (H, W), NaN where it meets nothing;
            None leaves out the blur.
        frame: Number of the image, which its noise follows besides the seed.
    """
    expect(linear, f"{camera.height_px} {camera.width_px} 3", name="radiance")
    sensor = camera.sensor
    if range_mm is not None and camera.aperture_mm > 0.0:
        linear = defocus(linear, blur_px(camera, range_mm) / 4.0)
    light = linear * kept_light(camera)[:, :, None] * np.float32(exposure)
    if sensor.noise:
        light = noisy(np.clip(light, 0.0, None), camera, frame)
    return looked_up(light, grey_table(sensor))


def fixed_exposure(camera: Camera, background: np.ndarray) -> np.ndarray:
    """Display light per radiance of each colour, (3,): what the sensor is set to, or what suits.

    Args:
        camera: Its sensor.
        background: Radiance of the pixels that see the skin, as it falls on the sensor, (P, 3).
    """
    gain_rgb = np.array(camera.sensor.gain_rgb)
    if camera.sensor.exposure > 0.0:
        return camera.sensor.exposure * _gain(camera) * gain_rgb
    return choose_exposure(background * gain_rgb, camera.sensor) * gain_rgb


def blur_px(camera: Camera, range_mm: np.ndarray) -> np.ndarray:
    """Diameter of the circle of confusion [px] at a range [mm]; 0 where the range is NaN.

    A point at `range` blurs to a disc of aperture |1 - focus / range| in the plane of focus, seen
    under that over `focus`.
    """
    with np.errstate(divide="ignore"):
        away = np.abs(1.0 / range_mm - 1.0 / camera.focus_mm)
    return np.where(np.isfinite(away), focal_px(camera) * camera.aperture_mm * away, 0.0)


def defocus(linear: np.ndarray, sigma_px: np.ndarray) -> np.ndarray:
    """Light of each pixel spread by its own Gaussian [px], (H, W, 3); the sum is unchanged.

    Args:
        linear: Shape (H, W, 3), float32.
        sigma_px: Standard deviation of each pixel's spread, shape (H, W).
    """
    import cv2

    widest = float(sigma_px.max())
    if widest < SHARP_PX:
        return linear
    levels = [0.0, FIRST_BLUR_PX]
    while levels[-1] < widest:
        levels.append(levels[-1] * BLUR_RATIO)
    # Shares that are linear in the variance give each pixel exactly the variance it asks for.
    position = np.interp(sigma_px**2, np.square(levels), np.arange(len(levels)))
    total = np.zeros_like(linear)
    for number, sigma in enumerate(levels):
        share = np.clip(1.0 - np.abs(position - number), 0.0, 1.0).astype(np.float32)
        if not share.any():
            continue
        layer = linear * share[:, :, None]
        if sigma > 0.0:
            size = 2 * int(np.ceil(KERNEL_REACH * sigma)) + 1
            border = cv2.BORDER_REFLECT
            layer = cv2.GaussianBlur(layer, (size, size), sigma, borderType=border)
        total += layer
    return total


def noisy(light: np.ndarray, camera: Camera, frame: int) -> np.ndarray:
    """Display light with the noise of its electrons, same shape, float32.

    Equal seeds and frames give equal noise, but no two cameras of a sensor the same.
    """
    sensor = camera.sensor
    start = np.array([0, 0, 0, _place_number(camera)], dtype=np.uint64)
    random = np.random.Generator(np.random.Philox(key=[sensor.seed, frame], counter=start))
    white_e = sensor.full_well_e / _gain(camera)
    # A full well holds no more, whatever the light.
    electrons = random.poisson(np.minimum(light * white_e, sensor.full_well_e)).astype(np.float32)
    if sensor.read_noise_e > 0.0:
        read = random.standard_normal(light.shape, dtype=np.float32)
        electrons += np.float32(sensor.read_noise_e) * read
    return electrons / np.float32(white_e)


def _place_number(camera: Camera) -> int:
    """A number in [0, 2^64) that stands for where a camera is and looks, on every machine."""
    # Adding 0.0 makes zeros of both signs one.
    place = np.array([*camera.position_mm, *camera.wxyz], dtype="<f8") + 0.0
    return int.from_bytes(hashlib.blake2b(place.tobytes(), digest_size=8).digest(), "little")


def _gain(camera: Camera) -> float:
    return 10.0 ** (camera.sensor.gain_dB / 20.0)


@functools.lru_cache(maxsize=2)
def kept_light(camera: Camera) -> np.ndarray:
    """Share of the light that the lens keeps at each pixel, shape (H, W), float32."""
    height, width, sensor = camera.height_px, camera.width_px, camera.sensor
    cosine = np.maximum(axis_cosines(camera), 0.0).reshape(height, width)
    natural = (1.0 - sensor.vignetting) + sensor.vignetting * cosine**4
    row, column = np.ogrid[:height, :width]
    away = np.hypot(column + 0.5 - width / 2, row + 0.5 - height / 2)
    measured = falloff_share(sensor.falloff, away / (np.hypot(width, height) / 2))
    return (natural * measured).astype(np.float32)
